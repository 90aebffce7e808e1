/// This file implements primitive_pair_distance.hpp.
#include "verify/search/primitive_pair_distance.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/solids/bend.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

SectionMapping::End about(const SectionedPrimitive::End& end) {
  return {end.height, middle(end.cosine), middle(end.sine), middle(end.along), middle(end.up)};
}

SectionMapping::Section about(const SectionedPrimitive::Section& section) {
  return {about(section.lower), about(section.upper)};
}

}  // namespace

SectionedPrimitive::SectionedPrimitive(const Primitive& primitive)
    : half_length_(primitive.superquadric.semi_axes[2]),
      bounds_(primitive.superquadric),
      focus_(in_binary64(focus(primitive.superquadric)[2])),
      mapping_(primitive) {
  if (!is_bent(primitive)) return;
  curvature_ = primitive.bend->curvature;
  map_.emplace(*primitive.bend);
  extent_ = extent(*primitive.bend, primitive.superquadric).upper().to_double(Direction::up);
}

SectionedPrimitive::End SectionedPrimitive::end_at(double height) const {
  const Interval z(height);
  if (!map_) return {height, 1, 0, 0, z};
  const Interval angle = Interval(curvature_) * z;
  const Interval half = angle / Interval(2);
  return {height, cos(angle), sin(angle), z * sin(half) * sine_quotient(half), z * sine_quotient(angle)};
}

SectionedPrimitive::Section SectionedPrimitive::whole() const {
  return {end_at(-half_length_), end_at(half_length_)};
}

std::optional<std::array<SectionedPrimitive::Section, 2>> SectionedPrimitive::halves(const Section& section) const {
  const double height = 0.5 * section.lower.height + 0.5 * section.upper.height;
  if (!map_ || !(height > section.lower.height && height < section.upper.height)) return std::nullopt;
  const End between = end_at(height);
  return std::array{Section{section.lower, between}, Section{between, section.upper}};
}

double SectionedPrimitive::slack(const Section& section) const {
  const double between = section.upper.height - section.lower.height;
  const double k = std::fabs(curvature_);
  return k * (1.0 + k * extent_) * between * between / 8.0;
}

double SectionedPrimitive::slope(const Coordinates<double>& direction, const Section& section) const {
  return mapping_.slope(direction, about(section));
}

Coordinates<double> SectionedPrimitive::support_point(const Coordinates<double>& direction,
                                                      const Section& section) const {
  return mapping_.support_point(direction, about(section));
}

double SectionedPrimitive::support_up(const Vector3<double>& direction, const Section& section) const {
  if (!map_) return (Interval(bounds_.support_up(direction)) + direction[2] * focus_).upper();
  const Vector3<double> n = map_->turned(direction);
  const double chosen = slope({middle(direction[0]), middle(direction[1]), middle(direction[2])}, section);
  if (!std::isfinite(chosen)) return infinity;
  const Interval v(chosen);
  const Vector3<double> r = map_->direction();
  double largest = -infinity;
  Interval c_of_both;
  for (const End* const end : {&section.lower, &section.upper}) {
    const Interval c = n[0] * end->cosine - n[2] * end->sine;
    const Interval support(bounds_.support_up({c * r[0] - n[1] * r[1], c * r[1] + n[1] * r[0], v}));
    const Interval axis = n[0] * end->along + n[2] * end->up;
    largest = std::max(largest, (axis + support + v * (focus_ - Interval(end->height))).upper());
    c_of_both = end == &section.lower ? c : hull(c_of_both, c);
  }
  const Interval k(curvature_);
  const Interval between = Interval(section.upper.height) - Interval(section.lower.height);
  const Interval eighth = square(between) / Interval(8);
  // |c| <= |(n_R, n_Z)|: the most that c leaves its chord, and so its ends.
  const Interval c_off = square(k) * sqrt(square(n[0]) + square(n[2])) * eighth;
  const Interval signed_c = curvature_ > 0.0 ? c_of_both : -c_of_both;
  const Interval concave(std::max(0.0, (c_off - signed_c).upper()));
  return (Interval(largest) + abs(k) * concave * eighth + Interval(extent_) * c_off).upper();
}

