/// Comparison of enclosures with the reference, and the line that reproduces an escape.
#include "tests/oracle/containment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace verisq::oracle {

namespace {

[[nodiscard]] std::string evidence(const char* what, const Enclosure& enclosure, const Primitive& primitive,
                                   const Point& point, const ReferenceDistance& reference) {
  const Superquadric& s = primitive.superquadric;
  return fmt::format(
      "{}: [{:.17g}, {:.17g}], reference [{}, {}]; semi-axes {:.17g}, exponents {:.17g}, translation {:.17g}, "
      "quaternion {:.17g}, point {:.17g}",
      what, enclosure.lo, enclosure.hi, text(reference.lower), text(reference.upper), fmt::join(s.semi_axes, " "),
      fmt::join(s.exponents, " "), fmt::join(primitive.pose.translation, " "),
      fmt::join(primitive.pose.quaternion, " "), fmt::join(point, " "));
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

double relative_gap(const ReferenceDistance& reference, const PosedSolid& solid, const Point& point) {
  return Real((reference.upper - reference.lower) / solid.magnitude(point)).convert_to<double>();
}

}  // namespace verisq::oracle
