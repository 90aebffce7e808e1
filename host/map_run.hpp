/// A map of any kind of query: source -> device (or host) -> host for what stays open -> sink.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/certified_intersection.hpp"
#include "host/device/batch.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/parallel.hpp"
#include "host/summary_count.hpp"
#include "verisq/distance_map.hpp"

namespace verisq {

/// What a map asks of the host about one kind of query:
///   prove(query) -> CertifiedEnclosure, the host's own proof, with a certificate where they were asked for;
///   at_limit(query, found): whether the host could do no better, though `found` is wider than the tolerance;
///   witnessed(query, hi, certificate): whether the certificate is likely to prove that upper end;
///   check(query): throws Error(input) for what is not finite;
///   describe(query): the query in a message.
template <class Query, class Prover>
class MapRun {
 public:
  using Source = std::function<std::size_t(std::span<Query>)>;
  using Sink = std::function<void(std::span<const Query>, std::span<const MapResult>, std::span<const Certificate>)>;

  MapRun(const Prover& prover, const MapOptions& options, const Source& source, const Sink& sink)
      : prover_(prover), options_(options), source_(source), sink_(sink) {}

  MapSummary on_host() {
    constexpr std::size_t chunk = 4096;
    const Enclosure nothing{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    std::vector<Query> queries;
    std::vector<Enclosure> found;
    std::vector<Certificate> certificates;
    while (!options_.interrupted()) {
      read_chunk(chunk, queries);
      if (queries.empty()) return summary_;
      found.assign(queries.size(), nothing);
      certificates.assign(options_.certificates ? queries.size() : 0, {});
      finish_chunk(queries, found, certificates);
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
    read_chunk(batch.capacity(), current);
    if (!current.empty()) batch.submit(current);
    while (!current.empty()) {
      next.clear();
      if (options_.interrupted())
        summary_.interrupted = true;
      else
        read_chunk(batch.capacity(), next);
      if (!next.empty()) batch.submit(next);
      batch.collect(found, certificates);
      finish_chunk(current, found, certificates);
      std::swap(current, next);
    }
    summary_.device_seconds = batch.device_seconds() - earlier_seconds;
    return summary_;
  }

 private:
  void read_chunk(std::size_t capacity, std::vector<Query>& queries) const {
    queries.resize(capacity);
    queries.resize(source_(queries));
    for (const Query& query : queries) prover_.check(query);
  }

  // Proves on the host what `found` leaves wide, and hands the rows on. `certificates` are those of `found`; empty
  // unless they were asked for.
  void finish_chunk(std::span<const Query> queries, std::span<Enclosure> found, std::span<Certificate> certificates) {
    const auto start = std::chrono::steady_clock::now();
    if (options_.certificates) drop_unwitnessed(queries, found, certificates);
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!verified(found[i], options_.tolerance) && !prover_.at_limit(queries[i], found[i])) open.push_back(i);
    }
    in_parallel(open.size(), [&](std::size_t n) {
      const std::size_t i = open[n];
      const CertifiedEnclosure proven = prover_.prove(queries[i]);
      if (options_.certificates) certificates[i] = merged({found[i], std::move(certificates[i])}, proven);
      found[i] = intersection(found[i], proven.distance, prover_.describe(queries[i]));
    });
    summary_.host_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    rows_.resize(queries.size());
    for (std::size_t i = 0; i < queries.size(); ++i)
      rows_[i] = {found[i], verified(found[i], options_.tolerance) ? Status::device_verified : Status::wide};
    for (const std::size_t i : open)
      if (rows_[i].status == Status::device_verified) rows_[i].status = Status::host_verified;
    for (const MapResult& row : rows_) count(summary_, row);
    sink_(queries, rows_, certificates);
  }

  // Upper ends that hold, but not by their certificates.
  void drop_unwitnessed(std::span<const Query> queries, std::span<Enclosure> found,
                        std::span<const Certificate> certificates) const {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!(found[i].hi > 0.0) || certificates[i].normals.empty()) continue;
      if (prover_.witnessed(queries[i], found[i].hi, certificates[i])) continue;
      found[i].hi = std::numeric_limits<double>::infinity();
    }
  }

  const Prover& prover_;
  const MapOptions& options_;
  const Source& source_;
  const Sink& sink_;
  std::vector<MapResult> rows_;  // of the current chunk; kept to spare allocations
  MapSummary summary_ = empty_summary();
};

/// A prover and, unless the host does all, a device made ready: what a mapper of one kind of query holds.
template <class Query, class Prover>
class Mapping {
 public:
  using Run = MapRun<Query, Prover>;

  /// `primitives` are all that the device must be able to hold; `make_batch(device)` makes the device ready.
  template <class MakeBatch>
  Mapping(Prover prover, const MapOptions& options, const Model& primitives, const MakeBatch& make_batch)
      : options_(options), prover_(std::move(prover)) {
    if (options.device == "host") return;
    const device::Selection selection = device::select_device(options.device);
    notice_ = selection.notice;
    if (!selection.device) return;
    if (!device::within_device_range(primitives)) {
      notice_ = "the model's sizes span more than the device's kernels are made for";
      return;
    }
    name_ = selection.device->name;
    batch_ = make_batch(*selection.device);
  }

  MapSummary map(const typename Run::Source& source, const typename Run::Sink& sink) {
    Run run(prover_, options_, source, sink);
    MapSummary summary = batch_ ? run.on_device(*batch_) : run.on_host();
    summary.device = name_;
    summary.notice = notice_;
    return summary;
  }

 private:
  MapOptions options_;
  Prover prover_;
  std::string name_ = "host";
  std::string notice_;
  std::unique_ptr<device::Batch<Query>> batch_;  // nothing: the host does all
};

}  // namespace verisq
