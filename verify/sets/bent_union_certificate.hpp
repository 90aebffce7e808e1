/// Signed distances to unions with bent primitives, with what proves them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "verify/proof/exact_checker.hpp"
#include "verify/sets/union_closest_point.hpp"

namespace verisq::verify {

/// What one part, the model's primitive `index`, proves alone.
[[nodiscard]] CertifiedEnclosure certificate_of_part(const UnionPart& part, std::uint32_t index, const Point& x);

/// Asked for where x may lie inside: a point outside the union, hardly farther than any is.
using FindEscape = std::function<std::optional<Point>()>;

/// The enclosure is what `checker`, of the same model, proves: tight outside where the condition of docs/mathematics.md
/// §9 holds, inside where that ball's proof does; elsewhere valid, and wide.
[[nodiscard]] CertifiedEnclosure bent_union_certificate(std::span<const UnionPart> parts, const ExactChecker& checker,
                                                        const Point& x, const FindEscape& find_escape);

}  // namespace verisq::verify
