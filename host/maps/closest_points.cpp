/// Closest points of points, chunk by chunk, each shared by the processors.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <verisq/error.hpp>

#include "host/threads/parallel.hpp"
#include "verisq/distance.hpp"

namespace verisq {
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
