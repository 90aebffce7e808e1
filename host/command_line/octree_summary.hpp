/// The summary of an octree on the standard output: for people, or as one JSON object.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <verisq/octree.hpp>

namespace verisq::command_line {

struct OctreeReport {
  OctreeSummary summary;
  std::string output;               ///< the file that holds the cubes; empty when none was written
  std::uint64_t output_bytes;       ///< its size, written or not; 0 where it is not known
  std::string units;                ///< of the model; empty when not given
  std::optional<double> tolerance;  ///< of the volume, where one was given
};

/// Ends of enclosures are rounded outward to the digits printed.
[[nodiscard]] std::string readable(const OctreeReport& report);

/// One line.
[[nodiscard]] std::string json(const OctreeReport& report);

}  // namespace verisq::command_line
