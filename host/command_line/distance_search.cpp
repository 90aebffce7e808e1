/// Runs the search; the bar shows how many of the halvings of the width are done.
#include "host/command_line/distance_search.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>
#include <verisq/model_search.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/time_limit.hpp"

namespace verisq::command_line {
namespace {

/// From 0 at the first width to 1 at the tolerance, in the logarithm of the width: it falls by about the same factor
/// from level to level.
class WidthFraction {
 public:
  explicit WidthFraction(double tolerance) : tolerance_(tolerance) {}

  [[nodiscard]] double operator()(double width) {
    if (!std::isfinite(width)) return 0.0;
    if (!(first_ > 0.0)) first_ = width;
    return std::log(first_ / width) / std::log(first_ / tolerance_);
  }

 private:
  double tolerance_;
  double first_ = 0.0;
};

void tell_what_is_not_certified(const DistanceReport& report) {
  const Enclosure& proven = *report.certified;
  if (verified(proven, report.tolerance) || proven.width() <= report.distance.width()) return;
  tell(fmt::format(
      "the certificate proves less than was found, [{}, {}]: {}", proven.lo, proven.hi,
      interrupted() ? "interrupted"
                    : "planes between sections of primitives, balls and covers about these, and points do not decide"));
}

}  // namespace

DistanceReport searched_distance(const Model& a, const Model& b, const Pose& pose, const DistanceSearch& search) {
  watch_for_interruption();
  TimeLimit limit(search.seconds);
  limit.start();
  const ModelSearch models(a, b);
  SearchOptions options{.tolerance = search.tolerance, .interrupted = [&] { return interrupted() || limit.passed(); }};
  SearchedDistance found{};
  {
    ProgressBar bar(search.show_progress, "cubes");
    WidthFraction fraction(search.tolerance);
    options.progress = [&](const Enclosure& e, std::uint64_t cubes) { bar.update(cubes, fraction(e.width())); };
    found = models(pose, options);
  }
  if (!verified(found.distance, search.tolerance) && !(search.tolerance == 0.0 && found.reached)) {
    const char* const reason = interrupted()    ? "interrupted"
                               : limit.passed() ? "the time limit is reached"
                                                : "the search has reached rounding errors or its budget of cubes";
    tell(fmt::format("{}; the enclosure is valid, and wide", reason));
  }
  DistanceReport report{found.distance, found.proximity};
  report.tolerance = search.tolerance;
  report.searched = true;
  report.interrupted = interrupted() && !found.reached;
  report.tightest = search.tolerance == 0.0 && found.reached;
  report.near_points = found.near_points;
  report.common = found.common;
  if (search.with_certificate) {
    options.interrupted = [] { return interrupted(); };  // what was found in time deserves its certificate
    auto [proven, certificate] = models.certified(pose, found, options);
    report.certified = proven;
    report.certificate = std::move(certificate);
    tell_what_is_not_certified(report);
  }
  return report;
}

}  // namespace verisq::command_line
