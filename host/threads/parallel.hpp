/// Independent work on all processors, in one go or in steps that an interruption ends.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace verisq {

// Independent work on all processors, as the map's host proofs and the check of a map share it.

/// Calls work(i) once for each i below `count`, in any order, and returns when all are done. After an exception no
/// further call begins; the first exception is passed on. While the calling thread has nothing left to do but to wait
/// for the others, it calls watch() some fifty times a second.
template <typename Work, typename Watch>
void in_parallel(std::size_t count, const Work& work, const Watch& watch) {
  constexpr std::chrono::milliseconds between_watches{20};
  const std::size_t workers = std::min<std::size_t>(count, std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  std::condition_variable all_ended;
  std::size_t at_work = workers == 0 ? 0 : workers - 1;  // beside the calling thread
  const auto loop = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 1; i < workers; ++i) {
      threads.emplace_back([&] {
        loop();
        const std::lock_guard lock(mutex);
        if (--at_work == 0) all_ended.notify_one();
      });
    }
    loop();
    std::unique_lock lock(mutex);
    while (!all_ended.wait_for(lock, between_watches, [&] { return at_work == 0; })) {
      lock.unlock();
      watch();
      lock.lock();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

template <typename Work>
void in_parallel(std::size_t count, const Work& work) {
  in_parallel(count, work, [] {});
}

// A range of items cut into pieces, one for each processor.

struct Piece {
  std::size_t first;
  std::size_t count;
};

/// About equal pieces of `count` items, front to back; fewer than processors where they would be below `smallest`.
[[nodiscard]] inline std::vector<Piece> pieces_of(std::size_t count, std::size_t smallest) {
  const std::size_t most = std::max<std::size_t>(1, count / smallest);
  const std::size_t pieces = std::min<std::size_t>(most, std::max(1U, std::thread::hardware_concurrency()));
  std::vector<Piece> result;
  for (std::size_t k = 0; k < pieces; ++k) {
    const std::size_t first = count * k / pieces;
    result.push_back({first, count * (k + 1) / pieces - first});
  }
  return result;
}

// An interruption for which only the calling thread polls, and which all threads see.

/// `asked` is called by one thread only: the one that made this, or that called `begin_anew` last.
class SeenInterruption {
 public:
  /// Empty: never interrupted.
  explicit SeenInterruption(std::function<bool()> asked) : asked_(std::move(asked)) {}

  /// Once true it stays so.
  [[nodiscard]] bool operator()() const {
    if (!seen_ && asked_ && std::this_thread::get_id() == owner_ && asked_()) seen_ = true;
    return seen_;
  }

  /// Prepares for the next work, of this thread. Precondition: no other thread uses this.
  void begin_anew() {
    owner_ = std::this_thread::get_id();
    seen_ = false;
  }

 private:
  std::function<bool()> asked_;
  std::thread::id owner_ = std::this_thread::get_id();
  mutable std::atomic<bool> seen_{false};
};

// Independent work on all processors that ends early once interrupted; in steps, between which progress is reported.

/// Calls work(i) for each i below `count`, in any order, by several threads. Once interrupted() returns true, no
/// further call begins. Returns how many are done, from the front: those before the first that is not done, or that the
/// interruption may have cut short. The calling thread polls while it waits, too.
template <class Interrupted, class Work>
std::size_t in_parallel_until(const Interrupted& interrupted, std::size_t count, const Work& work) {
  std::atomic<std::size_t> done{count};
  const auto not_done = [&done](std::size_t i) {
    std::size_t before = done;
    while (i < before && !done.compare_exchange_weak(before, i)) {
    }
  };
  const auto one = [&](std::size_t i) {
    if (!interrupted()) work(i);
    if (interrupted()) not_done(i);
  };
  in_parallel(count, one, [&] { static_cast<void>(interrupted()); });
  return done;
}

/// Calls work(i) once for each i below `count`, `step` of them at a time and in any order. After each step calls
/// progress(share of all that is done). Once interrupted, no further call begins. Returns how many are done: those of
/// all whole steps.
template <class Work, class Progress>
std::size_t in_parallel_steps(std::size_t count, std::size_t step, const SeenInterruption& interrupted,
                              const Progress& progress, const Work& work) {
  std::size_t done = 0;
  while (done < count) {
    const std::size_t now = std::min(step, count - done);
    if (in_parallel_until(interrupted, now, [&](std::size_t i) { work(done + i); }) < now) break;
    done += now;
    progress(static_cast<double>(done) / static_cast<double>(count));
  }
  return done;
}

}  // namespace verisq
