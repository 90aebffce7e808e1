/// Work without Python's lock, which Ctrl-C ends.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <functional>
#include <optional>

namespace verisq::python {

/// Asks Python now and then whether a signal's handler raised something, KeyboardInterrupt for Ctrl-C. Python runs
/// handlers in its main thread alone: elsewhere nothing is ever seen.
class Interruption {
 public:
  Interruption() = default;
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;
  ~Interruption() = default;

  /// For the library's options: polled by the thread that works, which must not hold Python's lock. True once a handler
  /// raised. This must outlive it.
  [[nodiscard]] std::function<bool()> poll() {
    return [this] { return raised(); };
  }

  /// Forgets what was raised: before each of several calls.
  void reset() { raised_.reset(); }

  /// Raises in Python what a handler raised. Precondition: Python's lock is held.
  void rethrow() const {
    if (raised_) throw pybind11::error_already_set(*raised_);
  }

 private:
  /// To take Python's lock costs what another thread makes of its turn: not at every poll.
  [[nodiscard]] bool raised() {
    constexpr std::chrono::milliseconds between{50};
    if (raised_) return true;
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < between) return false;
    asked_ = now;
    const pybind11::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) raised_.emplace();  // takes over what is raised
    return raised_.has_value();
  }

  std::chrono::steady_clock::time_point asked_{};
  std::optional<pybind11::error_already_set> raised_;
};

/// What `work` returns, done without Python's lock; raises what a handler raised meanwhile. Precondition: the lock is
/// held, `work` touches nothing of Python but by polls of `interruption`.
template <class Work>
auto without_lock(const Interruption& interruption, const Work& work) {
  auto result = [&] {
    const pybind11::gil_scoped_release released;
    return work();
  }();
  interruption.rethrow();
  return result;
}

}  // namespace verisq::python
