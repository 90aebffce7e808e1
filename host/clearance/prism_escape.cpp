/// Some points of the prism are asked for where they leave the implant; GJK tells whether that is far enough for all.
#include "host/clearance/prism_escape.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/gjk.hpp"

namespace verisq {
namespace {

using verify::MovedPrism;
using verify::WayPrism;

constexpr std::size_t times_of_samples = 5;
constexpr std::size_t most_ways_out = 6;
/// Ways out that differ by less are one.
constexpr double same_direction = 1.0 - 1e-4;

constexpr verify::GjkTolerance<double> apart_at_all{.relative = 0.75, .absolute = 0.0, .most_steps = 60};
constexpr verify::GjkTolerance<double> apart_closely{.relative = 1e-5, .absolute = 0.0, .most_steps = 100};

/// Six points.
struct PrismSet {
  std::array<Point, 6> corners;

  Point operator()(const Point& v) const {
    return *std::ranges::max_element(corners, {}, [&](const Point& corner) { return verify::dot(v, corner); });
  }
};

PrismSet set_of(const MovedPrism& prism, const verify::ApproximateMotion<double>& motion) {
  PrismSet set{};
  for (std::size_t i = 0; i < 3; ++i) {
    set.corners[i] = motion.inverse_point(prism.begin[i]);
    set.corners[3 + i] = motion.inverse_point(prism.end[i]);
  }
  return set;
}

/// Corners and centroid, at some times.
std::vector<Point> samples_of(const MovedPrism& prism) {
  std::vector<Point> samples;
  for (std::size_t k = 0; k < times_of_samples; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(times_of_samples - 1);
    Point centroid{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Point x = verify::along(prism.begin[i], verify::difference(prism.end[i], prism.begin[i]), share);
      samples.push_back(x);
      centroid = verify::along(centroid, x, 1.0 / 3.0);
    }
    samples.push_back(centroid);
  }
  return samples;
}

/// To few decimals: what is lost is little, and the text is short.
Point short_normal(const Point& v) {
  constexpr double digits = 1e6;
  const double size = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  Point result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = std::round(v[i] / size * digits) / digits;
  return result;
}

struct WayOut {
  Point direction;
  double depth;
};

}  // namespace

PrismEscape::PrismEscape(const Model& implant) {
  for (const Primitive& primitive : implant.primitives) {
    const verify::PosedSuperquadric posed(primitive);
    solids_.push_back({verify::ApproximateMotion<double>::of_own_frame(primitive),
                       verify::SuperquadricSet<double>(primitive.superquadric),
                       verify::NearestNormal(primitive.superquadric),
                       posed.radius().upper().to_double(verify::Direction::up)});
  }
}

std::vector<Point> PrismEscape::ways_out(const WayPrism& prism) const {
  std::vector<WayOut> ways;
  for (const Point& x : samples_of(verify::moved(prism, {}))) {
    WayOut deepest{{}, 0.0};
    for (const Solid& solid : solids_) {
      const Point own = solid.motion.inverse_point(x);
      if (!(std::sqrt(verify::dot(own, own)) < solid.radius)) continue;
      const auto [normal, distance] = solid.nearest(own);
      if (distance < -deepest.depth) deepest = {solid.motion.direction(normal), -distance};
    }
    if (deepest.depth > 0.0) ways.push_back(deepest);
  }
  std::ranges::sort(ways, std::ranges::greater{}, &WayOut::depth);
  std::vector<Point> directions;
  for (const WayOut& way : ways) {
    const auto is_same = [&](const Point& other) { return verify::dot(other, way.direction) > same_direction; };
    if (std::ranges::any_of(directions, is_same)) continue;
    directions.push_back(way.direction);
    if (directions.size() == most_ways_out) break;
  }
  return directions;
}

std::optional<MovedCell> PrismEscape::moved(const WayPrism& prism, const Point& step, bool closely) const {
  const MovedPrism hull = verify::moved(prism, step);
  MovedCell cell{step, {}};
  for (std::uint32_t k = 0; k < solids_.size(); ++k) {
    const Solid& solid = solids_[k];
    const PrismSet set = set_of(hull, solid.motion);
    Point middle{};
    for (const Point& corner : set.corners) middle = verify::along(middle, corner, 1.0 / 6.0);
    const auto gap = [&](const Point& v) {
      return verify::dot(v, set({-v[0], -v[1], -v[2]})) - verify::dot(v, solid.set(v));
    };
    if (!closely && gap(middle) > 0.0) continue;  // the checker tries that for itself
    const auto found = verify::gjk<double>(solid.set, set, middle, closely ? apart_closely : apart_at_all);
    if (!(found.lower > 0.0)) return std::nullopt;
    const Point shortened = short_normal(found.separation);
    cell.normals.push_back({k, gap(shortened) > 0.0 ? shortened : found.separation});
  }
  return cell;
}

}  // namespace verisq
