/// A map of points through a device's pipe: the host sees only what the device leaves open.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "host/batches/point_pipe.hpp"
#include "host/maps/chunk_pace.hpp"
#include "host/maps/map_run.hpp"
#include "host/maps/point_feed.hpp"
#include "host/maps/summary_count.hpp"
#include "verisq/error.hpp"

namespace verisq {

/// `Prover` as MapRun asks for it, `Feed` as point_feed.hpp has them.
template <class Prover, class Feed>
class PipedRun {
 public:
  using Search = typename MapRun<Point, Prover>::Search;
  /// Called where the search is likely to be asked for; returns at once. Empty where there is none.
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

  // As many chunks as may be in flight, while there are some; false at the end.
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

  // Nothing at the end, or when the time is up.
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

  // How many, from the first on, belong to the first one's block of the map.
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

  // A few rows that a search may narrow, in a long map: there will be as many more as it is worth, and it is made ready
  // while the host proves these.
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

  // What is open.
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

}  // namespace verisq