namespace {

constexpr std::uint64_t kStepsWhereHullsMeet = 64;

Vector3<double> exact(const Coordinates<double>& v) {
  return {Interval(v[0]), Interval(v[1]), Interval(v[2])};
}

/// About the centre, whatever taper and bend do: sections grow by less than 2, a focus lies within the solid.
double reach_of(const Superquadric& solid) {
  return 4.0 * (solid.semi_axes[0] + solid.semi_axes[1] + solid.semi_axes[2]);
}

}  // namespace

SeparablePrimitive::SeparablePrimitive(const Primitive& primitive)
    : sections(primitive),
      centre(primitive.pose.translation),
      reach(reach_of(primitive.superquadric)),
      bent(is_bent(primitive)),
      motion(primitive.pose),
      about(primitive.pose),
      to_own_frame(in_binary64(motion.rotation.transpose())) {}

PrimitivePairDistance::PrimitivePairDistance(const SeparablePrimitive& a, const SeparablePrimitive& b, const Pose& pose,
                                             double tolerance)
    : a_(&a), b_(&b), motion_(pose), tolerance_(tolerance), settled_(infinity) {
  const RigidMotion moved = RigidMotion(pose).after(b.motion);
  to_b_ = in_binary64(moved.rotation.transpose());
  between_ = in_binary64(PreciseVector(moved.translation - a.motion.translation));
  const auto root = [](const SectionedPrimitive& primitive) {
    const SectionedPrimitive::Section whole = primitive.whole();
    return Node{whole, primitive.slack(whole)};
  };
  nodes_a_ = {root(a.sections)};
  nodes_b_ = {root(b.sections)};
  divisions_ = {Division{0, 0}};
  queue_.push({0.0, nodes_a_[0].slack + nodes_b_[0].slack, 0, 0, 0, {}, {}, {}});
}

double PrimitivePairDistance::lower() const {
  return std::min(settled_, queue_.empty() ? infinity : queue_.top().lower);
}

std::optional<PrimitivePairDistance::Points> PrimitivePairDistance::near_points() const {
  if (steps_ == 0 || queue_.empty()) return std::nullopt;
  const SectionPair& best = queue_.top();
  const Points points{best.on_a, motion_.inverse_point(best.on_b)};
  const auto finite = [](double c) { return std::isfinite(c); };
  if (!std::ranges::all_of(points.on_a, finite) || !std::ranges::all_of(points.on_b, finite)) return std::nullopt;
  return points;
}

bool PrimitivePairDistance::raise(double enough, std::uint64_t steps, const std::function<bool()>& interrupted) {
  const std::uint64_t before = steps_;
  while (steps_ - before < steps && !queue_.empty() && !(lower() >= enough)) {
    if (lower() == 0.0 && steps_ >= kStepsWhereHullsMeet) break;
    if (interrupted() || !step(enough)) break;
  }
  return steps_ > before;
}

/// False where dividing promises nothing.
bool PrimitivePairDistance::step(double enough) {
  const SectionPair pair = queue_.top();
  if (steps_ == 0) {
    queue_.pop();
    ++steps_;
    SectionPair whole = pair;
    for (std::size_t i = 0; i < 3; ++i) whole.separation[i] = between_[i].lower();
    bound(whole, enough);
    return true;
  }
  if (pair.slack <= tolerance_) return false;
  const bool first = nodes_a_[pair.a].slack >= nodes_b_[pair.b].slack;
  const auto children = first ? divided(a_->sections, nodes_a_, pair.a) : divided(b_->sections, nodes_b_, pair.b);
  if (!children) return false;
  queue_.pop();
  ++steps_;
  divisions_[pair.division].cut = first ? SectionCut::a : SectionCut::b;
  divisions_[pair.division].halves = static_cast<std::uint32_t>(divisions_.size());
  for (std::uint32_t i = *children; i < *children + 2; ++i) {
    SectionPair half = pair;
    (first ? half.a : half.b) = i;
    half.division = static_cast<std::uint32_t>(divisions_.size());
    divisions_.push_back({.a = half.a, .b = half.b, .normal = divisions_[pair.division].normal});
    half.slack = nodes_a_[half.a].slack + nodes_b_[half.b].slack;
    bound(half, enough);
  }
  return true;
}

