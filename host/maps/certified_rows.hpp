/// Rows of a map: the intersection of two, how tight they get, and lower bounds of their distances from a model.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/search/octree_cube.hpp"
#include "verisq/checker.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq {

// Rows of a map: how tight they get, the intersection of two, and their contribution to the summary.

// The tightest widths of the methods: a tolerance of 0 requests them, and calls them verified.

// Outside, the device's certificates are as tight as certificates get; inside, its branch and bound is as tight as
// searches get.
inline constexpr double tightest_outside = 1e-12;  // of max(largest |coordinate|, radius of the model)
inline constexpr double tightest_inside = 2e-9;    // of the radius of the model
// For a tapered solid the kernels search once for the closest point. If that search fails, as for a few of 1000 points,
// the host is tighter.
inline constexpr double tightest_outside_of_tapered = 1e-14;

/// The width of the tightest enclosures of a signed distance like `found`. Only a point proven to be inside may be as
/// wide as points inside. For a point within rounding of the surface, certificates enclose the distance as outside.
template <class Query>
[[nodiscard]] double tightest_width(const Query& query, const Enclosure& found, double radius,
                                    double outside = tightest_outside) {
  if (found.hi < 0.0) return tightest_inside * radius;
  return outside * std::max(verify::largest_coordinate(query), radius);
}

// The intersection of two certified enclosures of one value.

/// The intersection with its certificate: the certificate of the upper end first, as certificates require, then that of
/// the lower end. All of `b` if that has a cover, which belongs to the points that it was made with. `what` names the
/// value, as verify::intersection requires.
template <class What>
[[nodiscard]] CertifiedEnclosure certified_intersection(const CertifiedEnclosure& a, const CertifiedEnclosure& b,
                                                        const What& what) {
  const Enclosure both = verify::intersection(a.distance, b.distance, what);
  if (!b.certificate.cover.empty()) return b;
  const CertifiedEnclosure& upper = b.distance.hi < a.distance.hi ? b : a;
  const CertifiedEnclosure& lower = b.distance.lo > a.distance.lo ? b : a;
  Certificate certificate{upper.certificate.normals, lower.certificate.escape, upper.certificate.weights,
                          upper.certificate.witness};
  if (&lower != &upper) {
    certificate.normals.insert(certificate.normals.end(), lower.certificate.normals.begin(),
                               lower.certificate.normals.end());
  }
  return {both, std::move(certificate)};
}

// The accounting of a map: the contribution of one more row to its summary.

/// The summary of no rows: its smallest distance is infinite.
[[nodiscard]] inline MapSummary empty_summary() {
  MapSummary summary;
  summary.minimum_lo = summary.minimum_hi = infinity;
  return summary;
}

/// Adds rows with these extremes to the summary.
inline void extend(MapSummary& summary, double minimum_lo, double minimum_hi, double largest_width) {
  summary.minimum_lo = std::min(summary.minimum_lo, minimum_lo);
  summary.minimum_hi = std::min(summary.minimum_hi, minimum_hi);
  summary.largest_width = std::max(summary.largest_width, largest_width);
}

inline void count(MapSummary& summary, const MapResult& row) {
  ++summary.points;
  switch (row.status) {
    case Status::device_verified: ++summary.device_verified; break;
    case Status::host_verified: ++summary.host_verified; break;
    case Status::wide:
      ++summary.wide;
      if (row.distance.lo < 0.0) ++summary.wide_inside;
      break;
  }
  extend(summary, row.distance.lo, row.distance.hi, row.distance.width());
}

/// Adds the counts of another summary.
inline void add(MapSummary& summary, const MapSummary& other) {
  summary.points += other.points;
  summary.device_verified += other.device_verified;
  summary.host_verified += other.host_verified;
  summary.wide += other.wide;
  summary.wide_inside += other.wide_inside;
  extend(summary, other.minimum_lo, other.minimum_hi, other.largest_width);
}

/// Adds all of these rows, without a write to the summary for each.
inline void count(MapSummary& summary, std::span<const MapResult> rows) {
  MapSummary of_rows = empty_summary();
  for (const MapResult& row : rows) count(of_rows, row);
  add(summary, of_rows);
}

/// The summary of rows that replaced those of `earlier`; `earlier` states how they were found.
[[nodiscard]] inline MapSummary recounted(const MapSummary& earlier, std::span<const MapResult> rows) {
  MapSummary summary = empty_summary();
  count(summary, rows);
  summary.device = earlier.device;
  summary.notice = earlier.notice;
  summary.device_seconds = earlier.device_seconds;
  summary.host_seconds = earlier.host_seconds;
  return summary;
}

// Rough distances without a search: a map computes them before it begins, and uses them when the time is up.

// Preparations of a map for a model: the model must have a point, and rough distances are kept for when the time is up.

/// Throws Error(input) if a rough search proves that the model has no point at all.
void refuse_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted);

/// Throws Error(input) if it proves that the smallest of the models that bracket an uncertain one has no point. Then no
/// upper end is valid for all members, some of which may have no point. Exact models are left to the function above.
void refuse_empty_members(const Bracket& models, const std::function<bool()>& interrupted);

/// Knows rough distances of the primitives' centres; of many primitives, of some spread over their order.
[[nodiscard]] verify::CoarseDistance coarse_distance(const Model& model, const SignedDistance& distance,
                                                     const std::function<bool()>& interrupted);

// Quick enclosures for the rows that a time limit leaves: no search, no wait.

/// The first rows after the limit get all bounds that need no search, a good tenth of a second in all. There may be a
/// million others: points get the bounds by bounding spheres, triangles the trivial bounds. Safe to use from many
/// threads.
class LateRows {
 public:
  /// The number of rows that get all bounds.
  static constexpr std::size_t first_rows = 512;

  explicit LateRows(const Model& model) : proof_(model) {}

  /// A row in time: a limit that was reached is past.
  void begin_anew() {
    if (late_.load(std::memory_order_relaxed) != 0) late_.store(0, std::memory_order_relaxed);
  }

  [[nodiscard]] CertifiedEnclosure next(const Point& x) { return is_early() ? proof_(x) : proof_.by_spheres(x); }
  [[nodiscard]] CertifiedEnclosure next(const Triangle& triangle) {
    return is_early() ? proof_(triangle) : CertifiedEnclosure{{0.0, infinity}, {}};
  }

 private:
  [[nodiscard]] bool is_early() { return late_.fetch_add(1, std::memory_order_relaxed) < first_rows; }

  verify::CoarseProof proof_;
  std::atomic<std::size_t> late_{0};
};

}  // namespace verisq
