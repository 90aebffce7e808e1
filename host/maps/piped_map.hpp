/// A prover and the pipe of a device, or of several, made ready: a map of points to a union of convex primitives.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <future>
#include <memory>
#include <utility>
#include <vector>

#include "host/batches/batch.hpp"
#include "host/batches/point_pipe.hpp"
#include "host/batches/several_pipes.hpp"
#include "host/device/device.hpp"
#include "host/maps/chosen_device.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/map_run.hpp"
#include "host/maps/piped_run.hpp"

namespace verisq {

/// `Prover` as MapRun asks for it. Without certificates.
template <class Prover>
class PipedMap final : public ExactMap<Point> {
 public:
  using MakeSearch = std::function<std::unique_ptr<device::Batch<Point>>(const device::Device&)>;

  /// `make_search`, where there is one, for MapRun::Search. Precondition: `model` is a union of convex primitives.
  PipedMap(Prover prover, const MapOptions& options, const Model& model, const device::RowCriterion& criterion,
           MakeSearch make_search)
      : options_(options),
        prover_(std::move(prover)),
        chosen_(chosen_devices(options, model)),
        make_search_(std::move(make_search)) {
    if (!chosen_.device) return;
    std::vector<std::unique_ptr<device::PointPipe>> pipes;
    pipes.push_back(device::point_pipe(*chosen_.device, model, criterion));
    for (const device::Device& further : chosen_.further)
      pipes.push_back(device::point_pipe(further, model, criterion));
    pipe_ = device::several_pipes(std::move(pipes));
    memories_.resize(pipe_->depth());
  }

  MapSummary map(const Source<Point>& source, const Sink<Point>& sink) override {
    if (!pipe_) return signed_by_device(MapRun<Point, Prover>(prover_, options_, source, sink).on_host());
    StreamFeed feed(source, sink, memories_);
    return mapped(feed);
  }

  MapSummary map_in_memory(const PointColumns& points, const ResultColumns& rows) override {
    if (!pipe_ || !lies_close(points, rows)) return ExactMap<Point>::map_in_memory(points, rows);
    MemoryFeed feed(points, rows);
    return mapped(feed);
  }

 private:
  // Of memory that is wider spread a chunk may span more than a device takes for one buffer.
  static constexpr std::ptrdiff_t most_bytes_to_the_next = 4096;

  template <class Value>
  static bool lies_close(const Column<Value>& column) {
    return std::abs(column.stride) <= most_bytes_to_the_next / static_cast<std::ptrdiff_t>(sizeof(Value));
  }
  static bool lies_close(const PointColumns& points, const ResultColumns& rows) {
    return std::ranges::all_of(points.coordinates(), [](const auto& column) { return lies_close(column); }) &&
           lies_close(rows.lo()) && lies_close(rows.hi()) && lies_close(rows.status());
  }

  template <class Feed>
  MapSummary mapped(Feed& feed) {
    using Run = PipedRun<Prover, Feed>;
    typename Run::Search search;
    typename Run::Announcement announce_search;
    if (make_search_) {
      search = [this]() -> device::Batch<Point>& { return ready_search(); };
      announce_search = [this] { begin_search(); };
    }
    return signed_by_device(Run(prover_, options_, *pipe_, feed, std::move(search), std::move(announce_search))());
  }

  [[nodiscard]] MapSummary signed_by_device(MapSummary summary) const {
    summary.device = chosen_.name();
    summary.notice = chosen_.notice;
    return summary;
  }

  // Makes the search ready while others go on.
  void begin_search() {
    if (search_ || coming_search_.valid()) return;
    coming_search_ = std::async(std::launch::async, [this] { return make_search_(*chosen_.device); });
  }

  device::Batch<Point>& ready_search() {
    if (coming_search_.valid()) search_ = coming_search_.get();
    if (!search_) search_ = make_search_(*chosen_.device);
    return *search_;
  }

  MapOptions options_;
  Prover prover_;
  ChosenDevice chosen_;
  MakeSearch make_search_;                                            // empty: the host searches
  std::unique_ptr<device::Batch<Point>> search_;                      // nothing until it is asked for
  std::vector<ChunkMemory> memories_;                                 // of streams; kept to spare allocations
  std::unique_ptr<device::PointPipe> pipe_;                           // nothing: the host does all
  std::future<std::unique_ptr<device::Batch<Point>>> coming_search_;  // ends before what it uses
};

}  // namespace verisq
