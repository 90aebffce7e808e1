/// How many cubes of each colour a level of an octree has.
#pragma once

#include <cstdint>

namespace verisq {

/// Cubes of one level that were not split.
struct OctreeLevel {
  std::uint64_t black = 0;
  std::uint64_t white = 0;
  std::uint64_t gray = 0;
};

}  // namespace verisq
