/// --time-limit: how long a search may work.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace verisq::command_line {

/// Seconds. Throws Error(input) that begins with `option` unless it is a finite number above 0.
[[nodiscard]] double parse_time_limit(std::string_view option, const std::string& text);

/// Counts wall time from `start` on.
class TimeLimit {
 public:
  /// Nothing: no limit.
  explicit TimeLimit(std::optional<double> seconds) : seconds_(seconds) {}

  [[nodiscard]] bool given() const { return seconds_.has_value(); }

  /// What is prepared before does not count.
  void start() { start_ = Clock::now(); }

  /// Never before `start`. May be asked by many threads.
  [[nodiscard]] bool passed() const {
    return seconds_ && start_ && std::chrono::duration<double>(Clock::now() - *start_).count() >= *seconds_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<double> seconds_;
  std::optional<Clock::time_point> start_;
};

}  // namespace verisq::command_line
