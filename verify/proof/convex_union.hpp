/// Refuses the models that only branch and bound can answer for.
#pragma once

#include <string_view>

#include "verisq/model.hpp"

namespace verisq::verify {

/// For what rests on certificates of convex primitives: throws Error(input), "WHAT: not supported for ...", unless
/// is_union_of_convex(model). Without this a bend would be read as none, and a difference as a union.
void require_union_of_convex(const Model& model, std::string_view what);

/// Whether the model is the union of all its primitives, bent or not.
[[nodiscard]] bool is_union(const Model& model);

/// For certificates of points: throws likewise unless is_union(model).
void require_union(const Model& model, std::string_view what);

/// Throws Error(input), "WHAT: not supported for tapered solids ...", where a primitive has a taper.
void require_no_taper(const Model& model, std::string_view what);

}  // namespace verisq::verify
