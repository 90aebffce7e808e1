/// What the caller of a fit hears of it and says to it while it runs.
#pragma once

#include <algorithm>
#include <chrono>

#include "verisq/enclosure.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

class SearchWatch {
 public:
  /// Keeps a reference to the options.
  SearchWatch(const FitOptions& options, std::size_t implants) : options_(options), implants_(implants) {}

  /// Polls the caller until it has said so once, and tells it the progress a few times a second.
  [[nodiscard]] bool interrupted();

  /// From now on an implant is searched, and this share of the work on it is done.
  void at(std::size_t implant, double share);

  /// A pose within the limit has this objective.
  void found(double objective) { best_ = std::max(best_, objective); }

  void count(std::size_t poses) { poses_ += poses; }
  [[nodiscard]] std::uint64_t poses() const { return poses_; }

 private:
  using Clock = std::chrono::steady_clock;

  void report_now_and_then();

  const FitOptions& options_;
  std::size_t implants_;
  std::size_t implant_ = 0;
  double share_ = 0.0;
  double best_ = -infinity;
  bool interrupted_ = false;
  std::uint64_t poses_ = 0;
  Clock::time_point next_report_ = Clock::now();
};

}  // namespace verisq::fit_search
