/// A thread that reads while others work on what was read before.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "host/threads/bounded_queue.hpp"
#include "host/threads/spare_items.hpp"

namespace verisq {

/// `Stream` has
///   read(std::span<Element>): fills it from the front; returns how many, fewer than asked only at the end;
///   fraction(done): the part of all elements that `done` finished ones make up, about; asked for all that were read.
/// It must outlive this, and nobody else may use it meanwhile. The destructor waits for a `read` under way.
template <class Stream>
class ReadAhead {
 public:
  using Element = typename Stream::Element;

  explicit ReadAhead(Stream& stream) : thread_([this, &stream] { run(stream); }) {}
  ~ReadAhead() { queue_.close(); }
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// As that of the stream; throws what that threw, after all elements that were read before.
  std::size_t read(std::span<Element> elements) {
    std::size_t count = 0;
    while (count < elements.size()) {
      if (next_ == chunk_.elements.size() && !take_chunk()) break;
      const std::size_t part = std::min(elements.size() - count, chunk_.elements.size() - next_);
      std::copy_n(chunk_.elements.begin() + static_cast<std::ptrdiff_t>(next_), part,
                  elements.begin() + static_cast<std::ptrdiff_t>(count));
      next_ += part;
      count += part;
    }
    return count;
  }

  /// As that of the stream, from what it told when the last chunk was read.
  [[nodiscard]] double fraction(std::uint64_t done) const {
    if (chunk_.read == 0) return 0.0;
    return std::min(1.0, chunk_.fraction * (static_cast<double>(done) / static_cast<double>(chunk_.read)));
  }

 private:
  struct Chunk {
    std::vector<Element> elements;
    std::uint64_t read = 0;  ///< with all before it
    double fraction = 0.0;   ///< that these are
    std::exception_ptr failure;
  };

  static constexpr std::size_t chunk_size = std::size_t{1} << 15U;
  static constexpr std::size_t most_waiting = 4;

  void run(Stream& stream) {
    std::uint64_t read = 0;
    for (bool more = true; more;) {
      Chunk chunk = spare_.take();
      try {
        chunk.elements.resize(chunk_size);
        const std::size_t count = stream.read(chunk.elements);
        chunk.elements.resize(count);
        read += count;
        chunk.read = read;
        chunk.fraction = stream.fraction(read);
        more = count == chunk_size;
      } catch (...) {
        chunk.elements.clear();
        chunk.failure = std::current_exception();
        more = false;
      }
      if (!queue_.push(std::move(chunk))) return;
    }
    queue_.close();
  }

  /// False at the end.
  bool take_chunk() {
    std::optional<Chunk> chunk = queue_.pop();
    if (!chunk) return false;
    if (chunk->failure) std::rethrow_exception(chunk->failure);
    spare_.give_back(std::exchange(chunk_, std::move(*chunk)));
    next_ = 0;
    return !chunk_.elements.empty();
  }

  BoundedQueue<Chunk> queue_{most_waiting};
  SpareItems<Chunk> spare_{most_waiting};
  Chunk chunk_;           // the one that `read` hands on,
  std::size_t next_ = 0;  // from here
  std::jthread thread_;   // ends before what it uses
};

}  // namespace verisq
