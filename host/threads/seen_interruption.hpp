/// An interruption that the calling thread alone asks about, and all threads see.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace verisq {

/// Who gives `asked` may count on its being called by one thread: that which makes this.
class SeenInterruption {
 public:
  /// `asked` must outlive this.
  explicit SeenInterruption(const std::function<bool()>& asked) : asked_(asked) {}

  [[nodiscard]] bool operator()() const {
    if (!seen_ && std::this_thread::get_id() == owner_ && asked_()) seen_ = true;
    return seen_;
  }

 private:
  const std::function<bool()>& asked_;
  std::thread::id owner_ = std::this_thread::get_id();
  mutable std::atomic<bool> seen_{false};
};

}  // namespace verisq
