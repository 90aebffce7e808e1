/// Maps of uncertain models, by their bracketing models, and of uncertain poses.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/maps/certified_rows.hpp"
#include "host/maps/map_run.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/search/displaced_point.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"
#include "verisq/hidden.hpp"
#include "verisq/map.hpp"
#include "verisq/model.hpp"

namespace verisq {

// Distances of points to convex solids of uncertain pose: their ends follow from convexity (docs/mathematics.md §27).

class ConvexPoseRows {
 public:
  /// `options` are those of the maps of each solid at the nominal pose. Throws like the constructors of Mapper.
  /// Precondition: is_union_of_convex.
  ConvexPoseRows(const Model& model, const PoseUncertainty& bounds, const MapOptions& options);
  ~ConvexPoseRows();
  ConvexPoseRows(ConvexPoseRows&&) noexcept;
  ConvexPoseRows& operator=(ConvexPoseRows&&) noexcept;

  /// Bounds of each point's distances at every pose; an end is infinite if nothing is proven. None if interrupted.
  [[nodiscard]] std::vector<Enclosure> operator()(std::span<const Point> points);

 private:
  struct Solid;

  PoseUncertainty bounds_;
  std::vector<Solid> solids_;
};

// Distances of points to a model of uncertain pose, by dividing where the model may see each point
// (docs/mathematics.md §27).

/// Fills the rows of as many points, with the model at its nominal pose; false: interrupted.
using NominalRows = std::function<bool(std::span<const Point>, std::span<MapResult>)>;

/// For each point an enclosure of its distances at every pose, with a status that states whether a device has proven
/// all of its parts (otherwise host_verified). Cubes that may contain the smallest or the largest distance are halved,
/// until their edges are 1/divisions of the first's. A cube's distances are those of its centre, more or less half its
/// diagonal. None if interrupted; `enough`, polled between halvings, ends them early. Precondition: divisions >= 1.
[[nodiscard]] std::vector<MapResult> subdivided(const PoseUncertainty& bounds, unsigned divisions,
                                                std::span<const Point> points, const NominalRows& rows,
                                                const std::function<bool()>& enough);

// Maps of uncertain models: the maps of their bracketing models, chunk by chunk, with combined rows.

/// A map for each bracketing model, or for each pair of them.
template <class Query>
using BracketedMap = verify::Bracketed<std::unique_ptr<ExactMap<Query>>>;

/// The rows of one chunk by one map: fewer than its queries if the map was interrupted.
struct MapRows {
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;
  MapSummary summary;
};

/// The rows of the bracketing models' maps for one chunk.
using BracketRows = verify::Bracketed<MapRows>;

[[nodiscard]] inline std::vector<const MapRows*> each(const BracketRows& rows) {
  std::vector<const MapRows*> all{&rows.smallest};
  for (const auto* const other : {&rows.largest, &rows.inflated})
    if (*other) all.push_back(&**other);
  return all;
}

template <class Query>
[[nodiscard]] MapRows map_chunk(ExactMap<Query>& map, std::span<const Query> queries) {
  MapRows rows;
  const auto source = [&](std::span<Query> chunk) {
    const std::size_t count = std::min(chunk.size(), queries.size());
    std::ranges::copy(queries.first(count), chunk.begin());
    queries = queries.subspan(count);
    return count;
  };
  const auto sink = [&](std::span<const Query>, std::span<const MapResult> results,
                        std::span<const Certificate> certificates) {
    rows.results.insert(rows.results.end(), results.begin(), results.end());
    rows.certificates.insert(rows.certificates.end(), certificates.begin(), certificates.end());
  };
  rows.summary = map.map(source, sink);
  return rows;
}

[[nodiscard]] inline Enclosure combined(const verify::MemberBounds& bounds, const BracketRows& rows, std::size_t i,
                                        const Point& point) {
  std::optional<double> of_inflated;
  if (rows.inflated) of_inflated = rows.inflated->results[i].distance.lo;
  return verify::between(bounds.signed_lower(rows.of_largest().results[i].distance.lo, of_inflated),
                         bounds.upper(rows.smallest.results[i].distance.hi),
                         [&] { return "the signed distance at " + verify::text_of(point); });
}

[[nodiscard]] inline std::string described(const Triangle& triangle) {
  return "the distance of the triangle from " + verify::text_of(triangle[0]);
}

[[nodiscard]] inline std::string described(const Pose& pose) {
  return "the distance at the pose of translation " + verify::text_of(pose.translation);
}

/// Combines distances that are never below 0.
template <class Query>
[[nodiscard]] Enclosure combined(const verify::MemberBounds& bounds, const BracketRows& rows, std::size_t i,
                                 const Query& query) {
  return verify::between(bounds.unsigned_lower(rows.of_largest().results[i].distance.lo),
                         bounds.upper(rows.smallest.results[i].distance.hi), [&] { return described(query); });
}

[[nodiscard]] inline Status combined_status(const Enclosure& distance, double tolerance,
                                            std::span<const MapRows* const> rows, std::size_t i) {
  // For uncertain numbers the tightest enclosure is given by the tightest enclosures of both ends.
  const auto is_wide = [i](const MapRows* of) { return of->results[i].status == Status::wide; };
  const bool tightest = tolerance == 0.0 && std::ranges::none_of(rows, is_wide);
  if (!verified(distance, tolerance) && !tightest) return Status::wide;
  const auto by_device = [i](const MapRows* of) { return of->results[i].status == Status::device_verified; };
  return std::ranges::all_of(rows, by_device) ? Status::device_verified : Status::host_verified;
}

/// The upper end's normals first, as certificates require; each later normal proves what it can. An escape is that of
/// `inflated` if there is one: a point outside of it lies outside every member.
[[nodiscard]] inline Certificate merged(const BracketRows& rows, std::size_t i) {
  Certificate merged = rows.smallest.certificates[i];
  const auto add = [&](const Certificate& lower) {
    for (const Normal& normal : lower.normals)
      if (std::ranges::find(merged.normals, normal) == merged.normals.end()) merged.normals.push_back(normal);
    merged.escape = lower.escape;
  };
  add(rows.of_largest().certificates[i]);
  if (rows.inflated) add(rows.inflated->certificates[i]);
  return merged;
}

template <class Query>
class BracketMap {
 public:
  /// `options` are those of the combined rows. For a single member, `maps` is its map, made by the same options.
  BracketMap(const verify::MemberBounds& bounds, const MapOptions& options, BracketedMap<Query> maps)
      : bounds_(bounds), options_(options), maps_(std::move(maps)) {}

