/// A map of any kind of query: source -> device (or host) -> host for what stays open -> sink.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/batches/batch.hpp"
#include "host/maps/certified_intersection.hpp"
#include "host/maps/chunk_pace.hpp"
#include "host/maps/summary_count.hpp"
#include "host/threads/parallel.hpp"
#include "verify/proof/intersection.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// What a map asks of the host about one kind of query:
///   prove(query) -> CertifiedEnclosure, the host's own proof, with a certificate where they were asked for; when the
///     options are out of time it ends early, valid and wide;
///   coarse(query) -> CertifiedEnclosure without a search, likewise; only called when the options are out of time;
///   at_limit(query, found): whether `found` is as tight as the methods get, so that nothing tighter is searched for,
///     though it may be wider than the tolerance;
///   witnessed(query, hi, certificate): whether the certificate is likely to prove that upper end;
///   check(query): throws Error(input) for what is not finite;
///   describe(query): the query in a message;
///   begin() and interrupted(), of provers whose proofs end when the map is interrupted: called first of all; whether
///     some did since.
template <class Query, class Prover>
class MapRun {
 public:
  /// A device's search, without certificates, for what its proofs leave open inside: made ready when it is first asked
  /// for. Empty, where the host does that.
  using Search = std::function<device::Batch<Query>&()>;

  MapRun(const Prover& prover, const MapOptions& options, const Source<Query>& source, const Sink<Query>& sink,
         Search search = {})
      : prover_(prover), options_(options), source_(source), sink_(sink), search_(std::move(search)) {}

  MapSummary on_host() {
    const Enclosure nothing{-infinity, infinity};
    std::vector<Query> queries;
    std::vector<Enclosure> found;
    std::vector<Certificate> certificates;
    if constexpr (requires { prover_.begin(); }) prover_.begin();
    while (!options_.interrupted() && !proofs_interrupted()) {
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

  /// Searches and proves what enclosures that a device `found` leave open; hands all of the rows on.
  void settle(std::span<const Query> queries, std::span<Enclosure> found) {
    search_inside(queries, found);
    finish(queries, found, {});
  }

  [[nodiscard]] const MapSummary& summary() const { return summary_; }

 private:
  // What `queries` held before is overwritten: a full vector is not filled with zeros first.
  void read_chunk(std::size_t capacity, std::vector<Query>& queries) const {
    queries.resize(capacity);
    queries.resize(source_(queries));
    for (const Query& query : queries) prover_.check(query);
  }

  // Of a block (see rows_per_block): what blocks before had does not count, for where in a map a block lies must make
  // no difference to its rows. A search of so many takes the host about as long as a device takes to be made ready for
  // it: a tenth of a second, or the first time a second. A map that has half a block is long enough to be worth that.
  static constexpr std::size_t worth_a_search = 16;
  static constexpr std::size_t worth_a_search_of_many = 1;
  static constexpr std::size_t many = rows_per_block / 2;
  static constexpr std::size_t searches_at_a_time = 256;  // a fraction of a second: limits are felt between

  // To `open` those of a block that a search may tighten, if they are worth it.
  void add_open_of_block(std::span<const Query> queries, std::span<const Enclosure> found, std::size_t first,
                         std::vector<std::size_t>& open) const {
    const std::size_t count = std::min(rows_per_block, queries.size() - first);
    const std::size_t before = open.size();
    for (std::size_t i = first; i < first + count; ++i) {
      if (found[i].lo < 0.0 && !good(queries[i], found[i])) open.push_back(i);
    }
    if (open.size() - before < (count >= many ? worth_a_search_of_many : worth_a_search)) open.resize(before);
  }

  // Tightens what is open and not proven to lie outside by the device's search.
  void search_inside(std::span<const Query> queries, std::span<Enclosure> found) {
    if (!search_) return;
    std::vector<std::size_t> open;
    for (std::size_t first = 0; first < queries.size(); first += rows_per_block)
      add_open_of_block(queries, found, first, open);
    if (open.empty()) return;
    device::Batch<Query>& search = search_();
    search.discard();  // what an earlier run left when it failed
    const double earlier_seconds = search.device_seconds();
    const std::size_t most = std::min(searches_at_a_time, search.capacity());
    std::vector<Query> searched;
    std::vector<Enclosure> narrowed;
    std::vector<Certificate> none;
    for (std::size_t first = 0; first < open.size() && !out_of_time(); first += most) {
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

  // Leaves `queries` empty when nothing is left to be read, and says so; also when the time is up.
  bool submit_chunk(device::Batch<Query>& batch, std::vector<Query>& queries) const {
    if (out_of_time()) {
      queries.clear();
      return false;
    }
    // Full chunks keep a device busiest; with a time limit, what it has begun must be done soon.
    const std::size_t size = options_.out_of_time ? device_pace_.size() : batch.capacity();
    read_chunk(std::min(size, batch.capacity()), queries);
    if (!queries.empty()) batch.submit(queries);
    return queries.empty();
  }

  [[nodiscard]] static double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  // At most the tolerance wide; where 0 asks for the tightest, as tight as the methods get.
  [[nodiscard]] bool good(const Query& query, const Enclosure& found) const {
    return verified(found, options_.tolerance) || (options_.tolerance == 0.0 && prover_.at_limit(query, found));
  }

  [[nodiscard]] bool out_of_time() const { return options_.out_of_time && options_.out_of_time(); }

  // Proves on the host what `found` leaves wide, and hands the rows on, unless it is interrupted. `certificates` are
  // those of `found`; empty unless they were asked for.
  void finish(std::span<const Query> queries, std::span<Enclosure> found, std::span<Certificate> certificates) {
    for (std::size_t first = 0; first < queries.size();) {
      if (first > 0 && options_.interrupted()) {
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
    in_parallel(open.size(), [&](std::size_t n) {
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
    rows_.resize(rows_before_interruption());
    count(summary_, rows_);
    sink_(queries.first(rows_.size()), rows_, certificates.first(std::min(certificates.size(), rows_.size())));
  }

  [[nodiscard]] bool proofs_interrupted() const {
    if constexpr (requires { prover_.interrupted(); }) return prover_.interrupted();
    return false;
  }

  // All, unless proofs were interrupted: then those before the first that may be one of these.
  [[nodiscard]] std::size_t rows_before_interruption() const {
    if (!proofs_interrupted()) return rows_.size();
    return static_cast<std::size_t>(std::ranges::find(rows_, Status::wide, &MapResult::status) - rows_.begin());
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

}  // namespace verisq
