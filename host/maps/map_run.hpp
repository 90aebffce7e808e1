/// A map of any kind of query: source -> device (or host) -> host for open rows -> sink.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/threads/parallel.hpp"
#include "verify/proof/verdict.hpp"
#include "verisq/device.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq {

// The number of queries that a map processes at a time.

/// Enough to keep all processors busy. Few enough that progress, Ctrl-C and limits are noticed soon, whether a proof
/// takes microseconds or, by a search, milliseconds.
class ChunkPace {
 public:
  /// Begins with a few queries.
  ChunkPace() = default;
  /// Begins with `most`, for who is quick as a rule, and comes back to them.
  explicit ChunkPace(std::size_t most) : largest_(most), size_(most) {}
  /// Whole blocks (see rows_per_block) at every time, so that no row depends on the speed of others; begins with
  /// `size`.
  [[nodiscard]] static ChunkPace of_blocks(std::size_t size, std::size_t most) {
    ChunkPace pace(most);
    pace.size_ = size;
    pace.smallest_ = rows_per_block;
    return pace;
  }

  [[nodiscard]] std::size_t size() const {
    return smallest_ < rows_per_block ? size_ : std::max(size_ - size_ % rows_per_block, smallest_);
  }

  /// To be called with the time that each chunk of this size took.
  void took(double seconds) {
    if (seconds < shortest_seconds) size_ = std::min(2 * size_, largest_);
    if (seconds > longest_seconds) size_ = std::max(size_ / 2, smallest_);
  }

 private:
  static constexpr double shortest_seconds = 0.1;
  static constexpr double longest_seconds = 0.4;

  std::size_t largest_ = std::size_t{1} << 16U;
  std::size_t size_ = 64;
  std::size_t smallest_ = 16;
};

/// The functions of the host that a map needs for one kind of query:
///   prove(query) -> CertifiedEnclosure, the host's own proof, with a certificate where they were asked for; when the
///     options are interrupted (which all threads may ask, see SeenInterruption) or out of time it ends early, valid
///     and wide;
///   coarse(query) -> CertifiedEnclosure without a search, likewise; only called when the options are out of time;
///   at_limit(query, found): whether `found` is as tight as the methods get, so that nothing tighter is searched for,
///     though it may be wider than the tolerance;
///   witnessed(query, hi, certificate): whether the certificate is likely to prove that upper end;
///   check(query): throws Error(input) for what is not finite;
///   describe(query): the query in a message.
template <class Query, class Prover>
class MapRun {
 public:
  /// A device's search, without certificates, for rows inside that its proofs leave open. It is made ready at the first
  /// call. Empty, or nothing, if the host does that.
  using Search = std::function<device::Batch<Query>*()>;

  MapRun(const Prover& prover, const MapOptions& options, const Source<Query>& source, const Sink<Query>& sink,
         Search search = {})
      : prover_(prover), options_(options), source_(source), sink_(sink), search_(std::move(search)) {}

  MapSummary on_host() {
    const Enclosure nothing{-infinity, infinity};
    std::vector<Query> queries;
    std::vector<Enclosure> found;
    std::vector<Certificate> certificates;
    while (!options_.interrupted()) {
      read_chunk(pace_.size(), queries);
      if (queries.empty()) return summary_;
      found.assign(queries.size(), nothing);
      certificates.assign(options_.certificates ? queries.size() : 0, {});
      finish(queries, found, certificates);
    }
    summary_.interrupted = true;
    return summary_;
  }

  /// While the device works on one chunk, the next is read and the last is finished and written.
  MapSummary on_device(device::Batch<Query>& batch) {
    std::vector<Query> current;
    std::vector<Query> next;
    std::vector<Enclosure> found;
    std::vector<Certificate> certificates;
    batch.discard();  // what an earlier run left when it failed
    const double earlier_seconds = batch.device_seconds();
    bool all_read = submit_chunk(batch, current);
    while (!current.empty()) {
      if (options_.interrupted()) {
        summary_.interrupted = true;
        next.clear();
      } else {
        all_read = submit_chunk(batch, next);
      }
      const auto start = std::chrono::steady_clock::now();
      batch.collect(found, certificates);
      device_pace_.took(seconds_since(start));
      search_inside(current, found);
      finish(current, found, certificates);
      if (summary_.interrupted) break;
      std::swap(current, next);
    }
    summary_.device_seconds += batch.device_seconds() - earlier_seconds;
    return all_read || summary_.interrupted ? summary_ : on_host();
  }