  /// Like Mapper::map.
  MapSummary map(const Source<Query>& source, const Sink<Query>& sink) {
    if (bounds_.exact()) return maps_.smallest->map(source, sink);
    MapSummary summary = empty_summary();
    std::vector<Query> queries;
    ChunkPace pace = options_.out_of_time ? ChunkPace() : ChunkPace::of_blocks(rows_per_block, most_at_once);
    do {
      queries.resize(pace.size());
      queries.resize(source(queries));
      const auto start = std::chrono::steady_clock::now();
      const BracketRows rows = map_bracket(queries);
      pace.took(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      add_runs(summary, rows);
      deliver(queries, rows, summary, sink);
    } while (!queries.empty() && !summary.interrupted);
    return summary;
  }

  MapSummary map_in_memory(const typename QueriesInMemory<Query>::type& queries, const ResultColumns& rows) {
    if (bounds_.exact()) return maps_.smallest->map_in_memory(queries, rows);
    return map_copies<Query>(queries, rows, [this](const auto& source, const auto& sink) { return map(source, sink); });
  }

  [[nodiscard]] const MapOptions& options() const { return options_; }

 private:
  [[nodiscard]] BracketRows map_bracket(std::span<const Query> queries) {
    BracketRows rows{map_chunk(*maps_.smallest, queries), std::nullopt, std::nullopt};
    if (maps_.largest) rows.largest = map_chunk(**maps_.largest, queries);
    if (maps_.inflated) rows.inflated = map_chunk(**maps_.inflated, queries);
    return rows;
  }

  static void add_runs(MapSummary& summary, const BracketRows& rows) {
    summary.device = rows.smallest.summary.device;
    summary.notice = rows.smallest.summary.notice;
    for (const MapRows* of : each(rows)) {
      summary.device_seconds += of->summary.device_seconds;
      summary.host_seconds += of->summary.host_seconds;
      summary.interrupted = summary.interrupted || of->summary.interrupted;
      summary.out_of_time = summary.out_of_time || of->summary.out_of_time;
    }
  }

  void deliver(std::span<const Query> queries, const BracketRows& rows, MapSummary& summary,
               const Sink<Query>& sink) const {
    const std::vector<const MapRows*> all = each(rows);
    std::size_t finished = queries.size();
    for (const MapRows* of : all) finished = std::min(finished, of->results.size());
    if (finished == 0) return;
    std::vector<MapResult> results(finished);
    std::vector<Certificate> certificates(options_.certificates ? finished : 0);
    for (std::size_t i = 0; i < finished; ++i) {
      const Enclosure distance = combined(bounds_, rows, i, queries[i]);
      results[i] = {distance, combined_status(distance, options_.tolerance, all, i)};
      if (options_.certificates) certificates[i] = merged(rows, i);
      count(summary, results[i]);
    }
    sink(queries.first(finished), results, certificates);
  }

  static constexpr std::size_t most_at_once = std::size_t{1} << 16U;

  verify::MemberBounds bounds_;
  MapOptions options_;
  BracketedMap<Query> maps_;
};

// Maps of models at uncertain poses: rows at the nominal pose, widened by the largest change that the motions may
// cause.

/// The largest change of a query's distance by the motions. `reach` is that of the model (for poses).
[[nodiscard]] inline double change_of(const PoseUncertainty& bounds, const Point& point, double /*reach*/) {
  return verify::DisplacedPoint(bounds, point).reach();
}
/// The motions are affine: no point of a triangle is moved farther than a corner.
[[nodiscard]] inline double change_of(const PoseUncertainty& bounds, const Triangle& triangle, double /*reach*/) {
  double reach = 0.0;
  for (const Point& corner : triangle) reach = std::max(reach, verify::DisplacedPoint(bounds, corner).reach());
  return reach;
}
[[nodiscard]] inline double change_of(const PoseUncertainty& /*bounds*/, const Pose& /*pose*/, double reach) {
  return reach;
}

template <class Query>
class UncertainPoseMap {
 public:
  /// `options` are those of the widened rows; `map` makes the rows at the nominal pose; `reach` is the largest distance
  /// that the motions move the model. `convex` is given for points about an exact union of convex primitives.
  UncertainPoseMap(const MapOptions& options, double reach, BracketMap<Query> map,
                   std::optional<ConvexPoseRows> convex = {})
      : options_(options), reach_(reach), map_(std::move(map)), convex_(std::move(convex)) {}

