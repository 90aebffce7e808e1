/// d(ball about c, S) >= sd(c, S) - r, and sd is 1-Lipschitz: a centre that is known to within e costs e.
#include "verify/sets/distance_of_balls.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "verify/numbers/vector.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t kMostBalls = 64;  // a search each
constexpr Enclosure kNothingKnown{-infinity, infinity};

bool is_ball(const Primitive& primitive) {
  const auto& [axes, exponents, taper] = primitive.superquadric;
  return axes[0] == axes[1] && axes[1] == axes[2] && exponents == std::array{1.0, 1.0} && taper == 1.0;
}

}  // namespace

std::optional<BallUnion> BallUnion::of(const Model& model) {
  const bool balls = is_union_of_convex(model) && model.primitives.size() <= kMostBalls &&
                     std::ranges::all_of(model.primitives, is_ball);
  if (!balls) return std::nullopt;
  std::vector<Ball> result;
  for (const Primitive& primitive : model.primitives) {
    result.push_back({primitive.pose.translation, primitive.superquadric.semi_axes[0]});
  }
  return BallUnion(std::move(result));
}

double BallUnion::lower_from(const SolidDistance& solid, const std::function<Located(const Point&)>& locate,
                             double tolerance, const std::function<bool()>& interrupted) const {
  double least = infinity;
  for (const auto& [centre, radius] : balls_) {
    const auto [own, off] = locate(centre);
    const double lo = solid(own, tolerance, kNothingKnown, interrupted).lo;
    // The search of pairs says that there is no solid.
    if (lo == std::numeric_limits<double>::max()) return -infinity;
    least = std::min(least, subtract(subtract(lo, off, Direction::down), radius, Direction::down));
  }
  return least;
}

double BallUnion::lower_from_b(const SolidDistance& b, const BoundedMotion& motion, double tolerance,
                               const std::function<bool()>& interrupted) const {
  const auto locate = [&](const Point& centre) {
    const Cube cube = motion.enclosed_in_b(centre);
    return Located{cube.centre, (sqrt(Interval(3)) * Interval(cube.half_width)).upper()};
  };
  return lower_from(b, locate, tolerance, interrupted);
}

double BallUnion::lower_from_a(const SolidDistance& a, const BoundedMotion& motion, double tolerance,
                               const std::function<bool()>& interrupted) const {
  const auto locate = [&](const Point& centre) {
    const Point own = motion.to_a(centre);
    return Located{own, motion.distance_up(own, centre)};
  };
  return lower_from(a, locate, tolerance, interrupted);
}

}  // namespace verisq::verify
