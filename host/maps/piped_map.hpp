/// Maps of points through the pipes of devices: the host processes only the rows that these leave open.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/device.hpp"
#include "host/device/point_pipe.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/maps/map_run.hpp"
#include "host/threads/background_work.hpp"
#include "verisq/device.hpp"
#include "verisq/error.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// Adds a device's sums to the summary.
inline void count(MapSummary& summary, const device::RowSums& sums) {
  summary.points += std::uint64_t{sums.verified} + sums.wide;
  summary.device_verified += sums.verified;
  summary.wide += sums.wide;
  summary.wide_inside += sums.wide_inside;
  extend(summary, sums.minimum_lo, sums.minimum_hi, sums.largest_width);
}

// The sources of the chunks of a map of points, and the destinations of their rows.

/// Some points and the memory of their rows.
struct PointChunk {
  PointColumns points;
  ResultColumns rows;
};

/// A feed of points and rows in the caller's memory: nothing is copied.
class MemoryFeed {
 public:
  MemoryFeed(const PointColumns& points, const ResultColumns& rows) : points_(points), rows_(rows) {}

  /// The next chunk, of at most `most` points; of none at the end.
  [[nodiscard]] PointChunk next(std::size_t most) {
    const std::size_t first = next_;
    const std::size_t count = std::min(most, points_.size() - first);
    next_ += count;
    return {points_.subspan(first, count), rows_.subspan(first, count)};
  }

  /// Must be called with the rows of each chunk, in order, when they are complete.
  void deliver(const PointChunk& /*chunk*/, std::size_t /*first*/, std::size_t /*count*/) {}

  /// The points that `next` has not returned yet.
  [[nodiscard]] Source<Point> rest() const { return source_of<Point>(points_, next_); }
  [[nodiscard]] Sink<Point> sink() const { return sink_of<Point>(rows_, next_); }

 private:
  PointColumns points_;
  ResultColumns rows_;
  std::size_t next_ = 0;
};

/// The memory of one chunk.
struct ChunkMemory {
  std::vector<Point> points;
  std::vector<MapResult> rows;
};

/// A feed from a source to a sink through the memory of a few chunks: when all are filled, the next waits until the
/// first is delivered.
class StreamFeed {
 public:
  /// All must outlive this; a memory for each chunk that may be in flight.
  StreamFeed(const Source<Point>& source, const Sink<Point>& sink, std::span<ChunkMemory> memories)
      : source_(source), sink_(sink), memories_(memories) {}

  [[nodiscard]] PointChunk next(std::size_t most) {
    ChunkMemory& memory = memories_[turn_];
    turn_ = (turn_ + 1) % memories_.size();
    if (memory.points.size() < most) {
      memory.points.resize(most);
      memory.rows.resize(most);
    }
    const std::size_t count = source_(std::span(memory.points).first(most));
    return {std::span<const Point>(memory.points).first(count), std::span(memory.rows).first(count)};
  }

  void deliver(const PointChunk& chunk, std::size_t first, std::size_t count) {
    for (const ChunkMemory& memory : memories_) {
      if (chunk.points.coordinates()[0].first != memory.points.data()->data()) continue;
      sink_(std::span(memory.points).subspan(first, count), std::span(memory.rows).subspan(first, count), {});
    }
  }

  [[nodiscard]] const Source<Point>& rest() const { return source_; }
  [[nodiscard]] const Sink<Point>& sink() const { return sink_; }

 private:
  const Source<Point>& source_;
  const Sink<Point>& sink_;
  std::span<ChunkMemory> memories_;
  std::size_t turn_ = 0;
};

// A map of points through a device's pipe: the host processes only the rows that the device leaves open.

/// `Prover` as MapRun requires it, `Feed` like MemoryFeed and StreamFeed.
template <class Prover, class Feed>
class PipedRun {
 public:
  using Search = typename MapRun<Point, Prover>::Search;
  /// Called if the search is likely to be needed; returns at once. Empty if there is none.
  using Announcement = std::function<void()>;

  /// All must outlive this.
  PipedRun(const Prover& prover, const MapOptions& options, device::PointPipe& pipe, Feed& feed, Search search,
           Announcement announce_search)
      : prover_(prover),
        options_(options),
        pipe_(pipe),
        feed_(feed),
        announce_search_(std::move(announce_search)),
        pace_(options.out_of_time ? ChunkPace() : ChunkPace::of_blocks(pipe.largest_chunk(), pipe.largest_chunk())),
        open_(prover, options, no_source_, write_settled_, std::move(search)) {}

