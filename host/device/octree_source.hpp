/// A model's tree of set operations as straight-line OpenCL C over the colours of its primitives (design 2, §11).
#pragma once

#include <string>

#include "verisq/model.hpp"

namespace verisq::device {

/// What kernels/octree.cl leaves to the model.
struct OctreeSource {
  std::string definitions;  ///< PRIMITIVES, the number of primitives; before the kernels
  std::string functions;    ///< solid_colour; after them
};

/// Numbers of the model do not enter, only its structure: models that differ by numbers alone share a program.
[[nodiscard]] OctreeSource octree_source(const Model& model);

}  // namespace verisq::device
