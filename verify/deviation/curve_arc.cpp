/// Nodes by the gauge, bulges by the support function of the curve: norms of 127 bits, all else in binary64, rounded
/// outward by `Interval`.
#include "verify/deviation/curve_arc.hpp"

#include <algorithm>

#include "verify/analysis/in_binary64.hpp"
#include "verify/proof/mixed_norm.hpp"

namespace verisq::verify {

namespace {

double middle_of(const Interval& a, const Interval& b) {
  return 0.25 * a.lower() + 0.25 * a.upper() + 0.25 * b.lower() + 0.25 * b.upper();
}

/// (x^p + y^p)^(1/p) for nonnegative x and y, rounded to the side.
double norm_of(double x, double y, const NormExponent<Real>& p, Direction direction) {
  return norm_of_two<Real>(Real(x), Real(y), p, direction).to_double(direction);
}

/// From (1, 0) to (0, 1) x falls and y rises, either of which tells which point comes first.
bool is_before(const CurvePoint& a, const CurvePoint& b) {
  return b.x.upper() < a.x.lower() || a.y.upper() < b.y.lower();
}

}  // namespace

ArcTree::ArcTree(double exponent) : primal_(primal_exponent<Real>(exponent)), dual_(dual_exponent<Real>(exponent)) {
  const CurvePoint first{Interval(1), Interval(0)};
  const CurvePoint last{Interval(0), Interval(1)};
  points_ = {{first, normal_at(first)}, {last, normal_at(last)}};
  arcs_.push_back({0, 1});
}

/// The gradient of x^p + y^p by p. Its product with the point, x^p + y^p, is 1.
CurvePoint ArcTree::normal_at(const CurvePoint& point) const {
  const Interval p = in_binary64(primal_.value);  // 1 at least, but for rounding
  const Interval exponent(std::max(0.0, (p - Interval(1)).lower()), std::max(0.0, (p - Interval(1)).upper()));
  const auto power_of = [&](const Interval& x) {
    return pow(Interval(std::clamp(x.lower(), 0.0, 1.0), std::clamp(x.upper(), 0.0, 1.0)), exponent);
  };
  return {power_of(point.x), power_of(point.y)};
}

/// (x, y) divided by its gauge lies on the curve, whatever x and y are.
CurvePoint ArcTree::point_towards(double x, double y) const {
  const Interval gauge(norm_of(x, y, primal_, Direction::down), norm_of(x, y, primal_, Direction::up));
  return {Interval(x) / gauge, Interval(y) / gauge};
}

void ArcTree::halve(Arc arc) {
  if (arcs_[arc].first_half != 0) return;
  const Entry whole = arcs_[arc];
  const CurvePoint& from = points_[whole.from].point;
  const CurvePoint& to = points_[whole.to].point;
  // Wherever on the curve this point is, what leads from one end to it and on to the other covers the arc.
  const CurvePoint middle = point_towards(middle_of(from.x, to.x), middle_of(from.y, to.y));
  const bool in_order = whole.in_order && is_before(from, middle) && is_before(middle, to);
  const auto place = static_cast<std::uint32_t>(points_.size());
  points_.push_back({middle, normal_at(middle)});
  arcs_[arc].first_half = static_cast<Arc>(arcs_.size());
  arcs_.push_back({whole.from, place, in_order});
  arcs_.push_back({place, whole.to, in_order});
}

double ArcTree::bulge(Arc arc, double width, double height) const {
  const CurvePoint& from = this->from(arc);
  const CurvePoint& to = this->to(arc);
  const Interval run = abs(from.x - to.x) * Interval(width);
  const Interval rise = abs(from.y - to.y) * Interval(height);
  const Interval chord = sqrt(square(run) + square(rise));
  if (!(chord.lower() > 0.0)) return infinity;
  // Between its ends the curve falls: it leaves the chord by no more than the box of both ends does.
  const double by_box = (run * rise / chord).upper();
  // Its points satisfy n·p <= h(n) for the chord's normal n = (rise, run), where h is the dual norm, which rises with
  // either of its operands.
  const Interval across = rise * Interval(width);
  const Interval along = run * Interval(height);
  const double support = norm_of(across.upper(), along.upper(), dual_, Direction::up);
  const Interval at_end = across * from.x + along * from.y;
  const double by_support = ((Interval(support) - at_end) / chord).upper();
  return std::max(0.0, std::min(by_box, by_support));
}

}  // namespace verisq::verify
