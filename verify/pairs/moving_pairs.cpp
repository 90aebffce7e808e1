/// A plane that A's primitive does not cross, and how near to it B's comes.
#include "verify/pairs/moving_pairs.hpp"

#include "verisq/enclosure.hpp"

namespace verisq::verify {

double MovingPairs::lower_by_spheres(std::size_t i, std::size_t j) const {
  const PreciseVector& centre = pairs_.motion_b(j).translation;
  const PreciseVector apart = centre - pairs_.motion_a(i).translation;
  return (length<Real>(apart) - motion_.way_of(centre) - pairs_.radius_a(i) - pairs_.radius_b(j))
      .lower()
      .to_double(Direction::down);
}

double MovingPairs::lower_by_vector(std::size_t i, std::size_t j, const Point& vector) const {
  if (!usable({vector[0], vector[1], vector[2]})) return -infinity;
  const PosedSuperquadric& solid_b = b_->primitives[j];
  const PreciseVector v = precise(vector);
  const PreciseVector n = pairs_.motion_a(i).rotation * v;
  const PreciseInterval far_side_of_a =
      PreciseInterval(a_->primitives[i].bounds().support_up(v)) + n.dot(pairs_.motion_a(i).translation);
  const RigidMotion& place = pairs_.motion_b(j);
  const auto reach_of_b = [&](const PreciseVector& m) {
    return solid_b.bounds().support_up(place.rotation.transpose() * m);
  };
  const PreciseInterval near_side_of_b =
      motion_.least_along(n, {place.translation, solid_b.radius()}, place.translation, reach_of_b);
  return ((near_side_of_b - far_side_of_a) / length<Real>(n)).lower().to_double(Direction::down);
}

}  // namespace verisq::verify
