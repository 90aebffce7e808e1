/// Proves the octree of a file again: of its cubes all, or some chosen at random.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <verisq/model.hpp>

#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

struct OctreeCheckArguments {
  std::string octree;
  std::string model;
  std::optional<Pose> pose;             ///< moves the model
  std::optional<std::uint64_t> sample;  ///< how many cubes
  bool json;
  bool no_progress;
};

/// `verified` only where every cube that was looked at is proved.
ExitStatus run_octree_check(const OctreeCheckArguments& arguments);

}  // namespace verisq::command_line
