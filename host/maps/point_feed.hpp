/// Where the chunks of a map of points come from, and where their rows go.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "host/maps/map_copies.hpp"
#include "verisq/columns.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// Some points and the memory of their rows.
struct PointChunk {
  PointColumns points;
  ResultColumns rows;
};

/// All of them in the caller's memory: nothing is copied.
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

  /// To be called with the rows of each chunk, in order, when they are there.
  void deliver(const PointChunk& /*chunk*/, std::size_t /*first*/, std::size_t /*count*/) {}

  /// What `next` has not returned yet.
  [[nodiscard]] Source<Point> rest() const { return source_of<Point>(points_, next_); }
  [[nodiscard]] Sink<Point> sink() const { return sink_of<Point>(rows_, next_); }

 private:
  PointColumns points_;
  ResultColumns rows_;
  std::size_t next_ = 0;
};

/// Memory of one chunk.
struct ChunkMemory {
  std::vector<Point> points;
  std::vector<MapResult> rows;
};

/// From a source, to a sink, through the memory of a few chunks: when all are filled, the next waits until the first is
/// delivered.
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

}  // namespace verisq
