/// A model's tree of set operations as straight-line OpenCL C (docs/mathematics.md §11).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "verisq/model.hpp"

namespace verisq::device {

/// Leaves that a tree of set operations may have for a program of its own. Its compilation takes seconds at this number
/// and grows with it; compilers nest no more than some 250 operands; and kernels remember what is decided of the first
/// 32 primitives alone, so that from about here the host, which simplifies the whole tree, is faster on a processor
/// (120 balls with holes, 2000 points: 8.3 s on the device, 3.8 s on the host).
inline constexpr std::size_t most_compiled_leaves = 100;

/// Why the model has no program of its own; empty where it has one.
[[nodiscard]] std::string why_not_compiled(const Model& model);

/// The text of a program for one model: PRIMITIVES (their number), its terms (model_terms.hpp), the layers, the kernels
/// that are its entry points, and the functions `solid_colour` and `solid_node` that kernels/set_tree.clh declares.
/// Numbers of the model do not enter, only its structure: models that differ by numbers alone share a program.
/// Precondition: the model may be compiled.
[[nodiscard]] std::string model_source(const Model& model, std::string_view entry_points);

/// That with all kernels that signed distances of points take.
[[nodiscard]] std::string solid_source(const Model& model);

}  // namespace verisq::device