/// The plane that separated the whole pair often separates its parts.
void PrimitivePairDistance::bound(SectionPair pair, double enough) {
  separate(pair);
  if (pair.lower >= enough) {
    settled_ = std::min(settled_, pair.lower);
    return;
  }
  const auto set_a = [&](const Plain& v) {
    const SectionedPrimitive& primitive = a_->sections;
    return a_->about.point(primitive.support_point(a_->about.inverse_direction(v), nodes_a_[pair.a].section));
  };
  const auto set_b = [&](const Plain& v) {
    const SectionedPrimitive& primitive = b_->sections;
    const Plain own = b_->about.inverse_direction(motion_.inverse_direction(v));
    return motion_.point(b_->about.point(primitive.support_point(own, nodes_b_[pair.b].section)));
  };
  const GjkTolerance<double> tolerance{.relative = 0.0, .absolute = 0.25 * tolerance_};
  const GjkResult<double> found = gjk<double>(set_a, set_b, pair.separation, tolerance);
  pair.separation = found.separation;
  pair.on_a = found.on_a;
  pair.on_b = found.on_b;
  separate(pair);
  queue_.push(pair);
}

/// Sets the bound by the current plane, if it is no worse than the known bound.
void PrimitivePairDistance::separate(SectionPair& pair) {
  const double proven = lower_by(pair.separation, pair.a, pair.b);
  if (!(proven >= pair.lower)) return;
  pair.lower = proven;
  divisions_[pair.division].normal = pair.separation;
}

DividedSeparation PrimitivePairDistance::certificate(std::uint32_t primitive_a, std::uint32_t primitive_b) const {
  DividedSeparation result{primitive_a, primitive_b, {}, {}};
  add_planes(divisions_.front(), result);
  return result;
}

/// The recursion is no deeper than the halvings of both sections' heights in binary64.
void PrimitivePairDistance::add_planes(const Division& division, DividedSeparation& certificate) const {
  const auto& [a, b, cut, halves, normal] = division;
  certificate.cuts.push_back(cut);
  if (cut != SectionCut::none) {
    for (std::uint32_t half = halves; half < halves + 2; ++half) add_planes(divisions_[half], certificate);
    return;
  }
  const Plain own_a = a_->about.inverse_direction(normal);
  const Plain own_b = b_->about.inverse_direction(motion_.inverse_direction(normal));
  const auto finite = [](double slope) { return std::isfinite(slope) ? slope : 0.0; };
  const double slope_a = finite(a_->sections.slope(own_a, nodes_a_[a].section));
  const double slope_b = finite(b_->sections.slope({-own_b[0], -own_b[1], -own_b[2]}, nodes_b_[b].section));
  certificate.planes.push_back({{normal[0], normal[1], normal[2]}, slope_a, slope_b});
}

/// Minus infinity if it proves nothing, for example if numbers overflow and intervals have none.
double PrimitivePairDistance::lower_by(const Plain& direction, std::uint32_t a, std::uint32_t b) const {
  try {
    return proven_by(direction, a, b);
  } catch (const std::domain_error&) {
    return -infinity;
  }
}

double PrimitivePairDistance::proven_by(const Plain& direction, std::uint32_t a, std::uint32_t b) const {
  const double length_about = std::hypot(direction[0], direction[1], direction[2]);
  if (!(length_about > 0.0) || !std::isfinite(length_about)) return -infinity;
  const Vector3<double> n =
      exact({direction[0] / length_about, direction[1] / length_about, direction[2] / length_about});
  const Interval support_a(a_->sections.support_up(a_->to_own_frame * n, nodes_a_[a].section));
  const Interval support_b(b_->sections.support_up(-(to_b_ * n), nodes_b_[b].section));
  if (!std::isfinite(support_a.upper()) || !std::isfinite(support_b.upper())) return -infinity;
  const Interval gap = n.dot(between_) - support_a - support_b;
  return (gap / length<double>(n)).lower();
}

std::optional<std::uint32_t> PrimitivePairDistance::divided(const SectionedPrimitive& primitive,
                                                            std::vector<Node>& nodes, std::uint32_t index) {
  if (nodes[index].children != 0) return nodes[index].children;
  const auto halves = primitive.halves(nodes[index].section);
  if (!halves) return std::nullopt;
  const auto first = static_cast<std::uint32_t>(nodes.size());
  nodes[index].children = first;
  for (const SectionedPrimitive::Section& half : *halves) nodes.push_back({half, primitive.slack(half)});
  return first;
}

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
