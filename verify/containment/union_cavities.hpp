/// Whether a union of convex solids may have a cavity: a bounded part of space that it surrounds and does not contain
/// (docs/mathematics.md §21).
#pragma once

#include <functional>
#include <span>

#include "verisq/model.hpp"

namespace verisq::verify {

/// Whether the union of these primitives is proven to have no cavity. False says nothing. `ended` is polled; once true,
/// nothing more is proven. Precondition: none of them is bent.
[[nodiscard]] bool is_without_cavities(std::span<const Primitive> primitives, const std::function<bool()>& ended);

}  // namespace verisq::verify
