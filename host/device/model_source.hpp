/// A model's tree of set operations as straight-line OpenCL functions (design 2, §11).
#pragma once

#include <cstddef>
#include <string>

#include "verisq/model.hpp"

namespace verisq::device {

/// Colours of primitives travel in the bits of a 32-bit word.
constexpr std::size_t most_primitives_of_tree = 32;

/// Two functions, for insertion between the layer kernels/set_tree.clh and the kernels that call them:
///   colour model_colour(cube, decided, constant const box_primitive*, newly_decided*)
///   node model_node(cube, cut_query, bool outside, decided, const double* least_inside, const double* least_outside,
///                   constant const box_primitive*, newly_decided*)
/// and PRIMITIVES, their number. Numbers of the model do not enter, only its structure: models that differ by numbers
/// alone share a program. Precondition: at most `most_primitives_of_tree` primitives.
[[nodiscard]] std::string model_source(const Model& model);

}  // namespace verisq::device
