/// Comparison of enclosures with the reference, and the line that reproduces an escape.
#include "tests/oracle/containment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace verisq::oracle {

namespace {

[[nodiscard]] std::string description(const Primitive& primitive) {
  const Superquadric& s = primitive.superquadric;
  return fmt::format("semi-axes {:.17g}, exponents {:.17g}, translation {:.17g}, quaternion {:.17g}",
                     fmt::join(s.semi_axes, " "), fmt::join(s.exponents, " "),
                     fmt::join(primitive.pose.translation, " "), fmt::join(primitive.pose.quaternion, " "));
}

[[nodiscard]] std::string evidence(std::string_view what, const Enclosure& enclosure, const Real& lower,
                                   const Real& upper, std::string_view scene) {
  return fmt::format("{}: [{:.17g}, {:.17g}], reference [{}, {}]; {}", what, enclosure.lo, enclosure.hi, text(lower),
                     text(upper), scene);
}

[[nodiscard]] std::string evidence(std::string_view what, const Enclosure& enclosure, const Primitive& primitive,
                                   const Point& point, const ReferenceDistance& reference) {
  return evidence(what, enclosure, reference.lower, reference.upper,
                  fmt::format("{}, point {:.17g}", description(primitive), fmt::join(point, " ")));
}

/// How `enclosure` misses a value that is proven to lie between `lower` and `upper`; empty when it does not.
[[nodiscard]] std::string_view miss(const Enclosure& enclosure, const Real& lower, const Real& upper) {
  if (!(enclosure.lo <= enclosure.hi)) return "not an interval";
  if (Real(enclosure.hi) < lower) return "upper end too low";
  return Real(enclosure.lo) > upper ? "lower end too high" : "";
}

}  // namespace

std::optional<std::string> escape(const Enclosure& enclosure, const Primitive& primitive, const Point& point,
                                  const ReferenceDistance& reference) {
  if (!(enclosure.lo <= enclosure.hi)) return evidence("not an interval", enclosure, primitive, point, reference);
  if (Real(enclosure.hi) < reference.lower) {
    return evidence("upper end too low", enclosure, primitive, point, reference);
  }
  if (Real(enclosure.lo) <= reference.upper) return std::nullopt;
  if (reference.upper_is_proven) return evidence("lower end too high", enclosure, primitive, point, reference);
  const PosedSolid solid(primitive.superquadric, primitive.pose);
  const ReferenceDistance thorough = solid.signed_distance(point, Search::thorough);
  if (Real(enclosure.lo) <= thorough.upper) return std::nullopt;
  return evidence("lower end too high (after a thorough search)", enclosure, primitive, point, thorough);
}

std::optional<std::string> escape(const Enclosure& enclosure, const Primitive& primitive, const Triangle& triangle,
                                  const TriangleReference& reference) {
  const std::string_view what = miss(enclosure, reference.lower, reference.upper);
  if (what.empty()) return std::nullopt;
  return evidence(what, enclosure, reference.lower, reference.upper,
                  fmt::format("{}, triangle {:.17g}, {:.17g}, {:.17g}", description(primitive),
                              fmt::join(triangle[0], " "), fmt::join(triangle[1], " "), fmt::join(triangle[2], " ")));
}

std::optional<std::string> escape(const Enclosure& enclosure, const Primitive& a, const Primitive& b,
                                  const PairReference& reference) {
  const std::string_view what = miss(enclosure, reference.lower, reference.upper);
  if (what.empty()) return std::nullopt;
  return evidence(what, enclosure, reference.lower, reference.upper,
                  fmt::format("A: {}; B: {}", description(a), description(b)));
}

double relative_gap(const ReferenceDistance& reference, const PosedSolid& solid, const Point& point) {
  return Real((reference.upper - reference.lower) / solid.magnitude(point)).convert_to<double>();
}

}  // namespace verisq::oracle
