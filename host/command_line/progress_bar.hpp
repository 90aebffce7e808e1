/// A bar with rate and remaining time on a terminal's standard error; nothing at all elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace verisq::command_line {

/// "13.2M", "850k", "12": three significant digits with an SI prefix.
[[nodiscard]] std::string with_prefix(double number);

/// Redraws one line at most ten times a second; the destructor clears it.
class ProgressBar {
 public:
  /// Of `elements`, in the plural, which must be a literal. `wanted` false, or a standard error that is no terminal,
  /// makes every call do nothing.
  ProgressBar(bool wanted, std::string_view elements);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done` elements so far; `fraction` of the whole in [0, 1].
  void update(std::uint64_t done, double fraction);
  /// Shows `state` in place of a rate.
  void update_state(std::string_view state, double fraction);

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool due() const { return shown_ && Clock::now() >= next_draw_; }
  [[nodiscard]] double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  void draw(std::string_view state, double fraction);

  bool shown_;
  std::string_view elements_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_draw_ = start_;
};

}  // namespace verisq::command_line
