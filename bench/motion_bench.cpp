/// Continuous collision: the first contact of two bodies, one of which shifts, beside FCL's, on motions whose first
/// contact is known in closed form.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/path.hpp>

#include "bench/benchmark_rows.hpp"
#include "bench/peer_fcl_continuous.hpp"
#include "bench/row_counters.hpp"
#include "bench/uniform_numbers.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 3;
constexpr std::size_t motion_count = 1000;
constexpr double time_tolerance = 1e-6;
constexpr std::size_t few_samples = 100;
constexpr std::size_t many_samples = 10000;

/// Two ellipsoids of the same shape: r K rests at the origin, s K shifts.
struct ShiftingPair {
  Point shape;  ///< semi-axes of K
  double r, s;
  Point from, to;
  std::optional<double> contact;  ///< true first time in [0, 1]
};

Point scaled_by(const Point& shape, double factor) {
  return {factor * shape[0], factor * shape[1], factor * shape[2]};
}

/// The first root of |D^-1 (from + t way)| = r + s, D being the shape: both bodies become balls.
std::optional<double> closed_form(const ShiftingPair& pair) {
  long double a = 0;
  long double b = 0;
  long double c = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const long double start = static_cast<long double>(pair.from[i]) / pair.shape[i];
    const long double way = (static_cast<long double>(pair.to[i]) - pair.from[i]) / pair.shape[i];
    a += way * way;
    b += start * way;
    c += start * start;
  }
  const long double reach = static_cast<long double>(pair.r) + pair.s;
  if (c <= reach * reach) return 0.0;
  const long double discriminant = b * b - a * (c - reach * reach);
  if (discriminant < 0 || b >= 0) return std::nullopt;
  const long double root = (-b - std::sqrt(discriminant)) / a;
  if (root > 1) return std::nullopt;
  return static_cast<double>(root);
}

std::vector<ShiftingPair> motions(bool balls) {
  UniformNumbers numbers(61);
  std::vector<ShiftingPair> pairs;
  while (pairs.size() < motion_count) {
    ShiftingPair pair{{1.0, 1.0, 1.0}, 0.1 + 0.9 * numbers.fraction(), 0.1 + 0.9 * numbers.fraction(), {}, {}, {}};
    for (std::size_t i = 0; i < 3; ++i) {
      if (!balls) pair.shape[i] = 0.5 + numbers.fraction();
      pair.from[i] = numbers.within(4.0);
      pair.to[i] = numbers.within(4.0);
    }
    pair.contact = closed_form(pair);
    if (pair.contact != 0.0) pairs.push_back(pair);  // motions begin apart
  }
  return pairs;
}

Model ellipsoid(const Point& shape, double factor) {
  return {"", {{"ellipsoid", {scaled_by(shape, factor), {1.0, 1.0}}, {}, {}}}};
}

/// No later than `lo` and no earlier than `hi`, or one time of a peer; nothing: no contact.
struct Answer {
  double lo, hi;
};

using Solver = std::function<std::optional<Answer>(const ShiftingPair&)>;

std::optional<Answer> verified(const ShiftingPair& pair) {
  const std::array<Pose, 2> path{{{.translation = pair.from}, {.translation = pair.to}}};
  const PathDistance found = distance_along(path, ellipsoid(pair.shape, pair.r), ellipsoid(pair.shape, pair.s),
                                            {.tolerance = 1e-6, .time_tolerance = time_tolerance});
  if (!found.meet_at) return std::nullopt;
  return Answer{found.apart_before, *found.meet_at};
}

Solver unverified(std::function<FclContact(const ShiftingPair&)> contact) {
  return [contact = std::move(contact)](const ShiftingPair& pair) -> std::optional<Answer> {
    const FclContact time = contact(pair);
    if (!time) return std::nullopt;
    return Answer{*time, *time};
  };
}

/// A miss is a contact that is denied, a false alarm one that never is.
void set_figures(benchmark::State& state, const std::vector<ShiftingPair>& pairs,
                 const std::vector<std::optional<Answer>>& answers) {
  double contacts = 0.0;
  double misses = 0.0;
  double alarms = 0.0;
  double largest_error = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& truth = pairs[i].contact;
    if (truth) ++contacts;
    if (truth && !answers[i]) ++misses;
    if (!truth && answers[i]) ++alarms;
    if (truth && answers[i])
      largest_error = std::max({largest_error, std::abs(answers[i]->lo - *truth), std::abs(answers[i]->hi - *truth)});
  }
  state.counters["contacts"] = contacts;
  state.counters["misses"] = misses;
  state.counters["false_alarms"] = alarms;
  state.counters["largest_error"] = largest_error;
  set_rate(state, "motions_per_second", pairs.size());
}

void add_motion_row(std::string_view tool, std::string_view object, const std::vector<ShiftingPair>& pairs,
                    const Solver& solve) {
  add_row(tool, "first_contact", object, [&pairs, solve](benchmark::State& state) {
    std::vector<std::optional<Answer>> answers(pairs.size());
    for (auto _ : state) std::ranges::transform(pairs, answers.begin(), solve);
    set_figures(state, pairs, answers);
  });
}

Solver sampled(std::size_t samples) {
  return unverified([samples](const ShiftingPair& pair) {
    return fcl_sampled_contact(scaled_by(pair.shape, pair.r), scaled_by(pair.shape, pair.s), pair.from, pair.to,
                               samples);
  });
}

constexpr std::array<std::string_view, 4> tools{"verisq_host", "fcl_conservative_advancement", "fcl_100_samples",
                                                "fcl_10000_samples"};

std::string table(const Rows& rows) {
  std::string text = fmt::format("\nFirst contacts of {} motions, one core\n{:<44}{:>12}{:>12}{:>10}{:>14}{:>14}\n",
                                 motion_count, "", "us/motion", "contacts", "misses", "false alarms", "largest error");
  for (const std::string_view object : {"balls", "ellipsoids"}) {
    for (const std::string_view tool : tools) {
      const std::string row = row_name(tool, "first_contact", object);
      const auto figure = [&](const char* name) { return counter(rows, row, name); };
      text += fmt::format("{:<44}{:>12.3g}{:>12g}{:>10g}{:>14g}{:>14.3g}\n", row, 1e6 / figure("motions_per_second"),
                          figure("contacts"), figure("misses"), figure("false_alarms"), figure("largest_error"));
    }
  }
  return text;
}

void run(int argc, char** argv) {
  const std::vector<ShiftingPair> balls = motions(true);
  const std::vector<ShiftingPair> ellipsoids = motions(false);
  for (const auto& [object, pairs] : {std::pair("balls", &balls), std::pair("ellipsoids", &ellipsoids)}) {
    add_motion_row(tools[0], object, *pairs, verified);
    add_motion_row(tools[2], object, *pairs, sampled(few_samples));
    add_motion_row(tools[3], object, *pairs, sampled(many_samples));
  }
  add_motion_row(tools[1], "balls", balls, unverified([](const ShiftingPair& pair) {
                   return fcl_advanced_contact(pair.r, pair.s, pair.from, pair.to);
                 }));
  fmt::print("{}", table(run_benchmarks(argc, argv, repetitions)));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("motion_bench", verisq::bench::run, argc, argv);
}
