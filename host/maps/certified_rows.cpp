/// Rows that the host proves: this file implements certified_rows.hpp, and the closest points of distance.hpp.
#include "host/maps/certified_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>
#include <verisq/error.hpp>

#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/distance.hpp"

namespace verisq {

namespace {

/// Work before a time limit begins must not take long, and each cube of a large model evaluates many leaves. Of `most`
/// cubes or searches, returns so many that they take no longer than all of them in a model of 64 leaves; at least one.
std::size_t affordable(std::size_t most, const Model& model) {
  constexpr std::size_t size = 64;
  return std::max<std::size_t>(1, most * size / std::max(verify::size_of_tree(model), size));
}

constexpr std::size_t most_cubes_of_rough_search = 256;

Enclosure rough_distance(const Model& model, const SignedDistance& distance, const Point& point, double tolerance,
                         const std::function<bool()>& interrupted) {
  std::size_t polled = 0;
  const std::size_t cubes = affordable(most_cubes_of_rough_search, model);
  return distance(point, tolerance, [&] { return ++polled > cubes || interrupted(); });
}

// A lower end beyond all numbers proves that the model is empty.
bool is_proven_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted) {
  if (is_union_of_convex(model)) return false;
  const Point& centre = model.primitives.front().pose.translation;
  const Enclosure found = rough_distance(model, distance, centre, bounding_radius(model), interrupted);
  return found.lo == std::numeric_limits<double>::max();
}

constexpr std::size_t most_known_centres = 16;

}  // namespace

void refuse_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted) {
  if (is_proven_empty(model, distance, interrupted))
    refuse("the model has no point at all: its set operations leave nothing");
}

void refuse_empty_members(const Bracket& models, const std::function<bool()>& interrupted) {
  const auto is_empty = [&](const Model& model) { return is_proven_empty(model, SignedDistance(model), interrupted); };
  if (verify::same_solids(models) || !is_empty(models.smallest)) return;
  if (is_empty(models.largest))
    refuse("no model that the intervals allow has a point: the set operations leave nothing");
  refuse(
      "the model's intervals are too wide: with what is kept at its smallest and what is removed at its largest the "
      "set "
      "operations leave no point, so that no distance is known to hold for all models that they allow; narrow them");
}

verify::CoarseDistance coarse_distance(const Model& model, const SignedDistance& distance,
                                       const std::function<bool()>& interrupted) {
  const double rough = 0x1p-6 * bounding_radius(model);
  std::vector<verify::KnownDistance> known;
  const std::size_t size = model.primitives.size();
  const std::size_t count = std::min(size, affordable(most_known_centres, model));
  for (std::size_t i = 0; i < count; ++i) {
    const Point& centre = model.primitives[i * size / count].pose.translation;
    known.push_back({centre, rough_distance(model, distance, centre, rough, interrupted)});
  }
  return {model, known};
}

namespace {

void refuse_if_not_finite(const Point& x, std::size_t index) {
  if (std::ranges::all_of(x, [](double c) { return std::isfinite(c); })) return;
  throw Error(ErrorKind::input, fmt::format("point {}: ({}, {}, {}) is not finite", index, x[0], x[1], x[2]));
}

double widest_interval(const EnclosedPoint& box) {
  return std::max({box[0].width(), box[1].width(), box[2].width()});
}

}  // namespace

ClosestPointSummary summary_of(std::span<const ClosestPoint> rows) {
  ClosestPointSummary summary{.points = rows.size()};
  for (const ClosestPoint& row : rows) {
    if (!row.unique) continue;
    ++summary.unique;
    summary.widest_point = std::max(summary.widest_point, widest_interval(row.point));
    summary.widest_normal = std::max(summary.widest_normal, widest_interval(row.normal));
  }
  return summary;
}

ClosestPointSummary summary_of(std::span<const ClosestPoints> rows) {
  ClosestPointSummary summary{.points = rows.size()};
  for (const ClosestPoints& row : rows) {
    if (!row.unique) continue;
    ++summary.unique;
    summary.widest_point = std::max({summary.widest_point, widest_interval(row.on_a), widest_interval(row.on_b)});
  }
  return summary;
}

ClosestPointSummary joined(const ClosestPointSummary& a, const ClosestPointSummary& b) {
  return {.points = a.points + b.points,
          .unique = a.unique + b.unique,
          .widest_point = std::max(a.widest_point, b.widest_point),
          .widest_normal = std::max(a.widest_normal, b.widest_normal),
          .interrupted = a.interrupted || b.interrupted};
}

ClosestPointSummary closest_points(const SignedDistance& distance, const PointColumns& points,
                                   std::span<ClosestPoint> rows, const ClosestPointOptions& options) {
  if (rows.size() != points.size()) {
    throw Error(ErrorKind::input,
                fmt::format("{} rows for the closest points of {} points", rows.size(), points.size()));
  }
  if (!options.known.empty() && options.known.size() != points.size()) {
    throw Error(ErrorKind::input, fmt::format("{} known distances of {} points", options.known.size(), points.size()));
  }
  const SeenInterruption seen(options.interrupted);
  const std::function<bool()> interrupted = [&seen] { return seen(); };
  static_cast<void>(interrupted());  // before other threads, which only see what this one was told, begin
  const std::size_t done = in_parallel_until(seen, points.size(), [&](std::size_t k) {
    const Point x = points[k];
    refuse_if_not_finite(x, k);
    rows[k] = options.known.empty() ? distance.closest_point(x, options.tolerance, interrupted)
                                    : distance.closest_point(x, options.known[k]);
  });
  for (std::size_t k = done; k < points.size(); ++k) {
    constexpr Enclosure anything{-infinity, infinity};
    rows[k] = closest_point_within(options.known.empty() ? anything : options.known[k], points[k]);
  }
  ClosestPointSummary summary = summary_of(rows.first(done));
  summary.interrupted = done < points.size();
  return summary;
}

}  // namespace verisq
