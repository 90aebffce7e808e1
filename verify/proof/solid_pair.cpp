/// This file implements solid_pair.hpp.
#include "verify/proof/solid_pair.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// 2^(1/2 - 1/p), at least 1, for p = 2/e.
PreciseInterval excess_of_norm(double exponent) {
  if (exponent >= 1.0) return 1;
  const PreciseInterval half = PreciseInterval(1) / PreciseInterval(2);
  return pow(PreciseInterval(2), half * (PreciseInterval(1) - PreciseInterval(Real(exponent))));
}

}  // namespace

bool is_ball(const Primitive& primitive) {
  const auto& [axes, exponents, taper] = primitive.superquadric;
  return axes[0] == axes[1] && axes[1] == axes[2] && exponents == std::array{1.0, 1.0} && taper == 1.0 &&
         !is_bent(primitive);
}

std::array<double, 3> semi_axes_of_ellipsoid(const Superquadric& solid) {
  const PreciseInterval whole = excess_of_norm(solid.exponents[0]);
  const PreciseInterval section = whole * excess_of_norm(solid.exponents[1]);
  const auto up = [](const PreciseInterval& scale, double axis) {
    return (scale * PreciseInterval(Real(axis))).upper().to_double(Direction::up);
  };
  return {up(section, solid.semi_axes[0]), up(section, solid.semi_axes[1]), up(whole, solid.semi_axes[2])};
}

double farthest_up(const Primitive& primitive, const PreciseVector& x, double multiplier) {
  if (is_bent(primitive) || is_tapered(primitive.superquadric)) return infinity;
  const RigidMotion motion(primitive.pose);
  const PreciseVector from_centre = x - motion.translation;
  if (is_ball(primitive)) {
    const PreciseInterval radius{Real(primitive.superquadric.semi_axes[0])};
    return (length<Real>(from_centre) + radius).upper().to_double(Direction::up);
  }
  const PreciseVector c = motion.rotation.transpose() * from_centre;
  const std::array<double, 3> b = semi_axes_of_ellipsoid(primitive.superquadric);
  if (!std::isfinite(multiplier) || !std::ranges::all_of(b, [](double axis) { return std::isfinite(axis); })) {
    return infinity;
  }
  const PreciseInterval mu{Real(multiplier)};
  PreciseInterval squared = mu;
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval room = mu - square(PreciseInterval(Real(b[i])));
    if (!(room.lower() > Real(0))) return infinity;
    squared += square(c[i]) * mu / room;
  }
  return sqrt(squared).upper().to_double(Direction::up);
}

namespace {

Bend bend_of(const Primitive& primitive) {
  return is_bent(primitive) ? *primitive.bend : Bend{0.0, 0.0};
}

}  // namespace

PosedSections::PosedSections(const Primitive& primitive)
    : bounds_(primitive.superquadric),
      focus_(focus(primitive.superquadric)),
      motion_(primitive.pose),
      half_length_(primitive.superquadric.semi_axes[2]),
      curvature_(Real(bend_of(primitive).curvature)),
      cosine_(cosine_of_degrees(bend_of(primitive).angle_degrees)),
      sine_(sine_of_degrees(bend_of(primitive).angle_degrees)),
      extent_(std::max(bounds_.support_up({cosine_, sine_, 0}), bounds_.support_up({-cosine_, -sine_, 0}))) {}

/// (x, y, z) -> (r, s, z): r along the bend.
PreciseVector PosedSections::turned(const PreciseVector& n) const {
  return {n[0] * cosine_ + n[1] * sine_, n[1] * cosine_ - n[0] * sine_, n[2]};
}

