/// Work without Python's lock, which Ctrl-C ends.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <thread>

namespace verisq::python {

/// Asks Python now and then whether a signal's handler raised something, KeyboardInterrupt for Ctrl-C. Python runs
/// handlers in its main thread alone: queries of other threads never see any.
class Interruption {
 public:
  Interruption() = default;
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;
  ~Interruption() = default;

  /// For the library's options: true once a handler raised. Only the thread that made this asks Python, whose lock it
  /// must not hold then; threads that work for it are told. This must outlive it.
  [[nodiscard]] std::function<bool()> poll() {
    return [this] { return raised(); };
  }

  /// As made anew, by this thread. Precondition: nobody polls.
  void reset() {
    owner_ = std::this_thread::get_id();
    stop_ = false;
    exception_.reset();
  }

  /// Raises in Python what a handler raised. Precondition: Python's lock is held.
  void rethrow() const {
    if (exception_) throw pybind11::error_already_set(*exception_);
  }

 private:
  /// To take Python's lock costs what another thread makes of its turn: not at every poll.
  [[nodiscard]] bool raised() {
    constexpr std::chrono::milliseconds between{50};
    if (stop_ || std::this_thread::get_id() != owner_) return stop_;
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < between) return false;
    asked_ = now;
    const pybind11::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() == 0) return false;
    exception_.emplace();  // takes over what is raised
    stop_ = true;
    return true;
  }

  std::thread::id owner_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point asked_{};
  std::optional<pybind11::error_already_set> exception_;
  std::atomic<bool> stop_ = false;
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
