/// Rows of a map: what two say together, how tight they get, and how far from a model they are at least.
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

// Rows of a map: how tight they get, what two say together, and what they add to the summary.

// How tight the methods get: what a tolerance of 0 asks for, and calls verified.

// Outside, the device's certificates are as good as certificates get; inside, its branch and bound is.
inline constexpr double tightest_outside = 1e-12;  // of max(largest |coordinate|, radius of the model)
inline constexpr double tightest_inside = 2e-9;    // of the radius of the model
// Of a tapered solid the kernels search once for the closest point: where that goes astray, for a few of 1000, the host
// is tighter.
inline constexpr double tightest_outside_of_tapered = 1e-14;

/// The width of the tightest enclosures of a signed distance like `found`. Only a point proven to be inside may be as
/// wide as those inside are: of one within rounding of the surface, certificates enclose the distance as outside.
template <class Query>
[[nodiscard]] double tightest_width(const Query& query, const Enclosure& found, double radius,
                                    double outside = tightest_outside) {
  if (found.hi < 0.0) return tightest_inside * radius;
  return outside * std::max(verify::largest_coordinate(query), radius);
}

// What two certified enclosures of one value say together.

/// With what proves it: upper end first, as certificates want it, then what proves the lower end. All of `b` where that
/// has a cover, which goes with the points that it was made with. `what` names the value, as verify::intersection wants
/// it.
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

// The books of a map: what one more row adds to its summary.

/// Of no rows: the smallest distance of none is infinite.
[[nodiscard]] inline MapSummary empty_summary() {
  MapSummary summary;
  summary.minimum_lo = summary.minimum_hi = infinity;
  return summary;
}

/// What rows with these extremes add to those of the summary.
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

/// Likewise what another summary counts.
inline void add(MapSummary& summary, const MapSummary& other) {
  summary.points += other.points;
  summary.device_verified += other.device_verified;
  summary.host_verified += other.host_verified;
  summary.wide += other.wide;
  summary.wide_inside += other.wide_inside;
  extend(summary, other.minimum_lo, other.minimum_hi, other.largest_width);
}

/// Likewise all of these, without a write to the summary for each.
inline void count(MapSummary& summary, std::span<const MapResult> rows) {
  MapSummary of_rows = empty_summary();
  for (const MapResult& row : rows) count(of_rows, row);
  add(summary, of_rows);
}

/// What rows say together that took the place of those of `earlier`, which tells how they were found.
[[nodiscard]] inline MapSummary recounted(const MapSummary& earlier, std::span<const MapResult> rows) {
  MapSummary summary = empty_summary();
  count(summary, rows);
  summary.device = earlier.device;
  summary.notice = earlier.notice;
  summary.device_seconds = earlier.device_seconds;
  summary.host_seconds = earlier.host_seconds;
  return summary;
}

// Rough distances without a search: what a map knows before it begins, and says when the time is up.

// What a map asks of a model before it begins: whether it has a point, and rough distances for when the time is up.

/// Throws Error(input) where a rough search proves that the model has no point at all.
void refuse_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted);

/// Throws Error(input) where it proves that of the smallest of the models that bracket an uncertain one: no upper end
/// holds for all members then, of which some may have no point. Exact models are left to the above.
void refuse_empty_members(const Bracket& models, const std::function<bool()>& interrupted);

/// Knows rough distances of the primitives' centres, of many spread over their order.
[[nodiscard]] verify::CoarseDistance coarse_distance(const Model& model, const SignedDistance& distance,
                                                     const std::function<bool()>& interrupted);

// Quick enclosures for the rows that a time limit leaves: no search, no wait.

/// The first rows after the limit get all that takes no search, a good tenth of a second in all; of the others there
/// may be a million: points get what bounding spheres prove, triangles what holds of any. Safe to use from many
/// threads.
class LateRows {
 public:
  /// So many get all.
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
