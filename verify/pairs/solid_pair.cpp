/// From below by planes between sections of primitives that hold the models, from above by a point of each.
#include "verify/pairs/solid_pair.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "verify/pairs/enclosing_radius.hpp"
#include "verify/proof/intersection.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

bool is_finite(const Point& x) {
  return std::ranges::all_of(x, [](double c) { return std::isfinite(c); });
}

bool is_inside(const SolidParts& solid, const PreciseVector& x) {
  return place_of(x, solid.places.set(), solid.places.primitives()) == Place::inside;
}

/// Lower bounds of the distances of primitives i of A and j of B.
class PairBoundsOfPrimitives {
 public:
  PairBoundsOfPrimitives(std::size_t count_a, std::size_t count_b)
      : columns_(count_b), bounds_(count_a * count_b, -infinity) {}

  void raise(std::size_t i, std::size_t j, double bound) {
    double& known = bounds_[i * columns_ + j];
    known = std::max(known, bound);
  }
  [[nodiscard]] double operator()(std::size_t i, std::size_t j) const { return bounds_[i * columns_ + j]; }

 private:
  std::size_t columns_;
  std::vector<double> bounds_;
};

/// Of what an operator's operands are bounded by from below: a union is no nearer than its nearest operand, an
/// intersection no nearer than any, a difference than its first.
template <class Bound>
double lower_of(const SetExpression& set, const Bound& bound) {
  if (set.operation == SetOperation::subtract) return bound(set.operands.front());
  double result = bound(set.operands.front());
  for (const SetExpression& operand : std::span(set.operands).subspan(1)) {
    const double other = bound(operand);
    result = set.operation == SetOperation::unite ? std::min(result, other) : std::max(result, other);
  }
  return result;
}

/// No point of A's set is nearer to one of B's.
double lower(const SetExpression& a, const SetExpression& b, const PairBoundsOfPrimitives& bounds) {
  if (!a.operands.empty()) return lower_of(a, [&](const SetExpression& part) { return lower(part, b, bounds); });
  if (!b.operands.empty()) return lower_of(b, [&](const SetExpression& part) { return lower(a, part, bounds); });
  return bounds(a.primitive, b.primitive);
}

/// Of a primitive of one model from the other, whose frame `motion` leads to the one's: it is no nearer than the centre
/// of a ball about it, less the ball's radius.
double lower_by_ball(const EnclosingBall& ball, const SolidParts& one, const SolidParts& other,
                     const RigidMotion& motion) {
  if (!is_finite(ball.centre)) return -infinity;
  const PreciseVector centre = motion(precise(ball.centre));
  const double radius = farthest_up(one.primitives[ball.primitive], centre, ball.multiplier);
  const double distance = other.places(ball.centre, {ball.distance, infinity}, ball.proof).lo;
  return std::isfinite(radius) && std::isfinite(distance) ? subtract(distance, radius, Direction::down) : -infinity;
}

}  // namespace

bool SolidPair::share(const Point& x) const {
  return is_finite(x) && is_inside(*a_, precise(x)) && is_inside(*b_, motion_.inverse()(precise(x)));
}

double SolidPair::upper(const std::array<Point, 2>& near_points) const {
  const auto& [on_a, on_b] = near_points;
  if (!is_finite(on_a) || !is_finite(on_b)) return infinity;
  if (!is_inside(*a_, precise(on_a)) || !is_inside(*b_, precise(on_b))) return infinity;
  return length<Real>(PreciseVector(motion_(precise(on_b)) - precise(on_a))).upper().to_double(Direction::up);
}

double SolidPair::lower_by_spheres(std::size_t i, std::size_t j) const {
  const auto radius = [](const auto& solid) { return solid.radius(); };
  const auto origin = [](const auto& solid) { return solid.motion().translation; };
  const PosedPrimitive& one = a_->places.primitives()[i];
  const PosedPrimitive& other = b_->places.primitives()[j];
  const PreciseVector between = motion_(std::visit(origin, other)) - std::visit(origin, one);
  const PreciseInterval radii = std::visit(radius, one) + std::visit(radius, other);
  return (length<Real>(between) - radii).lower().to_double(Direction::down);
}

