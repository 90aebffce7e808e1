/// Wall time since a moment.
#pragma once

#include <chrono>

namespace verisq::command_line {

/// Starts when it is made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point start_ = Clock::now();
};

}  // namespace verisq::command_line