  /// Like Mapper::map.
  MapSummary map(const Source<Query>& source, const Sink<Query>& sink) {
    if (!options_.pose_uncertainty) return map_.map(source, sink);
    MapSummary summary = empty_summary();
    std::vector<Query> queries;
    const bool of_blocks = !options_.out_of_time && options_.pose_divisions == 1;
    ChunkPace pace = of_blocks ? ChunkPace::of_blocks(rows_per_block, most_at_once) : ChunkPace();
    do {
      queries.resize(pace.size());
      queries.resize(source(queries));
      const auto start = std::chrono::steady_clock::now();
      const std::vector<MapResult> rows = map_chunk(queries, summary);
      pace.took(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      for (const MapResult& row : rows) count(summary, row);
      if (!rows.empty()) sink(std::span(queries).first(rows.size()), rows, {});
    } while (!queries.empty() && !summary.interrupted);
    return summary;
  }

  MapSummary map_in_memory(const typename QueriesInMemory<Query>::type& queries, const ResultColumns& rows) {
    if (!options_.pose_uncertainty) return map_.map_in_memory(queries, rows);
    return map_copies<Query>(queries, rows, [this](const auto& source, const auto& sink) { return map(source, sink); });
  }

  [[nodiscard]] const MapOptions& options() const { return options_; }

 private:
  /// None, or fewer rows than queries, if interrupted.
  [[nodiscard]] std::vector<MapResult> map_chunk(std::span<const Query> queries, MapSummary& summary) {
    std::vector<MapResult> rows = changed_rows(queries, summary);
    if constexpr (std::same_as<Query, Point>) narrow(rows, queries, summary);
    for (MapResult& row : rows) {
      if (!verified(row.distance, options_.tolerance)) row.status = Status::wide;
    }
    return rows;
  }

  [[nodiscard]] std::vector<MapResult> changed_rows(std::span<const Query> queries, MapSummary& summary) {
    if constexpr (std::same_as<Query, Point>) {
      if (options_.pose_divisions > 1) {
        const auto rows = [&](std::span<const Point> points, std::span<MapResult> results) {
          return nominal_rows(points, results, summary) == points.size();
        };
        const auto enough = [this] { return options_.out_of_time && options_.out_of_time(); };
        return subdivided(*options_.pose_uncertainty, options_.pose_divisions, queries, rows, enough);
      }
    }
    std::vector<MapResult> rows(queries.size());
    rows.resize(nominal_rows(queries, rows, summary));
    for (std::size_t i = 0; i < rows.size(); ++i) widen(rows[i], queries[i]);
    return rows;
  }

  /// Narrows the rows to the enclosures that convexity proves, too.
  void narrow(std::vector<MapResult>& rows, std::span<const Point> queries,
              MapSummary& summary) requires(std::same_as<Query, Point>) {
    if (!convex_ || rows.size() != queries.size() || (options_.out_of_time && options_.out_of_time())) return;
    const std::vector<Enclosure> proven = (*convex_)(queries);
    if (proven.size() != rows.size()) {
      summary.interrupted = true;
      rows.clear();
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Enclosure& distance = rows[i].distance;
      const Enclosure widened = distance;
      using verify::Interval;
      const Interval radius(options_.point_radius);
      distance.lo = std::max(widened.lo, (Interval(proven[i].lo) - radius).lower());
      distance.hi = std::min(widened.hi, (Interval(proven[i].hi) + radius).upper());
      if (distance != widened) rows[i].status = Status::host_verified;
    }
  }

  void widen(MapResult& row, const Query& query) const {
    using verify::Interval;
    const Interval change(change_of(*options_.pose_uncertainty, query, reach_));
    row.distance.hi = (Interval(row.distance.hi) + change).upper();
    row.distance.lo = (Interval(row.distance.lo) - change).lower();
    if constexpr (!std::same_as<Query, Point>) row.distance.lo = std::max(0.0, row.distance.lo);
    // Rows that are wide at the nominal pose are the host's, too.
    if (row.status == Status::wide) row.status = Status::host_verified;
  }

  /// The number of filled rows; the run's statistics are added to the summary.
  [[nodiscard]] std::size_t nominal_rows(std::span<const Query> queries, std::span<MapResult> rows,
                                         MapSummary& summary) {
    const MapSummary run = map_.map_in_memory(queries, rows);
    summary.device = run.device;
    summary.notice = run.notice;
    summary.device_seconds += run.device_seconds;
    summary.host_seconds += run.host_seconds;
    summary.interrupted = summary.interrupted || run.interrupted;
    summary.out_of_time = summary.out_of_time || run.out_of_time;
    return run.points;
  }

  static constexpr std::size_t most_at_once = std::size_t{1} << 16U;

  MapOptions options_;
  double reach_;
  BracketMap<Query> map_;
  std::optional<ConvexPoseRows> convex_;
};

// Maps as their users make them.

/// Of the bracketing models' maps: each end to half the tolerance.
[[nodiscard]] inline MapOptions of_one_end(const verify::MemberBounds& bounds, MapOptions options) {
  if (bounds.exact()) return options;
  options.tolerance = options.tolerance / 2;
  options.covers = false;  // of several primitives together
  return options;
}

/// An infinite tolerance takes any enclosure.
inline void check_lengths(const MapOptions& options) {
  const auto require = [](bool holds, const char* name, double value, const char* what) {
    if (!holds) throw Error(ErrorKind::input, fmt::format("map: {} = {}: must be {}", name, value, what));
  };
  require(options.tolerance >= 0.0, "tolerance", options.tolerance, "at least 0");
  require(options.point_radius >= 0.0 && std::isfinite(options.point_radius), "point_radius", options.point_radius,
          "finite and at least 0");
}

inline void check_uncertain_pose(const MapOptions& options, bool divisible) {
  check_lengths(options);
  if (!options.pose_uncertainty) return;
  const auto refuse = [](const char* what) { throw Error(ErrorKind::input, fmt::format("uncertain poses: {}", what)); };
  if (options.certificates) refuse("there are no certificates");
  if (options.tolerance == 0.0) refuse("rows are never narrower than distances differ: the tolerance must be above 0");
  if (options.pose_divisions == 0) refuse("the divisions must be at least 1");
  if (options.pose_divisions > 1 && !divisible) refuse("places are divided for points alone");
}

/// At the nominal pose: distances to a small part of what the motions, which take the model as far as `reach`, leave.
[[nodiscard]] inline MapOptions at_nominal_pose(MapOptions options, double reach) {
  constexpr double parts = 32.0;
  if (options.pose_uncertainty)
    options.tolerance = std::max(options.tolerance, reach) / (parts * options.pose_divisions);
  return options;
}

[[nodiscard]] inline double reach_of(const MapOptions& options, const Model& model) {
  return options.pose_uncertainty ? verify::reach_of(*options.pose_uncertainty, model) : 0.0;
}

/// Of a model that lies between those of the bracket (map.cpp), and of two such (pose_map.cpp).
template <class Query>
[[nodiscard]] UncertainPoseMap<Query> map_of(const Bracket& models, const MapOptions& options);
[[nodiscard]] UncertainPoseMap<Pose> map_of(const Bracket& a, const Bracket& b, const MapOptions& options);

/// Throws Error(input) where a value of a row may share memory with a coordinate or with another value of a row: rows
/// are written while coordinates are read. Columns that interleave, like those of one record, lie apart where their
/// strides are the same. Precondition: as many rows as points.
void require_apart(const PointColumns& points, const ResultColumns& rows);

template <class Query>
struct Mapper<Query>::State {
  /// Threads that prove rows see what the caller's thread is told.
  template <class... Models>
  State(const MapOptions& options, const Models&... models)
      : interrupted(std::make_shared<SeenInterruption>(options.interrupted)), map(made(options, models...)) {}