  /// Searches and proves the open rows among the enclosures that a device `found`; hands all of the rows on.
  void settle(std::span<const Query> queries, std::span<Enclosure> found) {
    search_inside(queries, found);
    finish(queries, found, {});
  }

  [[nodiscard]] const MapSummary& summary() const { return summary_; }

 private:
  // The former contents of `queries` are overwritten: a full vector is not filled with zeros first.
  void read_chunk(std::size_t capacity, std::vector<Query>& queries) const {
    queries.resize(capacity);
    queries.resize(source_(queries));
    for (const Query& query : queries) prover_.check(query);
  }

  // For a block (see rows_per_block); earlier blocks do not count, because the place of a block in the map must not
  // affect its rows. A search for so many rows takes the host about as long as a device takes to be made ready: a tenth
  // of a second, or the first time a second. A map that has half a block is long enough for that.
  static constexpr std::size_t worth_a_search = 16;
  static constexpr std::size_t worth_a_search_of_many = 1;
  static constexpr std::size_t many = rows_per_block / 2;
  static constexpr std::size_t searches_at_a_time = 256;  // a fraction of a second: limits are felt between

  // Adds to `open` the rows of a block that a search may tighten, if they are worth it.
  void add_open_of_block(std::span<const Query> queries, std::span<const Enclosure> found, std::size_t first,
                         std::vector<std::size_t>& open) const {
    const std::size_t count = std::min(rows_per_block, queries.size() - first);
    const std::size_t before = open.size();
    for (std::size_t i = first; i < first + count; ++i) {
      if (found[i].lo < 0.0 && !good(queries[i], found[i])) open.push_back(i);
    }
    if (open.size() - before < (count >= many ? worth_a_search_of_many : worth_a_search)) open.resize(before);
  }

  // Tightens, by the device's search, the open rows that are not proven to lie outside.
  void search_inside(std::span<const Query> queries, std::span<Enclosure> found) {
    if (!search_) return;
    std::vector<std::size_t> open;
    for (std::size_t first = 0; first < queries.size(); first += rows_per_block)
      add_open_of_block(queries, found, first, open);
    if (open.empty()) return;
    device::Batch<Query>* const ready = search_();
    if (ready == nullptr) return;
    device::Batch<Query>& search = *ready;
    search.discard();  // what an earlier run left when it failed
    const double earlier_seconds = search.device_seconds();
    const std::size_t most = std::min(searches_at_a_time, search.capacity());
    std::vector<Query> searched;
    std::vector<Enclosure> narrowed;
    std::vector<Certificate> none;
    for (std::size_t first = 0; first < open.size() && !out_of_time() && !options_.interrupted(); first += most) {
      const auto slice = std::span(open).subspan(first, std::min(most, open.size() - first));
      searched.clear();
      for (const std::size_t i : slice) searched.push_back(queries[i]);
      search.submit(searched);
      search.collect(narrowed, none);
      for (std::size_t n = 0; n < slice.size(); ++n) {
        const std::size_t i = slice[n];
        found[i] = verify::intersection(found[i], narrowed[n],
                                        [&] { return "the distance at " + prover_.describe(queries[i]); });
      }
    }
    summary_.device_seconds += search.device_seconds() - earlier_seconds;
  }

  // Leaves `queries` empty, and returns that, if nothing is left to be read; also when the time is up.
  bool submit_chunk(device::Batch<Query>& batch, std::vector<Query>& queries) const {
    if (out_of_time()) {
      queries.clear();
      return false;
    }
    // Full chunks keep a device busiest; with a time limit, the submitted work must be done soon.
    const std::size_t size = options_.out_of_time ? device_pace_.size() : batch.capacity();
    read_chunk(std::min(size, batch.capacity()), queries);
    if (!queries.empty()) batch.submit(queries);
    return queries.empty();
  }

  [[nodiscard]] static double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  // At most the tolerance wide; if 0 requests the tightest, as tight as the methods get.
  [[nodiscard]] bool good(const Query& query, const Enclosure& found) const {
    return verified(found, options_.tolerance) || (options_.tolerance == 0.0 && prover_.at_limit(query, found));
  }

  [[nodiscard]] bool out_of_time() const { return options_.out_of_time && options_.out_of_time(); }

  // Proves on the host the rows that `found` leaves wide, and hands the rows on, up to an interruption. `certificates`
  // are those of `found`; empty unless they were requested.
  void finish(std::span<const Query> queries, std::span<Enclosure> found, std::span<Certificate> certificates) {
    for (std::size_t first = 0; first < queries.size();) {
      if (summary_.interrupted || (first > 0 && options_.interrupted())) {
        summary_.interrupted = true;
        return;
      }
      const std::size_t count = std::min(pace_.size(), queries.size() - first);
      finish_chunk(queries.subspan(first, count), found.subspan(first, count),
                   certificates.empty() ? certificates : certificates.subspan(first, count));
      first += count;
    }
  }