Real PosedSections::reach(const PreciseVector& n, const Section& section, double slope) const {
  if (curvature_.lower() == Real(0) && curvature_.upper() == Real(0)) {
    return (PreciseInterval(bounds_.support_up(n)) + n.dot(focus_)).upper();
  }
  const PreciseVector m = turned(n);
  const PreciseInterval v{Real(slope)};
  Real at_ends(-infinity);
  Real least_curving(infinity);  // of k c
  for (const double height : {section.lower, section.upper}) {
    const PreciseInterval z{Real(height)};
    const PreciseInterval angle = curvature_ * z;
    const PreciseInterval half = angle / PreciseInterval(2);
    const PreciseInterval axis = z * (m[0] * sine_of(half) * quotient_of_sine(half) + m[2] * quotient_of_sine(angle));
    const PreciseInterval c = m[0] * cosine_of(angle) - m[2] * sine_of(angle);
    const PreciseVector direction{c * cosine_ - m[1] * sine_, c * sine_ + m[1] * cosine_, v};
    const PreciseInterval support(bounds_.support_up(direction));
    at_ends = std::max(at_ends, (axis + support + v * (focus_[2] - z)).upper());
    least_curving = std::min(least_curving, (curvature_ * c).lower());
  }
  const PreciseInterval between = PreciseInterval(Real(section.upper)) - PreciseInterval(Real(section.lower));
  const PreciseInterval eighth = square(between) / PreciseInterval(8);
  // c'' = -k² c and |c| <= |(n_R, n_Z)|: the most that c leaves its chord, and so its ends.
  const PreciseInterval c_off = square(curvature_) * sqrt(square(m[0]) + square(m[2])) * eighth;
  const Real concave = (abs(curvature_) * c_off - PreciseInterval(least_curving)).upper();
  const PreciseInterval e_off = PreciseInterval(std::max(Real(0), concave)) * eighth;
  return (PreciseInterval(at_ends) + e_off + extent_ * c_off).upper();
}

std::optional<std::array<PosedSections::Section, 2>> halves(const PosedSections::Section& section) {
  const double middle = 0.5 * section.lower + 0.5 * section.upper;
  if (!(middle > section.lower && middle < section.upper)) return std::nullopt;
  return std::array{PosedSections::Section{section.lower, middle}, PosedSections::Section{middle, section.upper}};
}

namespace {

Coordinates<double> about(const PreciseVector& v) {
  const Proposal m = midpoint(v);
  return {static_cast<double>(m[0]), static_cast<double>(m[1]), static_cast<double>(m[2])};
}

}  // namespace

PosedBody::PosedBody(const PosedSuperquadric& solid, const ShortMotion& motion)
    : solid_(&solid),
      motion_(motion),
      place_(motion.pose().after(solid.motion())),
      centre_(about(place_.translation)),
      plain_(solid.superquadric()),
      rows_{about(place_.rotation.row(0)), about(place_.rotation.row(1)), about(place_.rotation.row(2))} {}

// v·x is at most minus the least of -v·x.
Real PosedBody::reach(const PreciseVector& v) const {
  const auto at_moment = [this](const PreciseVector& m) {
    return solid_->bounds().support_up(place_.rotation.transpose() * m);
  };
  const EnclosingSphere sphere{place_.translation, solid_->radius()};
  const PreciseInterval least = motion_.least_along(-v, sphere, place_.translation, at_moment);
  return (-PreciseInterval(least.lower()) - v.dot(precise(centre_))).upper();
}

Coordinates<double> PosedBody::farthest(const Coordinates<double>& v) const {
  Plain own{};
  for (std::size_t j = 0; j < 3; ++j) own[j] = rows_[0][j] * v[0] + rows_[1][j] * v[1] + rows_[2][j] * v[2];
  const Plain x = plain_(own);
  const Plain from_centre{dot(rows_[0], x), dot(rows_[1], x), dot(rows_[2], x)};
  const Plain way = about(motion_.first_way_of(precise(along(centre_, from_centre, 1.0))));
  return along(from_centre, way, dot(way, v) < 0.0 ? -1.0 : 1.0);
}