  /// While the device works on the chunks in flight, the last is finished and delivered.
  MapSummary operator()() {
    const Ending ending(pipe_);
    const double earlier_seconds = pipe_.device_seconds();
    std::deque<PointChunk> in_flight;
    while (fill(in_flight)) {
      const auto start = std::chrono::steady_clock::now();
      const PointChunk oldest = in_flight.front();
      in_flight.pop_front();
      const device::ChunkOutcome outcome = pipe_.collect();
      if (outcome.refused) refuse(oldest.points);
      finish(oldest, outcome.blocks);
      if (open_.summary().interrupted) break;
      pace_.took(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    summary_.device_seconds = pipe_.device_seconds() - earlier_seconds;
    add_of(open_.summary());
    if (out_of_time_ && !summary_.interrupted) add_of(on_host());
    return summary_;
  }

 private:
  /// The device writes into the caller's memory until it has ended, whatever happens.
  class Ending {
   public:
    explicit Ending(device::PointPipe& pipe) : pipe_(pipe) { pipe.discard(); }
    ~Ending() {
      try {
        pipe_.discard();
      } catch (const Error&) {  // NOLINT(bugprone-empty-catch): another one is on its way
      }
    }
    Ending(const Ending&) = delete;
    Ending& operator=(const Ending&) = delete;

   private:
    device::PointPipe& pipe_;
  };

  // Submits as many chunks as may be in flight, while there are some; false at the end.
  bool fill(std::deque<PointChunk>& in_flight) {
    while (!ended_ && in_flight.size() < pipe_.depth()) {
      summary_.interrupted = options_.interrupted();
      const PointChunk next = summary_.interrupted ? nothing() : submitted();
      ended_ = next.points.size() == 0;
      if (!ended_) in_flight.push_back(next);
    }
    return !in_flight.empty();
  }

  static PointChunk nothing() { return {std::span<const Point>(), std::span<MapResult>()}; }

  // The next submitted chunk; nothing at the end, or when the time is up.
  PointChunk submitted() {
    out_of_time_ = options_.out_of_time && options_.out_of_time();
    if (out_of_time_) return nothing();
    PointChunk chunk = feed_.next(std::min(pace_.size(), pipe_.capacity()));
    if (chunk.points.size() > 0) pipe_.submit(chunk.points, chunk.rows);
    return chunk;
  }

  [[noreturn]] void refuse(const PointColumns& points) const {
    for (std::size_t i = 0; i < points.size(); ++i) prover_.check(points[i]);
    throw Error(ErrorKind::failure, "the device refused points that are finite");
  }

  // The number of blocks, from the first on, that belong to the first one's block of the map.
  static std::size_t of_one_block(std::span<const device::RowBlock> blocks) {
    const std::size_t beyond = blocks.front().first - blocks.front().first % rows_per_block + rows_per_block;
    const auto is_beyond = [beyond](const device::RowBlock& block) { return block.first >= beyond; };
    return static_cast<std::size_t>(std::ranges::find_if(blocks, is_beyond) - blocks.begin());
  }

  static bool any_open(std::span<const device::RowBlock> blocks) {
    return std::ranges::any_of(blocks, [](const device::RowBlock& block) { return block.sums.open > 0; });
  }

  // Neighbours that are all proven, or not, at once: whole blocks of the map, because these are settled each by itself.
  void finish(const PointChunk& chunk, std::span<const device::RowBlock> blocks) {
    while (!blocks.empty() && !open_.summary().interrupted) {
      std::size_t count = of_one_block(blocks);
      const bool open = any_open(blocks.first(count));
      while (count < blocks.size()) {
        const std::size_t next = of_one_block(blocks.subspan(count));
        if (any_open(blocks.subspan(count, next)) != open) break;
        count += next;
      }
      const std::span<const device::RowBlock> alike = blocks.first(count);
      if (open)
        settle(chunk, alike);
      else
        take(chunk, alike);
      blocks = blocks.subspan(count);
    }
  }

  void take(const PointChunk& chunk, std::span<const device::RowBlock> blocks) {
    for (const device::RowBlock& block : blocks) count(summary_, block.sums);
    feed_.deliver(chunk, blocks.front().first, rows_of(blocks));
  }

  // If a long map has a few rows that a search may narrow, it will have enough of them to be worthwhile; the search is
  // made ready while the host proves these.
  static constexpr std::size_t enough_to_announce = 4;

  void announce_search(const PointChunk& chunk) {
    const auto may_be_narrowed = [this](const Enclosure& found) {
      return found.lo < 0.0 && options_.tolerance > 0.0 && !verified(found, options_.tolerance);
    };
    open_inside_ += static_cast<std::size_t>(std::ranges::count_if(found_, may_be_narrowed));
    const bool long_map = chunk.points.size() == pipe_.capacity();
    if (announce_search_ && long_map && open_inside_ >= enough_to_announce) announce_search_();
  }

  // The host judges and counts all rows of blocks with open ones by itself.
  void settle(const PointChunk& chunk, std::span<const device::RowBlock> blocks) {
    queries_.resize(rows_of(blocks));
    found_.resize(queries_.size());
    for (std::size_t i = 0; i < queries_.size(); ++i) {
      queries_[i] = chunk.points[blocks.front().first + i];
      found_[i] = chunk.rows[blocks.front().first + i].distance;
    }
    announce_search(chunk);
    settled_chunk_ = &chunk;
    settled_row_ = blocks.front().first;
    open_.settle(queries_, found_);
  }

  static std::size_t rows_of(std::span<const device::RowBlock> blocks) {
    return blocks.back().first + blocks.back().count - blocks.front().first;
  }

  MapSummary on_host() {
    const Source<Point>& source = feed_.rest();
    const Sink<Point>& sink = feed_.sink();
    return MapRun<Point, Prover>(prover_, options_, source, sink).on_host();
  }

  void add_of(const MapSummary& run) {
    add(summary_, run);
    summary_.device_seconds += run.device_seconds;
    summary_.host_seconds += run.host_seconds;
    summary_.interrupted = summary_.interrupted || run.interrupted;
    summary_.out_of_time = summary_.out_of_time || run.out_of_time;
  }

  const Prover& prover_;
  const MapOptions& options_;
  device::PointPipe& pipe_;
  Feed& feed_;
  Announcement announce_search_;
  ChunkPace pace_;
  bool out_of_time_ = false;  // when the next chunk was asked for
  bool ended_ = false;        // no chunk is asked for any more
  MapSummary summary_ = empty_summary();

  // The open rows.
  std::size_t open_inside_ = 0;  // so far
  std::vector<Point> queries_;
  std::vector<Enclosure> found_;
  const PointChunk* settled_chunk_ = nullptr;
  std::size_t settled_row_ = 0;
  const Source<Point> no_source_;
  const Sink<Point> write_settled_ = [this](std::span<const Point>, std::span<const MapResult> rows,
                                            std::span<const Certificate>) {
    for (std::size_t i = 0; i < rows.size(); ++i) settled_chunk_->rows.set(settled_row_ + i, rows[i]);
    feed_.deliver(*settled_chunk_, settled_row_, rows.size());
    settled_row_ += rows.size();
  };
  MapRun<Point, Prover> open_;
};

// A prover and the pipe of a device, or of several, made ready: a map of points to a union of convex primitives.

/// `Prover` as MapRun requires it. Without certificates.
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
    const auto make = [model, criterion, others = chosen_.further](const device::Device& first) {
      std::vector<std::unique_ptr<device::PointPipe>> pipes;
      pipes.push_back(device::point_pipe(first, model, criterion));
      for (const device::Device& other : others) pipes.push_back(device::point_pipe(other, model, criterion));
      return device::several_pipes(std::move(pipes));
    };
    pipe_ = made_ready(chosen_, options.device, either(options.interrupted, options.out_of_time), make);
    if (pipe_) memories_.resize(pipe_->depth());
  }