  std::shared_ptr<SeenInterruption> interrupted;
  UncertainPoseMap<Query> map;

 private:
  template <class... Models>
  [[nodiscard]] UncertainPoseMap<Query> made(MapOptions options, const Models&... models) const {
    options.interrupted = [seen = interrupted] { return (*seen)(); };
    if constexpr (sizeof...(Models) == 2) {
      return map_of(models..., options);
    } else {
      return map_of<Query>(models..., options);
    }
  }
};

// clang 14 instantiates constructors whose constraints do not hold, too.
template <class Query>
Mapper<Query>::Mapper(const UncertainModel& model, const MapOptions& options) requires(!std::same_as<Query, Pose>) {
  if constexpr (!std::same_as<Query, Pose>) state_ = hidden<State>(options, bracket(model));
}

template <class Query>
Mapper<Query>::Mapper(const UncertainModel& a, const UncertainModel& b,
                      const MapOptions& options) requires std::same_as<Query, Pose> {
  if constexpr (std::same_as<Query, Pose>) state_ = hidden<State>(options, bracket(a), bracket(b));
}

template <class Query>
MapSummary Mapper<Query>::map(const Source<Query>& source, const Sink<Query>& sink) {
  state_->interrupted->begin_anew();
  return state_->map.map(source, sink);
}

template <class Query>
MapSummary Mapper<Query>::map(const Queries& queries, const ResultColumns& rows) {
  if (rows.size() != queries.size())
    throw Error(ErrorKind::input,
                fmt::format("there is memory for {} rows, not for those of {} queries", rows.size(), queries.size()));
  if (state_->map.options().certificates)
    throw Error(ErrorKind::input, "certificates need a sink: columns of rows have no place for them");
  if constexpr (std::same_as<Query, Point>) require_apart(queries, rows);
  state_->interrupted->begin_anew();
  return state_->map.map_in_memory(queries, rows);
}

}  // namespace verisq
