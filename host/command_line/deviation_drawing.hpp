/// A deviation for people to look at: the mesh, coloured by its distance to the model's surface, on a page or a
/// picture.
#pragma once

#include <string>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "host/command_line/deviation_summary.hpp"

namespace verisq::command_line {

/// What is drawn, and where it was read from or written to.
struct DrawnDeviation {
  const Model& model;
  std::string model_file;
  const Mesh& mesh;
  std::string mesh_file;
};

/// Of a finished map of the mesh's vertices: with the lines of `report`. Throws Error(failure).
void write(const ReportFiles& files, const DrawnDeviation& drawn, const DeviationReport& report);

}  // namespace verisq::command_line