namespace {

/// A sphere about the primitive, in the frame of its model.
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
  /// Raises the bounds of i and every j, or of j and every i.
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

/// The lower bound of a set from lower bounds of its operands: a union is no nearer than its nearest operand, an
/// intersection no nearer than any operand, a difference no nearer than its first.
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

/// A lower bound: no point of A's set is nearer to a point of B's.
double lower_of_sets(const SetExpression& a, const SetExpression& b, const PairBoundsOfPrimitives& bounds) {
  const auto with_part_of_a = [&](const SetExpression& part) { return lower_of_sets(part, b, bounds); };
  const auto with_part_of_b = [&](const SetExpression& part) { return lower_of_sets(a, part, bounds); };
  if (!a.operands.empty()) return lower_of(a, with_part_of_a);
  if (!b.operands.empty()) return lower_of(b, with_part_of_b);
  return bounds(a.primitive, b.primitive);
}

/// A lower bound of the distance of a primitive of one model from the other model; `to_one` leads from the other's
/// frame to the one's. The primitive is no nearer than the centre of a ball about it, less the ball's radius.
/// Precondition: the centre is finite.
double lower_by_ball(const EnclosingBall& ball, const SolidParts& one, const SolidParts& other,
                     const RigidMotion& to_one, const Hook& interrupted) {
  const PreciseVector centre = to_one(precise(ball.centre));
  const double radius = farthest_up(one.primitives[ball.primitive], centre, ball.multiplier);
  const double distance = other.places(ball.centre, {ball.distance, infinity}, ball.proof, interrupted).lo;
  return std::isfinite(radius) && std::isfinite(distance) ? subtract(distance, radius, Direction::down) : -infinity;
}

/// A lower bound of the distance of a primitive of `one`, which moves, from the other model, which has no point within
/// the cover's radius.
double lower_by_cover(const SurroundedPrimitive& surrounded, const SolidParts& one, const SolidParts& other,
                      const ShortMotion& motion, const Hook& interrupted) {
  const auto* const convex = std::get_if<PosedSuperquadric>(&one.places.primitives()[surrounded.primitive]);
  if (convex == nullptr || !(surrounded.distance > 0.0) || !std::isfinite(surrounded.distance)) return -infinity;
  const PosedBody body(*convex, motion);
  if (!is_finite(body.centre())) return -infinity;
  const EmptyNeighbourhood around(other.places.set(), other.places.primitives(), body, body.centre(),
                                  surrounded.distance);
  return around.is_covered_by(surrounded.cover, interrupted) ? surrounded.distance : -infinity;
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

  /// With the plane's normal n, d >= (n·(c_B - c_A) - r_A(n) - r_B(-n)) / |n|, where r is the reach of the sections
  /// from the primitives' centres c, at the moment.
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
    if (open.empty() || ended()) return -infinity;
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
    const double bound = subtract(lower_by_ball(ball, *a_, *b_, pose_, interrupted_), way, Direction::down);
    bounds.raise_all_of_a(ball.primitive, bound);
  }
  for (const EnclosingBall& ball : certificate.balls_b) {
    if (ball.primitive >= count_b || !is_finite(ball.centre)) continue;
    // The ball goes with B.
    const double way = up(motion_.way_of(precise(ball.centre)));
    const double bound = subtract(lower_by_ball(ball, *b_, *a_, pose_.inverse(), interrupted_), way, Direction::down);
    bounds.raise_all_of_b(ball.primitive, bound);
  }
  for (const SurroundedPrimitive& surrounded : certificate.covers_a) {
    if (surrounded.primitive >= count_a) continue;
    const EnclosingSphere sphere = sphere_about(a_->places.primitives()[surrounded.primitive]);
    const double seen = lower_by_cover(surrounded, *a_, *b_, ShortMotion(pose_.inverse()), interrupted_);
    const double bound = subtract(seen, up(motion_.way_seen_of(sphere)), Direction::down);
    bounds.raise_all_of_a(surrounded.primitive, bound);
  }
  for (const SurroundedPrimitive& surrounded : certificate.covers_b) {
    if (surrounded.primitive >= count_b) continue;
    bounds.raise_all_of_b(surrounded.primitive, lower_by_cover(surrounded, *b_, *a_, motion_, interrupted_));
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
