/// The summary of a model's mesh on the standard output: for people, or as one JSON object.
#pragma once

#include <optional>
#include <string>
#include <verisq/enclosure.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model_mesh.hpp>

namespace verisq::command_line {

struct MeshReport {
  double deviation;  ///< that was asked for
  const ModelMesh& found;
  std::optional<Enclosure> proven;  ///< two-sided Hausdorff distance of the mesh as it is written from the surface
  MeshTopology topology;
  double volume;
  std::string output;
  std::string units;  ///< of the model; empty when not given
  double seconds;
};

[[nodiscard]] std::string readable(const MeshReport& report);

/// One line.
[[nodiscard]] std::string json(const MeshReport& report);

}  // namespace verisq::command_line
