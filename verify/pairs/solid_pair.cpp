/// From below by planes between sections of primitives that hold the models, from above by a point of each.
#include "verify/pairs/solid_pair.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "verify/analysis/finite_point.hpp"
#include "verify/pairs/enclosing_radius.hpp"
#include "verify/pairs/posed_body.hpp"
#include "verify/proof/intersection.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// In the frame of its model.
EnclosingSphere sphere_about(const PosedPrimitive& primitive) {
  return std::visit(
      [](const auto& solid) {
        return EnclosingSphere{solid.motion().translation, solid.radius()};
      },
      primitive);
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
  /// Of i and every j, and the other way round.
  void raise_all_of_a(std::size_t i, double bound) {
    for (std::size_t j = 0; j < columns_; ++j) raise(i, j, bound);
  }
  void raise_all_of_b(std::size_t j, double bound) {
    for (std::size_t i = 0; i * columns_ < bounds_.size(); ++i) raise(i, j, bound);
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
double lower_of_sets(const SetExpression& a, const SetExpression& b, const PairBoundsOfPrimitives& bounds) {
  const auto with_part_of_a = [&](const SetExpression& part) { return lower_of_sets(part, b, bounds); };
  const auto with_part_of_b = [&](const SetExpression& part) { return lower_of_sets(a, part, bounds); };
  if (!a.operands.empty()) return lower_of(a, with_part_of_a);
  if (!b.operands.empty()) return lower_of(b, with_part_of_b);
  return bounds(a.primitive, b.primitive);
}

/// Of a primitive of one model from the other, whose frame `to_one` leads to the one's: it is no nearer than the centre
/// of a ball about it, less the ball's radius. Precondition: the centre is finite.
double lower_by_ball(const EnclosingBall& ball, const SolidParts& one, const SolidParts& other,
                     const RigidMotion& to_one) {
  const PreciseVector centre = to_one(precise(ball.centre));
  const double radius = farthest_up(one.primitives[ball.primitive], centre, ball.multiplier);
  const double distance = other.places(ball.centre, {ball.distance, infinity}, ball.proof).lo;
  return std::isfinite(radius) && std::isfinite(distance) ? subtract(distance, radius, Direction::down) : -infinity;
}

/// Of a primitive of `one`, which moves, from the other model, which has nothing nearer than the cover's radius.
double lower_by_cover(const SurroundedPrimitive& surrounded, const SolidParts& one, const SolidParts& other,
                      const ShortMotion& motion) {
  const auto* const convex = std::get_if<PosedSuperquadric>(&one.places.primitives()[surrounded.primitive]);
  if (convex == nullptr || !(surrounded.distance > 0.0) || !std::isfinite(surrounded.distance)) return -infinity;
  const PosedBody body(*convex, motion);
  if (!is_finite(body.centre())) return -infinity;
  const EmptyNeighbourhood around(other.places.set(), other.places.primitives(), body, body.centre(),
                                  surrounded.distance);
  return around.is_covered_by(surrounded.cover) ? surrounded.distance : -infinity;
}

}  // namespace

bool SolidPair::share(const Point& x) const {
  return is_finite(x) && is_inside(*a_, precise(x)) && is_inside(*b_, pose_.inverse()(precise(x)));
}

double SolidPair::upper(const std::array<Point, 2>& near_points) const {
  const auto& [on_a, on_b] = near_points;
  if (!is_finite(on_a) || !is_finite(on_b)) return infinity;
  if (!is_inside(*a_, precise(on_a)) || !is_inside(*b_, precise(on_b))) return infinity;
  return length<Real>(PreciseVector(pose_(precise(on_b)) - precise(on_a))).upper().to_double(Direction::up);
}

double SolidPair::lower_by_spheres(std::size_t i, std::size_t j) const {
  const auto [centre_a, radius_a] = sphere_about(a_->places.primitives()[i]);
  const auto [own_centre_b, radius_b] = sphere_about(b_->places.primitives()[j]);
  const PreciseVector centre_b = pose_(own_centre_b);
  const PreciseVector between = centre_b - centre_a;
  return (length<Real>(between) - motion_.way_of(centre_b) - radius_a - radius_b).lower().to_double(Direction::down);
}

namespace {

/// Two primitives, one of which moves.
struct MovingSections {
  const PosedSections& one;
  const PosedSections& other;
  const ShortMotion& motion;
  EnclosingSphere about_other;  ///< in the frame of model A, at the moment
  RigidMotion moved;            ///< from the other's own frame to that of model A, at the moment

  /// With the plane's normal n, d >= (n·(c_B - c_A) - r_A(n) - r_B(-n)) / |n|, r how far the sections reach from the
  /// primitives' centres c, at the moment.
  [[nodiscard]] double lower_by(const SectionPlane& plane, const PosedSections::Section& of_a,
                                const PosedSections::Section& of_b) const {
    const auto& [normal, slope_a, slope_b] = plane;
    if (!usable({normal[0], normal[1], normal[2]}) || !std::isfinite(slope_a) || !std::isfinite(slope_b)) {
      return -infinity;
    }
    const PreciseVector n = precise(normal);
    const PreciseInterval reach_a(one.reach(one.motion().rotation.transpose() * n, of_a, slope_a));
    const auto reach_b = [&, slope = slope_b](const PreciseVector& m) {
      return other.reach(moved.rotation.transpose() * m, of_b, slope);
    };
    const PreciseInterval near_side_of_b = motion.least_along(n, about_other, moved.translation, reach_b);
    const PreciseInterval far_side_of_a = n.dot(one.motion().translation) + reach_a;
    return ((near_side_of_b - far_side_of_a) / length<Real>(n)).lower().to_double(Direction::down);
  }
};

}  // namespace

/// Minus infinity unless every pair of sections has a plane.
double SolidPair::lower_by(const DividedSeparation& separation) const {
  const PosedSections& of_b = b_->sections[separation.primitive_b];
  const auto [centre, radius] = sphere_about(b_->places.primitives()[separation.primitive_b]);
  const MovingSections pair{
      a_->sections[separation.primitive_a], of_b, motion_, {pose_(centre), radius}, pose_.after(of_b.motion())};
  std::vector<std::pair<Section, Section>> open{{pair.one.whole(), pair.other.whole()}};
  double least = infinity;
  std::size_t planes = 0;
  for (const SectionCut cut : separation.cuts) {
    if (open.empty()) return -infinity;
    const auto [section_a, section_b] = open.back();
    open.pop_back();
    if (cut == SectionCut::none) {
      if (planes == separation.planes.size()) return -infinity;
      least = std::min(least, pair.lower_by(separation.planes[planes++], section_a, section_b));
      if (least == -infinity) return least;
      continue;
    }
    const auto parts = halves(cut == SectionCut::a ? section_a : section_b);
    if (!parts) return -infinity;
    for (const Section& part : {(*parts)[1], (*parts)[0]}) {
      open.emplace_back(cut == SectionCut::a ? part : section_a, cut == SectionCut::a ? section_b : part);
    }
  }
  return open.empty() ? least : -infinity;
}

namespace {

double up(const PreciseInterval& x) {
  return x.upper().to_double(Direction::up);
}

}  // namespace

double SolidPair::lower(const PairCertificate& certificate) const {
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
    if (ball.primitive >= count_a || !is_finite(ball.centre)) continue;
    // The centre goes with B: as far as it moves, the primitive may reach beyond the ball.
    const double way = up(motion_.way_of(pose_(precise(ball.centre))));
    const double bound = subtract(lower_by_ball(ball, *a_, *b_, pose_), way, Direction::down);
    bounds.raise_all_of_a(ball.primitive, bound);
  }
  for (const EnclosingBall& ball : certificate.balls_b) {
    if (ball.primitive >= count_b || !is_finite(ball.centre)) continue;
    // The ball goes with B.
    const double way = up(motion_.way_of(precise(ball.centre)));
    const double bound = subtract(lower_by_ball(ball, *b_, *a_, pose_.inverse()), way, Direction::down);
    bounds.raise_all_of_b(ball.primitive, bound);
  }
  for (const SurroundedPrimitive& surrounded : certificate.covers_a) {
    if (surrounded.primitive >= count_a) continue;
    const EnclosingSphere sphere = sphere_about(a_->places.primitives()[surrounded.primitive]);
    const double seen = lower_by_cover(surrounded, *a_, *b_, ShortMotion(pose_.inverse()));
    const double bound = subtract(seen, up(motion_.way_seen_of(sphere)), Direction::down);
    bounds.raise_all_of_a(surrounded.primitive, bound);
  }
  for (const SurroundedPrimitive& surrounded : certificate.covers_b) {
    if (surrounded.primitive >= count_b) continue;
    bounds.raise_all_of_b(surrounded.primitive, lower_by_cover(surrounded, *b_, *a_, motion_));
  }
  return lower_of_sets(a_->places.set(), b_->places.set(), bounds);
}

Enclosure SolidPair::at_moment(const PairCertificate& certificate) const {
  if (certificate.common && share(*certificate.common)) return {0.0, 0.0};
  return between(std::max(0.0, lower(certificate)),
                 certificate.near_points ? upper(*certificate.near_points) : infinity,
                 [] { return "the distance of the models"; });
}

}  // namespace verisq::verify
