/// This file implements overlap.hpp.
#include "verify/search/overlap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace verisq::verify {

namespace {

/// Distances and depths are asked for to this share of the size, and no step is shorter.
constexpr double resolution = 0x1p-10;

/// One parting asks for so many distances at most: some milliseconds each.
constexpr std::size_t most_distances = 32;

/// One direction is halved so often: until the way is known to a thirtieth.
constexpr int halvings = 5;

/// A direction is worth halving if this share of the best way parts the solids, too.
constexpr double worthwhile = 0.97;

/// Solids that are parted shall be so by more than roundings.
constexpr double clearance = 0x1p-36;  // of the size

Point scaled(const Point& x, double factor) {
  return {x[0] * factor, x[1] * factor, x[2] * factor};
}

/// The 26 directions to the neighbours in a lattice of cubes.
std::vector<Point> lattice_directions() {
  std::vector<Point> directions;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double z : {-1.0, 0.0, 1.0})
        if (const auto direction = unit_of(Point{x, y, z})) directions.push_back(*direction);
  return directions;
}

std::variant<PairDistance, ModelSearch> search_of(const Model& a, const Model& b) {
  if (is_union_of_convex(a) && is_union_of_convex(b)) return PairDistance(a, b);
  return ModelSearch(a, b);
}

Point middle(const EnclosedPoint& x) {
  return {x[0].lo / 2 + x[0].hi / 2, x[1].lo / 2 + x[1].hi / 2, x[2].lo / 2 + x[2].hi / 2};
}

}  // namespace

Overlap::Overlap(const Model& a, const Model& b, const Pose& pose, double size, std::function<bool()> interrupted)
    : a_(a),
      b_(b),
      certified_(a, b, resolution * size),
      distance_(search_of(a, b)),
      pose_(pose),
      motion_(pose),
      size_(size),
      interrupted_(std::move(interrupted)) {
  for (const Primitive& primitive : a.primitives) centres_.push_back(primitive.pose.translation);
  for (const Primitive& primitive : b.primitives) centres_.push_back(motion_.point(primitive.pose.translation));
}

std::array<double, 2> Overlap::depths(const Point& x) const {
  const double tolerance = resolution * size_;
  return {-a_(x, tolerance, interrupted_).hi, -b_(motion_.inverse_point(x), tolerance, interrupted_).hi};
}

Point Overlap::deepest(const std::optional<Point>& common) const {
  const auto deeper = [](const Deep& x, const Deep& y) { return x.depth < y.depth ? y : x; };
  Deep best = deep_at(centres_.front());
  for (const Point& centre : centres_) best = deeper(best, deep_at(centre));
  best = climbed(best);
  return (common ? deeper(best, climbed(deep_at(*common))) : best).place;
}

/// On the way from one solid into the other the sum stays the same. So what is outside counts more, until both hold x,
/// and a little depends on the lesser depth: then roundings leave x in both.
Overlap::Deep Overlap::deep_at(const Point& x) const {
  constexpr double weight_of_outside = 4.0;
  constexpr double weight_of_lesser = 0x1p-6;
  const auto [in_a, in_b] = depths(x);
  const double outside = std::min(in_a, 0.0) + std::min(in_b, 0.0);
  return {in_a + in_b + weight_of_outside * outside + weight_of_lesser * std::min(in_a, in_b), x};
}

/// Up the sum of both depths, which has ridges: each step is tried again as long as it helps, but not for ever.
Overlap::Deep Overlap::climbed(Deep best) const {
  constexpr int most_rounds = 2;
  const std::vector<Point> directions = lattice_directions();
  for (double step = size_ / 4; step > resolution * size_; step /= 2) {
    for (int round = 0; round < most_rounds && !interrupted_(); ++round) {
      const double before = best.depth;
      for (const Point& direction : directions) {
        const Deep tried = deep_at(along(best.place, direction, step));
        if (tried.depth > best.depth) best = tried;
      }
      if (!(best.depth > before)) break;
    }
  }
  return best;
}

