/// Draws the bar with a carriage return and the terminal's "clear to the end of the line".
#include "host/command_line/progress_bar.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace verisq::command_line {
namespace {

constexpr int bar_cells = 30;
constexpr auto redraw_interval = std::chrono::milliseconds(100);

/// "2:05" or "1:02:05"; "-:--" before there is anything to extrapolate.
std::string clock_text(double seconds) {
  if (!(seconds < 1e7)) return "-:--";
  const auto whole = static_cast<int>(std::ceil(seconds));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

std::string with_prefix(double number) {
  if (number >= 1e9) return fmt::format("{:.3g}G", number / 1e9);
  if (number >= 1e6) return fmt::format("{:.3g}M", number / 1e6);
  if (number >= 1e3) return fmt::format("{:.3g}k", number / 1e3);
  return fmt::format("{:.3g}", number);
}

ProgressBar::ProgressBar(bool wanted, std::string_view elements)
    : shown_(wanted && isatty(STDERR_FILENO) != 0), elements_(elements) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::update(std::uint64_t done, double fraction) {
  if (!due()) return;
  draw(fmt::format("{} {}/s", with_prefix(static_cast<double>(done) / elapsed()), elements_), fraction);
}

void ProgressBar::update_state(std::string_view state, double fraction) {
  if (due()) draw(state, fraction);
}

void ProgressBar::draw(std::string_view state, double fraction) {
  const double part = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<int>(part * bar_cells);
  fmt::print(stderr, "\r\x1b[K[{:=<{}}{: <{}}] {:3.0f} %  {}  ETA {}", "", filled, "", bar_cells - filled, 100.0 * part,
             state, clock_text(elapsed() * (1.0 - part) / part));
  std::fflush(stderr);
  drawn_ = true;
  next_draw_ = Clock::now() + redraw_interval;
}

}  // namespace verisq::command_line
