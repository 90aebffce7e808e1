/// A model's tree of set operations as straight-line OpenCL C (design 2, §11).
#pragma once

#include <string>
#include <string_view>

#include "verisq/model.hpp"

namespace verisq::device {

/// The text of a program for one model: PRIMITIVES (their number), the layers, the kernels that are its entry points,
/// and the functions `solid_colour` and `solid_node` that kernels/set_tree.clh declares. Numbers of the model do not
/// enter, only its structure: models that differ by numbers alone share a program.
[[nodiscard]] std::string model_source(const Model& model, std::string_view entry_points);

}  // namespace verisq::device
