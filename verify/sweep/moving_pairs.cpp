/// Taylor's theorem for the points of a solid that turns and shifts steadily (docs/mathematics.md §26).
#include "verify/sweep/moving_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/cross_product.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

bool is_direction(const Point& v) {
  return std::ranges::all_of(v, [](double c) { return std::isfinite(c); }) &&
         std::ranges::any_of(v, [](double c) { return c != 0.0; });
}

/// The most that the remainder of the first order can be.
PreciseInterval remainder(const PreciseInterval& acceleration, double reach) {
  return PreciseInterval(Real(0.5)) * square(PreciseInterval(Real(reach))) * acceleration;
}

}  // namespace

MovingPairs::MovingPairs(const PosedPrimitives& a, const PosedPrimitives& b, const RigidMotion& pose,
                         const SteadyMotion& motion)
    : a_(&a), b_(&b), motion_(motion), pairs_(a, b, pose), origin_(pose.translation) {
  // A point at x, from the origin, has the speed |w x + v| and the acceleration w x (w x x), at most |w| |w x x|; the
  // turn keeps |w x x|. Off a centre by r at most, it has at most |w| (|w x centre| + |w| r).
  const PreciseInterval rate = length<Real>(motion.spin);
  for (std::size_t j = 0; j < b.primitives.size(); ++j) {
    const PreciseVector centre = pairs_.motion_b(j).translation - origin_;
    const PreciseVector turning = cross(motion.spin, centre);
    const PreciseInterval across = length<Real>(turning);
    arcs_.push_back({centre, length<Real>(PreciseVector(turning + motion.velocity)),
                     rate * (across + rate * b.primitives[j].radius()), rate * across});
  }
}

double MovingPairs::lower_by_spheres(std::size_t i, std::size_t j, double reach) const {
  const Arc& arc = arcs_[j];
  const PreciseVector apart = pairs_.motion_b(j).translation - pairs_.motion_a(i).translation;
  const PreciseInterval way = arc.speed * PreciseInterval(Real(reach)) + remainder(arc.centre_acceleration, reach);
  return (length<Real>(apart) - way - pairs_.radius_a(i) - pairs_.radius_b(j)).lower().to_double(Direction::down);
}

double MovingPairs::lower_by_vector(std::size_t i, std::size_t j, const Point& vector, double reach) const {
  if (!is_direction(vector)) return -infinity;
  const Arc& arc = arcs_[j];
  const PosedSuperquadric& solid_a = a_->primitives[i];
  const PosedSuperquadric& solid_b = b_->primitives[j];
  const PreciseVector v = precise(vector);
  const PreciseVector n = pairs_.motion_a(i).rotation * v;
  const PreciseVector turned = cross(n, motion_.spin);  // n·(w x x) = (n x w)·x
  const PreciseInterval far_side_of_a =
      PreciseInterval(solid_a.bounds().support_up(v)) + n.dot(pairs_.motion_a(i).translation);
  const PreciseInterval at_moment = n.dot(origin_) - far_side_of_a;
  const auto gap_after = [&](const PreciseInterval& time) {
    const PreciseVector m = n + turned * time;
    const PreciseVector inward = -(pairs_.motion_b(j).rotation.transpose() * m);
    const PreciseInterval near_side_of_b = m.dot(arc.from_origin) - solid_b.bounds().support_up(inward);
    return at_moment + time * n.dot(motion_.velocity) + near_side_of_b;
  };
  const PreciseInterval time{Real(reach)};
  // Concave in time, like minus a support function along a line: least at an end.
  const PreciseInterval before = gap_after(-time);
  const PreciseInterval after = reach == 0.0 ? before : gap_after(time);
  const PreciseInterval least = before.lower() < after.lower() ? before : after;
  const PreciseInterval size = length<Real>(n);
  return ((PreciseInterval(least.lower()) - remainder(arc.acceleration, reach) * size) / size)
      .lower()
      .to_double(Direction::down);
}

}  // namespace verisq::verify
