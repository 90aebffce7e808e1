/// A thread that works off what others leave it, in order, while they go on.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <thread>
#include <utility>

#include "host/threads/bounded_queue.hpp"
#include "host/threads/spare_items.hpp"

namespace verisq {

template <class Item>
class WorkBehind {
 public:
  explicit WorkBehind(std::function<void(Item&)> work) : thread_([this, work = std::move(work)] { run(work); }) {}
  ~WorkBehind() { queue_.close(); }
  WorkBehind(const WorkBehind&) = delete;
  WorkBehind& operator=(const WorkBehind&) = delete;

  /// An item that was worked off, to be filled again; a new one where there is none.
  [[nodiscard]] Item spare() { return spare_.take(); }

  /// Waits while much is left to be done. Throws what the work on an earlier item threw; then nothing more is done.
  void add(Item item) {
    if (!queue_.push(std::move(item))) finish();
  }

  /// Returns when all is done; throws likewise. Nothing may be added afterwards.
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