namespace {

/// Two primitives, one of which is moved, and where the other's centre lies from the one's.
struct PosedSectionPair {
  const PosedSections& one;
  const PosedSections& other;
  RigidMotion moved;  ///< from the other's own frame to that of model A
  PreciseVector between;

  PosedSectionPair(const PosedSections& a, const PosedSections& b, const RigidMotion& motion)
      : one(a), other(b), moved(motion.after(b.motion())), between(moved.translation - a.motion().translation) {}

  /// With the plane's normal n, d >= (n·(c_B - c_A) - r_A(n) - r_B(-n)) / |n|, r how far the sections reach from the
  /// primitives' centres c.
  [[nodiscard]] double lower_by(const SectionPlane& plane, const PosedSections::Section& of_a,
                                const PosedSections::Section& of_b) const {
    const auto& [normal, slope_a, slope_b] = plane;
    if (!usable({normal[0], normal[1], normal[2]}) || !std::isfinite(slope_a) || !std::isfinite(slope_b)) {
      return -infinity;
    }
    const PreciseVector n = precise(normal);
    const PreciseInterval reach_a(one.reach(one.motion().rotation.transpose() * n, of_a, slope_a));
    const PreciseInterval reach_b(other.reach(-(moved.rotation.transpose() * n), of_b, slope_b));
    return ((n.dot(between) - reach_a - reach_b) / length<Real>(n)).lower().to_double(Direction::down);
  }
};

}  // namespace

/// Minus infinity unless every pair of sections has a plane.
double SolidPair::lower_by(const DividedSeparation& separation) const {
  const PosedSectionPair pair(a_->sections[separation.primitive_a], b_->sections[separation.primitive_b], motion_);
  std::vector<std::pair<Section, Section>> open{{pair.one.whole(), pair.other.whole()}};
  double least = infinity;
  std::size_t planes = 0;
  for (const SectionCut cut : separation.cuts) {
    if (open.empty()) return -infinity;
    const auto [of_a, of_b] = open.back();
    open.pop_back();
    if (cut == SectionCut::none) {
      if (planes == separation.planes.size()) return -infinity;
      least = std::min(least, pair.lower_by(separation.planes[planes++], of_a, of_b));
      if (least == -infinity) return least;
      continue;
    }
    const auto parts = halves(cut == SectionCut::a ? of_a : of_b);
    if (!parts) return -infinity;
    for (const Section& part : {(*parts)[1], (*parts)[0]}) {
      open.emplace_back(cut == SectionCut::a ? part : of_a, cut == SectionCut::a ? of_b : part);
    }
  }
  return open.empty() ? least : -infinity;
}

Enclosure SolidPair::proven_distance(const PairCertificate& certificate) const {
  if (certificate.common && share(*certificate.common)) return {0.0, 0.0};
  const std::size_t count_a = a_->sections.size();
  const std::size_t count_b = b_->sections.size();
  PairBoundsOfPrimitives bounds(count_a, count_b);
  for (std::size_t i = 0; i < count_a; ++i) {
    for (std::size_t j = 0; j < count_b; ++j) bounds.raise(i, j, lower_by_spheres(i, j));
  }
  for (const DividedSeparation& separation : certificate.divisions) {
    if (separation.primitive_a >= count_a || separation.primitive_b >= count_b) continue;
    bounds.raise(separation.primitive_a, separation.primitive_b, lower_by(separation));
  }
  for (const EnclosingBall& ball : certificate.balls_a) {
    if (ball.primitive >= count_a) continue;
    const double bound = lower_by_ball(ball, *a_, *b_, motion_);
    for (std::size_t j = 0; j < count_b; ++j) bounds.raise(ball.primitive, j, bound);
  }
  for (const EnclosingBall& ball : certificate.balls_b) {
    if (ball.primitive >= count_b) continue;
    const double bound = lower_by_ball(ball, *b_, *a_, motion_.inverse());
    for (std::size_t i = 0; i < count_a; ++i) bounds.raise(i, ball.primitive, bound);
  }
  const double from_below = lower(a_->places.set(), b_->places.set(), bounds);
  return between(std::max(0.0, from_below), certificate.near_points ? upper(*certificate.near_points) : infinity,
                 [] { return "the distance of the models"; });
}

}  // namespace verisq::verify
