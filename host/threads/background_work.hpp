/// Threads beside the caller's: they read ahead, process queued work, or are given up.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

namespace verisq {

// Runs work that nothing can stop, such as a driver's compilation of kernels, in a thread of its own. So a waiting
// thread can leave within a second.

/// The threads whose work was given up: they go on. At its end the process waits for them, or leaves at once.
class GivenUpThreads {
 public:
  /// Made when the first thread is given up. So it is destroyed before all objects that were made earlier, such as most
  /// of the driver.
  static GivenUpThreads& all() {
    static GivenUpThreads threads;
    [[maybe_unused]] static const int registered = on_exit(leave, nullptr);
    return threads;
  }

  void keep(std::thread thread) {
    const std::lock_guard lock(mutex_);
    threads_.push_back(std::move(thread));
    some_ = true;
  }

  /// If there are such threads, ends the process at once. For programs that have nothing left to do and to write.
  static void leave_unless_none(int status) {
    if (some_) std::_Exit(status);
  }

  /// The same at `exit`, for programs whose `main` is not ours.
  static void leave_at_exit() { leaves_at_exit_ = true; }

  GivenUpThreads(const GivenUpThreads&) = delete;
  GivenUpThreads& operator=(const GivenUpThreads&) = delete;

 private:
  GivenUpThreads() = default;
  ~GivenUpThreads() {
    for (std::thread& thread : threads_) {
      // A driver may call `exit` in such a thread.
      thread.get_id() == std::this_thread::get_id() ? thread.detach() : thread.join();
    }
  }

  static void leave(int status, void* /*nothing*/) {
    if (leaves_at_exit_) leave_unless_none(status);
  }

  // A handler of exits has no other way to them.
  // NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): for that reason
  static inline std::atomic<bool> some_{false};
  // NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): likewise
  static inline std::atomic<bool> leaves_at_exit_{false};

  std::mutex mutex_;
  std::vector<std::thread> threads_;
};

template <class Result>
class WorkThatMayBeGivenUp {
 public:
  /// Begins `work`, which must own all that it uses: it may outlive this.
  explicit WorkThatMayBeGivenUp(std::function<Result()> work) {
    std::packaged_task<Result()> task(std::move(work));
    result_ = task.get_future();
    thread_ = std::thread(std::move(task));
  }
  ~WorkThatMayBeGivenUp() {
    if (!thread_.joinable()) return;
    is_done(std::chrono::milliseconds(0)) ? thread_.join() : GivenUpThreads::all().keep(std::move(thread_));
  }
  WorkThatMayBeGivenUp(const WorkThatMayBeGivenUp&) = delete;
  WorkThatMayBeGivenUp& operator=(const WorkThatMayBeGivenUp&) = delete;

  /// Waits for the result, which it returns once; nothing once `ended`, which may be empty, returns true. It calls
  /// `ended` after half a second, then five times a second. Throws the exceptions of the work and of `ended`.
  [[nodiscard]] std::optional<Result> result(const std::function<bool()>& ended) {
    for (std::chrono::milliseconds pause(500); !is_done(pause); pause = std::chrono::milliseconds(200)) {
      if (ended && ended()) return std::nullopt;
    }
    thread_.join();
    return result_.get();
  }

 private:
  [[nodiscard]] bool is_done(std::chrono::milliseconds pause) const {
    return result_.wait_for(pause) == std::future_status::ready;
  }

  std::future<Result> result_;
  std::thread thread_;
};

// Passes items from one thread to another, in order, a few items at most under way.

/// Any number of threads may use it at once.
template <class Item>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room; false, and the item is gone, where the queue is closed.
  bool push(Item item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || items_.size() < capacity_; });
    if (closed_) return false;
    items_.push_back(std::move(item));
    changed_.notify_all();
    return true;
  }

  /// Waits for an item; nothing where the queue is closed and empty.
  std::optional<Item> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<Item> item(std::move(items_.front()));
    items_.pop_front();
    changed_.notify_all();
    return item;
  }

  /// Waiting threads continue; the items in the queue can still be popped.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  bool closed_ = false;
};

// Used items, kept for their memory: an item that is filled again needs no new pages.

/// Any number of threads may use it at once.
template <class Item>
class SpareItems {
 public:
  /// Keeps at most `most` items.
  explicit SpareItems(std::size_t most) : most_(most) {}

  /// An item that was given back, unchanged; a new one if there is none.
  [[nodiscard]] Item take() {
    const std::lock_guard lock(mutex_);
    if (items_.empty()) return {};
    Item item(std::move(items_.back()));  // the last one: a cache may still hold it
    items_.pop_back();
    return item;
  }

  void give_back(Item item) {
    const std::lock_guard lock(mutex_);
    if (items_.size() < most_) items_.push_back(std::move(item));
  }

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::vector<Item> items_;
};

// A thread that reads while others process the elements read before.

/// `Stream` has
///   read(std::span<Element>): fills it from the front; returns how many, fewer than requested only at the end;
///   fraction(done): about the share of all elements that `done` finished ones are; called for all elements read.
/// It must outlive this, and nobody else may use it meanwhile. The destructor waits for a `read` under way.
template <class Stream>
class ReadAhead {
 public:
  using Element = typename Stream::Element;

  explicit ReadAhead(Stream& stream) : thread_([this, &stream] { run(stream); }) {}
  ~ReadAhead() { queue_.close(); }
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// Like `read` of the stream; throws its exceptions, after all elements that were read before.
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

  /// Like `fraction` of the stream, from its value when the last chunk was read.
  [[nodiscard]] double fraction(std::uint64_t done) const {
    if (chunk_.read == 0) return 0.0;
    return std::min(1.0, chunk_.fraction * (static_cast<double>(done) / static_cast<double>(chunk_.read)));
  }

 private:
  struct Chunk {
    std::vector<Element> elements;
    std::uint64_t read = 0;  ///< number of elements, with all before them
    double fraction = 0.0;   ///< their share of all elements
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

// A thread that processes the items that others queue, in order, while they go on.

template <class Item>
class WorkBehind {
 public:
  explicit WorkBehind(std::function<void(Item&)> work) : thread_([this, work = std::move(work)] { run(work); }) {}
  ~WorkBehind() { queue_.close(); }
  WorkBehind(const WorkBehind&) = delete;
  WorkBehind& operator=(const WorkBehind&) = delete;

  /// An item that was worked off, to be filled again; a new one where there is none.
  [[nodiscard]] Item spare() { return spare_.take(); }

  /// Waits while much is left to be done. Throws the exception of an earlier item's work; then nothing more is done.
  void add(Item item) {
    if (!queue_.push(std::move(item))) finish();
  }

  /// Returns when all is done; throws the same exception. Nothing may be added afterwards.
  void finish() {
    queue_.close();
    if (thread_.joinable()) thread_.join();
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  static constexpr std::size_t most_waiting = 4;

  void run(const std::function<void(Item&)>& work) {
    try {
      while (std::optional<Item> item = queue_.pop()) {
        work(*item);
        spare_.give_back(std::move(*item));
      }
    } catch (...) {
      failure_ = std::current_exception();
      queue_.close();
    }
  }

  BoundedQueue<Item> queue_{most_waiting};
  SpareItems<Item> spare_{most_waiting};
  std::exception_ptr failure_;  // read when the thread has ended
  std::jthread thread_;         // ends before what it uses
};

}  // namespace verisq
