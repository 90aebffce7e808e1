/// The support function in intervals; GJK for the nearest point.
#include "verify/sets/whole_primitive.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "verify/proposals/gjk.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

double WholePrimitive::support(const Point& direction) const {
  try {
    return proven_support(direction);
  } catch (const std::domain_error&) {  // numbers overflow, and intervals have none
    return infinity;
  }
}

double WholePrimitive::proven_support(const Point& direction) const {
  const Vector3<double> n{Interval(direction[0]), Interval(direction[1]), Interval(direction[2])};
  const SeparablePrimitive& primitive = *primitive_;
  const Interval about_centre(primitive.sections.support_up(primitive.to_own_frame * n, primitive.sections.whole()));
  Interval sum = about_centre;
  for (std::size_t i = 0; i < 3; ++i) sum += n[i] * (Interval(primitive.centre[i]) - Interval(cube_.centre[i]));
  return sum.upper();
}

Point WholePrimitive::nearest(const Point& x) const {
  const SeparablePrimitive& primitive = *primitive_;
  const SectionedPrimitive::Section whole = primitive.sections.whole();
  const auto set = [&](const Coordinates<double>& v) {
    return primitive.about.point(primitive.sections.support_point(primitive.about.inverse_direction(v), whole));
  };
  const Coordinates<double> towards{x[0] - primitive.centre[0], x[1] - primitive.centre[1], x[2] - primitive.centre[2]};
  const Point found = gjk<double>(set, PointSet<double>{x}, towards, {.relative = 0.0, .absolute = tolerance_}).on_a;
  const bool finite = std::ranges::all_of(found, [](double c) { return std::isfinite(c); });
  return finite ? found : primitive.centre;
}

}  // namespace verisq::verify