  MapSummary map(const Source<Point>& source, const Sink<Point>& sink) override {
    if (!pipe_) return signed_by_device(MapRun<Point, Prover>(prover_, options_, source, sink).on_host());
    StreamFeed feed(source, sink, memories_);
    try {
      return mapped(feed);
    } catch (const device::RefusedDevice& refused) {
      // Depths are searched by a program that is made ready when the first point inside is met.
      note_refusal(chosen_.notice, options_.device, refused);
      throw Error(ErrorKind::failure, fmt::format("{}; the map has begun by then: give `device` host", refused.what()));
    }
  }

  MapSummary map_in_memory(const PointColumns& points, const ResultColumns& rows) override {
    if (!pipe_ || !lies_close(points, rows)) return ExactMap<Point>::map_in_memory(points, rows);
    MemoryFeed feed(points, rows);
    try {
      return mapped(feed);
    } catch (const device::RefusedDevice& refused) {
      note_refusal(chosen_.notice, options_.device, refused);
      chosen_.device.reset();
      pipe_.reset();
    }
    return ExactMap<Point>::map_in_memory(points, rows);  // all rows again, by the host
  }

 private:
  // A chunk of more widely spread memory may span more than a device accepts for one buffer.
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
      search = [this] { return ready_search(); };
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
    if (search_ || !make_search_ || coming_search_) return;
    coming_search_.emplace([make = make_search_, device = *chosen_.device] { return make(device); });
  }

  // Nothing if its kernels err on samples: the host then searches, and the other kernels stay in use. Nothing, for now,
  // if the map is to end before they are compiled.
  device::Batch<Point>* ready_search() {
    try {
      begin_search();
      if (coming_search_) {
        auto ready = coming_search_->result(either(options_.interrupted, options_.out_of_time));
        if (!ready) return nullptr;
        search_ = std::move(*ready);
        coming_search_.reset();
      }
    } catch (const device::RefusedDevice& refused) {
      make_search_ = nullptr;
      coming_search_.reset();
      note_refusal(chosen_.notice, options_.device, refused);
    }
    return search_.get();
  }

  MapOptions options_;
  Prover prover_;
  ChosenDevice chosen_;
  MakeSearch make_search_;                        // owns what it uses; empty: the host searches
  std::unique_ptr<device::Batch<Point>> search_;  // nothing until it is asked for
  std::vector<ChunkMemory> memories_;             // of streams; kept to spare allocations
  std::unique_ptr<device::PointPipe> pipe_;       // nothing: the host does all
  std::optional<WorkThatMayBeGivenUp<std::unique_ptr<device::Batch<Point>>>> coming_search_;
};

}  // namespace verisq
