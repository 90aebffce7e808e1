/// --time-limit: how long a search may work.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host/command_line/stopwatch.hpp"

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
  void start() { watch_.emplace(); }

  /// Never before `start`. May be asked by many threads.
  [[nodiscard]] bool passed() const { return seconds_ && watch_ && watch_->seconds() >= *seconds_; }

 private:
  std::optional<double> seconds_;
  std::optional<Stopwatch> watch_;
};

}  // namespace verisq::command_line