  // Sets the rows that the host has nothing to add to; returns the others.
  std::vector<std::size_t> without_open(std::span<const Query> queries, std::span<const Enclosure> found) {
    const Status at_limit = options_.tolerance == 0.0 ? Status::device_verified : Status::wide;
    std::vector<std::size_t> open;
    rows_.resize(queries.size());
    for (std::size_t i = 0; i < queries.size(); ++i) {
      rows_[i] = {found[i], Status::device_verified};
      if (verified(found[i], options_.tolerance)) continue;
      rows_[i].status = at_limit;
      if (!prover_.at_limit(queries[i], found[i])) open.push_back(i);
    }
    return open;
  }

  void finish_chunk(std::span<const Query> queries, std::span<Enclosure> found, std::span<Certificate> certificates) {
    const auto start = std::chrono::steady_clock::now();
    if (options_.certificates) drop_unwitnessed(queries, found, certificates);
    const std::vector<std::size_t> open = without_open(queries, found);
    const std::size_t done = in_parallel_until(options_.interrupted, open.size(), [&](std::size_t n) {
      const std::size_t i = open[n];
      const auto add = [&](const CertifiedEnclosure& proven) {
        CertifiedEnclosure row{found[i], {}};
        if (options_.certificates) row.certificate = std::move(certificates[i]);
        row = certified_intersection(row, proven, [&] { return "the distance at " + prover_.describe(queries[i]); });
        found[i] = row.distance;
        if (options_.certificates) certificates[i] = std::move(row.certificate);
      };
      if (!out_of_time()) add(prover_.prove(queries[i]));
      if (!good(queries[i], found[i]) && out_of_time()) add(prover_.coarse(queries[i]));
    });
    const double seconds = seconds_since(start);
    summary_.host_seconds += seconds;
    pace_.took(seconds);

    for (const std::size_t i : open)
      rows_[i] = {found[i], good(queries[i], found[i]) ? Status::host_verified : Status::wide};
    const auto is_wide = [&](std::size_t i) { return rows_[i].status == Status::wide; };
    if (std::ranges::any_of(open, is_wide) && out_of_time()) summary_.out_of_time = true;
    if (done < open.size()) {
      summary_.interrupted = true;
      rows_.resize(open[done]);
    }
    count(summary_, rows_);
    sink_(queries.first(rows_.size()), rows_, certificates.first(std::min(certificates.size(), rows_.size())));
  }

  // Upper ends that hold, but not by their certificates.
  void drop_unwitnessed(std::span<const Query> queries, std::span<Enclosure> found,
                        std::span<const Certificate> certificates) const {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!(found[i].hi > 0.0) || certificates[i].normals.empty()) continue;
      if (prover_.witnessed(queries[i], found[i].hi, certificates[i])) continue;
      found[i].hi = infinity;
    }
  }

  const Prover& prover_;
  const MapOptions& options_;
  const Source<Query>& source_;
  const Sink<Query>& sink_;
  Search search_;
  ChunkPace pace_;               // of what the host finishes
  ChunkPace device_pace_;        // of what the device is given, where there is a time limit
  std::vector<MapResult> rows_;  // of the current chunk; kept to spare allocations
  MapSummary summary_ = empty_summary();
};

// The device that makes a map, or the reason why none does.

/// Without a device the host does all; the notice states why a device was passed over.
struct ChosenDevice : device::Selection {
  std::vector<device::Device> further;  ///< devices that work beside it

  [[nodiscard]] std::string name() const {
    if (!device) return "host";
    std::string names = device->name;
    for (const device::Device& other : further) names += " and " + other.name;
    return names;
  }
};

/// `primitives` are all that the device must have room for; `unsuited`, unless it is empty, is the reason why no device
/// is to be used. Throws like device::select_device.
[[nodiscard]] inline ChosenDevice chosen_device(const MapOptions& options, const Model& primitives,
                                                const std::string& unsuited) {
  if (options.device == "host" || (options.device == "auto" && has_mesh(primitives))) return {};
  const auto ended = either(options.interrupted, options.out_of_time);
  if (ended && ended()) return {};  // to make one ready may take seconds
  device::Selection selection = device::select_device(options.device, ended);
  if (!selection.device) return {{std::nullopt, selection.notice}, {}};
  if (std::string reason = device::why_not_on_devices(primitives); !reason.empty())
    return {{std::nullopt, std::move(reason)}, {}};
  if (!unsuited.empty()) return {{std::nullopt, unsuited}, {}};
  return {std::move(selection), {}};
}

