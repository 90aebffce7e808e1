/// The rounded rotation is that of the precise one: its entries are at most 1, hence off by less than 2^-53.
#include "verify/sets/bounded_motion.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/rigid_motion.hpp"

namespace verisq::verify {

namespace {

double nearest(const PreciseInterval& x) {
  return 0.5 * (x.lower().to_double(Direction::down) + x.upper().to_double(Direction::up));
}

}  // namespace

BoundedMotion::BoundedMotion(const Pose& pose)
    : precise_(RigidMotion(pose)), inverse_(precise_.inverse()), rotation_{}, translation_(pose.translation) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      // Both ends are within 2^-52 of the exact entry, because 127 bits lose nothing that counts here.
      rotation_[i][j] = nearest(precise_.rotation(i, j));
    }
  }
}

Point BoundedMotion::to_a(const Point& in_b) const {
  Point x = translation_;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) x[i] += rotation_[i][j] * in_b[j];
  }
  return x;
}

Point BoundedMotion::to_b(const Point& in_a) const {
  return direction_in_b({in_a[0] - translation_[0], in_a[1] - translation_[1], in_a[2] - translation_[2]});
}

Point BoundedMotion::direction_in_b(const Point& direction) const {
  // Each product carries 2^-52 |direction_i| from its entry and three roundings of 2^-53: together less than
  // 2^-50 |direction|_1.
  Point turned{};
  for (std::size_t j = 0; j < 3; ++j) {
    turned[j] = rotation_[0][j] * direction[0] + rotation_[1][j] * direction[1] + rotation_[2][j] * direction[2];
  }
  return turned;
}

double BoundedMotion::distance_up(const Point& a, const Point& b) const {
  return length<Real>(PreciseVector(precise_(precise(b)) - precise(a))).upper().to_double(Direction::up);
}

Cube BoundedMotion::enclosed_in_b(const Point& x) const {
  const PreciseVector in_b = inverse_(precise(x));
  Cube cube{{}, 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval& component = in_b[i];
    cube.centre[i] = nearest(component);
    const PreciseInterval deviation = abs(component - PreciseInterval(Real(cube.centre[i])));
    cube.half_width = std::max(cube.half_width, deviation.upper().to_double(Direction::up));
  }
  return cube;
}

}  // namespace verisq::verify
