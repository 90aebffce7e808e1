/// Works through the parts of a certificate, so that it can be watched and interrupted.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "verisq/checker.hpp"

namespace verisq::verify {

class CheckSteps {
 public:
  /// `all` is the number of all parts. The options must outlive this.
  CheckSteps(std::size_t all, const CheckOptions& options) : all_(all), options_(&options) {}

  /// Calls work(i) for each i below `count`, or for fewer once interrupted.
  template <class Work>
  void each(std::size_t count, const Work& work) {
    constexpr std::size_t at_a_time = 64;  // between which progress is told
    for (std::size_t first = 0; first < count && !options_->interrupted(); first += at_a_time) {
      const std::size_t now = std::min(at_a_time, count - first);
      options_->in_parallel(now, [&](std::size_t i) {
        if (!options_->interrupted()) work(first + i);
      });
      done_ += now;
      options_->progress(static_cast<double>(done_) / static_cast<double>(all_));
    }
  }

  /// A hook for long work within a part.
  [[nodiscard]] const std::function<bool()>& interrupted() const { return options_->interrupted; }

 private:
  std::size_t all_;
  std::size_t done_ = 0;
  const CheckOptions* options_;
};

}  // namespace verisq::verify