/// One device, or as many as the options name: for maps of points about unions of convex solids. Throws the same
/// errors.
[[nodiscard]] inline ChosenDevice chosen_devices(const MapOptions& options, const Model& primitives) {
  const std::vector<std::string> requests = device::requests_in(options.device);
  MapOptions of_one = options;
  of_one.device = requests.front();
  ChosenDevice chosen = chosen_device(of_one, primitives, {});
  if (!chosen.device) return chosen;
  for (const std::string& request : std::span(requests).subspan(1))
    chosen.further.push_back(*device::select_device(request).device);
  return chosen;
}

// A map of queries in memory by a map that reads from a source and writes to a sink.

/// Delivers `queries`, which must outlive it, from the number `next` on.
template <class Query>
[[nodiscard]] Source<Query> source_of(const typename QueriesInMemory<Query>::type& queries, std::size_t next = 0) {
  return [&queries, next](std::span<Query> chunk) mutable {
    const std::size_t count = std::min(chunk.size(), queries.size() - next);
    for (std::size_t i = 0; i < count; ++i) chunk[i] = queries[next + i];
    next += count;
    return count;
  };
}

/// Fills `columns` from the row `next` on; drops certificates.
template <class Query>
[[nodiscard]] Sink<Query> sink_of(const ResultColumns& columns, std::size_t next = 0) {
  return
      [columns, next](std::span<const Query>, std::span<const MapResult> rows, std::span<const Certificate>) mutable {
        for (const MapResult& row : rows) columns.set(next++, row);
      };
}

/// `map(source, sink)` of all queries. Precondition: as many rows.
template <class Query, class Map>
[[nodiscard]] MapSummary map_copies(const typename QueriesInMemory<Query>::type& queries, const ResultColumns& rows,
                                    const Map& map) {
  return map(source_of<Query>(queries), sink_of<Query>(rows));
}

// Maps of ordinary models and exact queries: the parts of all other maps.

/// Like Mapper; its two kinds of maps have names of their own here.
template <class Query>
class ExactMap {
 public:
  ExactMap() = default;
  virtual ~ExactMap() = default;
  ExactMap(const ExactMap&) = delete;
  ExactMap& operator=(const ExactMap&) = delete;

  virtual MapSummary map(const Source<Query>& source, const Sink<Query>& sink) = 0;
  virtual MapSummary map_in_memory(const typename QueriesInMemory<Query>::type& queries, const ResultColumns& rows) {
    return map_copies<Query>(queries, rows, [this](const auto& source, const auto& sink) { return map(source, sink); });
  }
};

/// Throw as the constructors of Mapper. Points and triangles are exact, whatever radius the options give.
[[nodiscard]] std::unique_ptr<ExactMap<Point>> point_map(const Model& model, const MapOptions& options);
[[nodiscard]] std::unique_ptr<ExactMap<Point>> mesh_map(const Model& model, const MapOptions& options);

// A prover and, unless the host does all, a device made ready: a map of one kind of query.

/// `Prover` as MapRun requires it.
template <class Query, class Prover>
class PreparedMap final : public ExactMap<Query> {
 public:
  /// Makes a device ready for a kind of work.
  using MakeBatch = std::function<std::unique_ptr<device::Batch<Query>>(const device::Device&)>;

  /// `primitives` are all that the device must have room for. `make_batch` makes the device ready and owns the objects
  /// that it uses. If `unsuited` gives a reason why no device is to be used, `make_batch` may be empty.
  PreparedMap(Prover prover, const MapOptions& options, const Model& primitives, const MakeBatch& make_batch,
              const std::string& unsuited = {})
      : options_(options),
        prover_(std::move(prover)),
        chosen_(chosen_device(options, primitives, unsuited)),
        batch_(made_ready(chosen_, options.device, either(options.interrupted, options.out_of_time), make_batch)) {}

  MapSummary map(const Source<Query>& source, const Sink<Query>& sink) override {
    MapRun<Query, Prover> run(prover_, options_, source, sink);
    MapSummary summary = batch_ ? run.on_device(*batch_) : run.on_host();
    summary.device = chosen_.name();
    summary.notice = chosen_.notice;
    return summary;
  }

 private:
  MapOptions options_;
  Prover prover_;
  ChosenDevice chosen_;
  std::unique_ptr<device::Batch<Query>> batch_;  // nothing: the host does all
};

}  // namespace verisq