std::array<InnerBall, 2> Overlap::balls_about(const Point& x, double tolerance) const {
  const auto ball = [&](const SignedDistance& solid, const Point& centre) {
    CertifiedEnclosure found = solid.certified(centre, tolerance, interrupted_);
    return InnerBall{centre, std::max(0.0, -found.distance.hi), std::move(found.certificate)};
  };
  return {ball(a_, x), ball(b_, motion_.inverse_point(x))};
}

Pose Overlap::after(const Point& translation) const {
  Pose moved = pose_;
  for (std::size_t k = 0; k < 3; ++k) moved.translation[k] += translation[k];
  return moved;
}

/// True if the ball about the deep point in one solid still meets the other solid.
bool Overlap::still_meet(const Point& translation) const {
  const auto [in_a, in_b] = depths_of_deep_;
  return depths(along(deep_, translation, 1.0))[0] > -in_b || depths(along(deep_, translation, -1.0))[1] > -in_a;
}

bool Overlap::parts(const Point& translation) {
  if (still_meet(translation)) return false;
  ++asked_;
  const Pose moved = after(translation);
  const auto* const convex = std::get_if<PairDistance>(&distance_);
  const Enclosure distance =
      convex != nullptr
          ? (*convex)(moved, interrupted_).distance
          : std::get<ModelSearch>(distance_)(moved, {.tolerance = resolution * size_, .interrupted = interrupted_})
                .distance;
  return distance.lo > clearance * size_;
}

/// Halves the way along the direction, as long as the shorter one parts the solids.
bool Overlap::shorten(const Point& direction) {
  const auto go_on = [this] { return asked_ < most_distances && !interrupted_(); };
  double parting = worthwhile * way_;
  if (!go_on() || !parts(scaled(direction, parting))) return false;
  double overlapping = std::clamp(depths_of_deep_[0] + depths_of_deep_[1], 0.0, parting);
  for (int k = 0; k < halvings && go_on(); ++k) {
    const double half = overlapping / 2 + parting / 2;
    (parts(scaled(direction, half)) ? parting : overlapping) = half;
  }
  best_ = direction;
  way_ = parting;
  return true;
}

void Overlap::turn_about_best() {
  constexpr double least_turn = 0.01;
  for (double turn = 0.5; turn > least_turn; turn /= 2) {
    const Point first = unit_across(best_);
    const std::array<Point, 2> sides{first, cross(best_, first)};
    for (std::size_t k = 0; k < 4; ++k) shorten(*unit_of(along(best_, sides[k / 2], k % 2 == 0 ? turn : -turn)));
  }
}

/// The nearest ways out of A and out of B are tried first.
std::optional<PartingTranslation> Overlap::parting(const Point& direction, double reach, const Point& deep) {
  const auto forward = unit_of(direction);
  if (!forward || !(reach > 0.0) || !std::isfinite(reach)) return std::nullopt;
  best_ = *forward;
  way_ = reach;
  asked_ = 0;
  deep_ = deep;
  depths_of_deep_ = depths(deep);
  const double tolerance = resolution * size_;
  const Point in_b = motion_.inverse_point(deep);
  const Point out_of_a = difference(middle(a_.closest_point(deep, tolerance, interrupted_).point), deep);
  const Point out_of_b = difference(in_b, middle(b_.closest_point(in_b, tolerance, interrupted_).point));
  std::vector<Point> directions = lattice_directions();
  for (const Point& out : {*forward, out_of_a, motion_.direction(out_of_b)})
    if (const auto way = unit_of(out)) directions.insert(directions.begin(), *way);
  for (const Point& way : directions) shorten(way);
  turn_about_best();
  if (!(way_ < reach)) return std::nullopt;
  const Point translation = scaled(best_, way_);
  return PartingTranslation{translation, certified_(after(translation), interrupted_).certificate};
}

}  // namespace verisq::verify
