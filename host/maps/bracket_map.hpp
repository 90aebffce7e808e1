/// Maps of uncertain models: those of the models that bracket them, chunk by chunk, their rows combined.
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/maps/chunk_pace.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/map_copies.hpp"
#include "host/maps/summary_count.hpp"
#include "verify/proof/bracketed.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/uncertain_distance.hpp"

namespace verisq {

/// Of each model, or of each pair of models, that brackets.
template <class Query>
using BracketedMap = verify::Bracketed<std::unique_ptr<ExactMap<Query>>>;

/// The rows of one chunk by one map: fewer than its queries if the map was interrupted.
struct MapRows {
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;
  MapSummary summary;
};

/// What the maps of the bracketing models say of one chunk.
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

/// Of distances that are never below 0.
template <class Query>
[[nodiscard]] Enclosure combined(const verify::MemberBounds& bounds, const BracketRows& rows, std::size_t i,
                                 const Query& query) {
  return verify::between(bounds.unsigned_lower(rows.of_largest().results[i].distance.lo),
                         bounds.upper(rows.smallest.results[i].distance.hi), [&] { return described(query); });
}

[[nodiscard]] inline Status combined_status(const Enclosure& distance, double tolerance,
                                            std::span<const MapRows* const> rows, std::size_t i) {
  // The tightest of uncertain numbers is what the tightest of both ends leave.
  const auto is_wide = [i](const MapRows* of) { return of->results[i].status == Status::wide; };
  const bool tightest = tolerance == 0.0 && std::ranges::none_of(rows, is_wide);
  if (!verified(distance, tolerance) && !tightest) return Status::wide;
  const auto by_device = [i](const MapRows* of) { return of->results[i].status == Status::device_verified; };
  return std::ranges::all_of(rows, by_device) ? Status::device_verified : Status::host_verified;
}

/// The upper end's normals first, as certificates want it; each later normal proves what it can. An escape is that of
/// `inflated` where there is one: what lies outside it lies outside every member.
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
  /// `options` are those of the combined rows. Of a single member, `maps` is its map, made by the same options.
  BracketMap(const verify::MemberBounds& bounds, const MapOptions& options, BracketedMap<Query> maps)
      : bounds_(bounds), options_(options), maps_(std::move(maps)) {}

  /// As Mapper::map.
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

}  // namespace verisq
