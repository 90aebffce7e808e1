/// d(K, S) >= sd(c, S) - r for K within the ball of radius r about c, and sd is 1-Lipschitz: a centre that is known to
/// within e costs e.
#include "verify/sets/enclosing_balls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "verify/pairs/enclosing_radius.hpp"
#include "verify/proof/rigid_motion.hpp"
#include "verify/sets/set_tree.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t kMostPrimitives = 64;  // some searches each
constexpr double kNearlyRound = 1.25;        // the largest distance from the centre, over the least
constexpr Enclosure kNothingKnown{-infinity, infinity};

void append_hollows(const SetNode& node, const Model& model, std::vector<Ball>& result) {
  if (node.kind == SetNode::Kind::leaf && node.side == Side::outside) {
    const Primitive& primitive = model.primitives[node.primitive];
    if (is_ball(primitive)) result.push_back({primitive.pose.translation, primitive.superquadric.semi_axes[0]});
  }
  for (const SetNode& operand : node.operands) append_hollows(operand, model, result);
}

/// About the μ with the least bound: convex in μ, searched for by the logarithm of what it exceeds the largest b² by.
double multiplier(const std::array<double, 3>& b, const std::array<double, 3>& c) {
  const double largest = std::ranges::max(b) * std::ranges::max(b);
  const auto bound = [&](double exponent) {
    const double mu = largest * (1.0 + std::exp(exponent));
    double sum = mu;
    for (std::size_t i = 0; i < 3; ++i) sum += c[i] * c[i] * mu / (mu - b[i] * b[i]);
    return sum;
  };
  double low = -36.0;  // a few roundings of the square
  double high = 40.0;
  for (int i = 0; i < 120; ++i) {
    const double third = (high - low) / 3.0;
    (bound(low + third) < bound(high - third) ? high : low) =
        bound(low + third) < bound(high - third) ? high - third : low + third;
  }
  return largest * (1.0 + std::exp(0.5 * (low + high)));
}

}  // namespace

std::vector<Ball> hollows(const Model& model) {
  std::vector<Ball> result;
  append_hollows(normal_form(model, Side::inside), model, result);
  return result;
}

double multiplier_about(const Primitive& primitive, const Point& x) {
  const PreciseVector centre = RigidMotion(primitive.pose).local_point(x);
  std::array<double, 3> about{};
  for (std::size_t i = 0; i < 3; ++i) about[i] = centre[i].upper().to_double(Direction::up);
  return multiplier(semi_axes_of_ellipsoid(primitive.superquadric), about);
}

double farthest_up(const Primitive& primitive, const Point& x) {
  return farthest_up(primitive, precise(x), multiplier_about(primitive, x));
}

std::optional<EnclosingBalls> EnclosingBalls::of(const Model& model) {
  if (!is_union_of_convex(model) || model.primitives.size() > kMostPrimitives) return std::nullopt;
  return EnclosingBalls(model.primitives);
}

bool EnclosingBalls::all_are_balls() const {
  return std::ranges::all_of(primitives_, is_ball);
}

std::vector<Ball> enclosing_balls(const Primitive& primitive, std::span<const Ball> hollows) {
  const Point& own_centre = primitive.pose.translation;
  if (is_ball(primitive)) return {{own_centre, primitive.superquadric.semi_axes[0]}};
  if (hollows.empty()) return {};
  std::vector<Ball> result;
  Ball widest{{}, infinity};
  double room = 0.0;
  for (const auto& [centre, radius] : hollows) {
    const double farthest = farthest_up(primitive, centre);
    if (!(radius - farthest > room)) continue;
    room = radius - farthest;
    widest = {centre, farthest};
  }
  if (room > 0.0) result.push_back(widest);
  const double about_own_centre = farthest_up(primitive, own_centre);
  if (about_own_centre <= kNearlyRound * std::ranges::min(primitive.superquadric.semi_axes)) {
    result.push_back({own_centre, about_own_centre});
  }
  return result;
}

double EnclosingBalls::lower_from(const SolidDistance& solid, std::span<const Ball> hollows,
                                  const std::function<Located(const Point&)>& locate, double tolerance,
                                  const std::function<bool()>& interrupted) const {
  std::vector<std::vector<Ball>> balls;
  for (const Primitive& primitive : primitives_) {
    balls.push_back(enclosing_balls(primitive, hollows));
    if (balls.back().empty()) return -infinity;
  }
  double least = infinity;
  for (const std::vector<Ball>& about_one : balls) {
    double greatest = -infinity;
    for (const auto& [centre, radius] : about_one) {
      const auto [own, off] = locate(centre);
      const double lo = solid(own, tolerance, kNothingKnown, interrupted).lo;
      // The search of pairs says that there is no solid.
      if (lo == std::numeric_limits<double>::max()) return -infinity;
      greatest = std::max(greatest, subtract(subtract(lo, off, Direction::down), radius, Direction::down));
    }
    least = std::min(least, greatest);
  }
  return least;
}

double EnclosingBalls::lower_from_b(const SolidDistance& b, std::span<const Ball> hollows_of_b,
                                    const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const {
  std::vector<Ball> moved(hollows_of_b.begin(), hollows_of_b.end());
  for (Ball& hollow : moved) hollow.centre = motion.to_a(hollow.centre);
  const auto locate = [&](const Point& centre) {
    const Cube cube = motion.enclosed_in_b(centre);
    return Located{cube.centre, (sqrt(Interval(3)) * Interval(cube.half_width)).upper()};
  };
  return lower_from(b, moved, locate, tolerance, interrupted);
}

double EnclosingBalls::lower_from_a(const SolidDistance& a, std::span<const Ball> hollows_of_a,
                                    const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const {
  std::vector<Ball> moved(hollows_of_a.begin(), hollows_of_a.end());
  for (Ball& hollow : moved) hollow.centre = motion.to_b(hollow.centre);
  const auto locate = [&](const Point& centre) {
    const Point own = motion.to_a(centre);
    return Located{own, motion.distance_up(own, centre)};
  };
  return lower_from(a, moved, locate, tolerance, interrupted);
}

}  // namespace verisq::verify
