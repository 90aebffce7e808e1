/// Does any of many random starts of the search find a fit that is better than the proven bound of all, and how many
/// find the best?
///
/// restart_bench [STARTS [PERCENT [POINTS]]]: so many starts (1000), a bound within so many percent of the best (5), of
/// a cavity of so many points about each primitive of the stem (100).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <numbers>
#include <span>
#include <string>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/fit.hpp>

#include "bench/random_starts.hpp"
#include "bench/uniform_numbers.hpp"
#include "tests/fixtures/offset_cavity.hpp"

namespace verisq::bench {
namespace {

constexpr double play = 0.5;             // mm between the implant and the cavity that is made of it
constexpr double gap = 2.0;              // mm: the default of verisq fit
constexpr std::size_t few_samples = 32;  // poses anywhere in the range of a start, of which the best are refined

/// Of a start, and of its search about it, along each axis.
constexpr double reach = 7.5;          // mm
constexpr double reach_degrees = 4.3;  // of a rotation vector
/// No search leaves this range about where the points came from: translations add up, and the angle of two rotations is
/// at most the sum of theirs, of vectors no longer than sqrt(3) times their largest part.
constexpr double whole_reach = 2.0 * reach;
constexpr double whole_reach_degrees = 2.0 * std::numbers::sqrt3 * reach_degrees;

constexpr double longest_bound = 600.0;  // seconds: what is proven by then counts

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Start {
  double objective;
  bool keeps_limit;
};

std::vector<Start> all_starts(const Model& stem, const Cavity& cavity, std::size_t starts, const std::string& device) {
  const UncertainModel implant = stem;
  const Eigen::Vector3d centre = centre_of(stem);
  UniformNumbers uniform(20'110'505);
  std::vector<Start> found;
  for (std::size_t seed = 1; seed <= starts; ++seed) {
    FitOptions options{.fitness = cementless(gap, 0.0),
                       .penetration_limit = 0.0,
                       .range = {moved_off(centre, reach, reach_degrees, uniform), reach, reach_degrees}};
    options.seed = seed;
    options.samples = few_samples;
    options.device = device;
    const Fit best = fit({&implant, 1}, cavity, options);
    found.push_back({best.objective, best.within_limit});
    if (seed % 100 == 0) fmt::print(stderr, "{} starts\n", seed);
  }
  return found;
}

FitBound proven_bound(const Model& stem, const Cavity& cavity, double known, double percent) {
  const UncertainModel implant = stem;
  return bound_fit({&implant, 1}, cavity,
                   {.fitness = cementless(gap, 0.0),
                    .penetration_limit = 0.0,
                    .range = {{}, whole_reach, whole_reach_degrees},
                    .known = known,
                    .gap = percent / 100.0,
                    .out_of_time = [begin = Clock::now()] { return seconds_since(begin) > longest_bound; }});
}

/// 0 where no start is above the bound.
int run(std::size_t starts, double percent, std::size_t points, const std::string& device) {
  const Model stem = read_model(VERISQ_STEM);
  const Cavity cavity = testing::offset_cavity(stem, play, points);

  const Clock::time_point begin = Clock::now();
  std::vector<Start> found = all_starts(stem, cavity, starts, device);
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
  const FitBound bound = proven_bound(stem, cavity, best.objective, percent);
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
  std::vector<std::string> arguments;
  for (const std::string argument : std::span(argv, static_cast<std::size_t>(argc)).subspan(1))
    if (!argument.starts_with('-')) arguments.push_back(argument);  // what is meant for other benchmarks
  const auto number = [&](std::size_t k, double otherwise) {
    return arguments.size() > k ? std::strtod(arguments[k].c_str(), nullptr) : otherwise;
  };
  return verisq::bench::run(static_cast<std::size_t>(number(0, 1000)), number(1, 5.0),
                            static_cast<std::size_t>(number(2, 600)), arguments.size() > 3 ? arguments[3] : "auto");
}
