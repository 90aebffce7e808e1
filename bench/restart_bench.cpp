/// Does any of many random starts of the search find a fit that is better than the proven bound of all, and how many
/// find the best?
///
/// restart_bench [STARTS [PERCENT [POINTS]]]: so many starts (1000), a bound within so many percent of the best (5), of
/// a cavity of so many points about each primitive of the stem (100).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <span>
#include <vector>
#include <verisq/fit.hpp>
#include <verisq/fit_bound.hpp>
#include <verisq/model_file.hpp>

#include "tests/fixtures/offset_cavity.hpp"

namespace verisq::bench {
namespace {

constexpr double play = 0.5;             // mm between the implant and the cavity that is made of it
constexpr double gap = 2.0;              // mm: the default of verisq fit
constexpr std::size_t few_samples = 64;  // poses anywhere in the range, of which the best are refined

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Start {
  double objective;
  bool keeps_limit;
};

std::vector<Start> all_starts(const UncertainModel& implant, const Cavity& cavity, const PoseRange& range,
                              std::size_t starts) {
  std::vector<Start> found;
  for (std::size_t seed = 1; seed <= starts; ++seed) {
    FitOptions options{.fitness = cementless(gap, 0.0), .penetration_limit = 0.0, .range = range};
    options.seed = seed;
    options.samples = few_samples;
    const Fit best = fit({&implant, 1}, cavity, options);
    found.push_back({best.objective, best.within_limit});
  }
  return found;
}

FitBound proven_bound(const UncertainModel& implant, const Cavity& cavity, const PoseRange& range, double known,
                      double percent) {
  return bound_fit({&implant, 1}, cavity,
                   {.fitness = cementless(gap, 0.0),
                    .penetration_limit = 0.0,
                    .range = range,
                    .known = known,
                    .gap = percent / 100.0});
}

/// 0 where no start is above the bound.
int run(std::size_t starts, double percent, std::size_t points) {
  const Model stem = read_model(VERISQ_STEM);
  const UncertainModel implant = stem;
  const Cavity cavity = testing::offset_cavity(stem, play, points);
  const PoseRange range{{}, 15.0, 15.0};

  const Clock::time_point begin = Clock::now();
  std::vector<Start> found = all_starts(implant, cavity, range, starts);
  const double search_seconds = seconds_since(begin);
  const auto beyond_limit = std::erase_if(found, [](const Start& start) { return !start.keeps_limit; });
  if (found.empty()) {
    fmt::print("none of {} starts ended within the limit\n", starts);
    return 1;
  }
  const auto [worst, best] = std::ranges::minmax(found, {}, &Start::objective);
  const auto near_best = std::ranges::count_if(
      found, [largest = best.objective](const Start& start) { return start.objective >= largest * (1.0 - 1e-6); });

  const Clock::time_point second_begin = Clock::now();
  const FitBound bound = proven_bound(implant, cavity, range, best.objective, percent);
  const auto above =
      std::ranges::count_if(found, [upper = bound.upper](const Start& start) { return start.objective > upper; });
  fmt::print("{:<34} {}\n", "points of the cavity", cavity.points.size());
  fmt::print("{:<34} {}, {} of them beyond the limit\n", "random starts", starts, beyond_limit);
  fmt::print("{:<34} {:.9g} to {:.9g}\n", "F that they found", worst.objective, best.objective);
  fmt::print("{:<34} {}\n", "within 1e-6 of the best", near_best);
  fmt::print("{:<34} {:.9g}, {:.3g} % above the best ({} boxes)\n", "proven bound of F", bound.upper,
             100.0 * (bound.upper / best.objective - 1.0), bound.boxes);
  fmt::print("{:<34} {}\n", "starts above the bound", above);
  fmt::print("{:<34} {:.3g} s, bound {:.3g} s\n", "searches", search_seconds, seconds_since(second_begin));
  return above == 0 ? 0 : 1;
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  const std::span arguments(argv, static_cast<std::size_t>(argc));
  const auto number = [&](std::size_t k, double otherwise) {
    return arguments.size() > k ? std::strtod(arguments[k], nullptr) : otherwise;
  };
  return verisq::bench::run(static_cast<std::size_t>(number(1, 1000)), number(2, 5.0),
                            static_cast<std::size_t>(number(3, 100)));
}
