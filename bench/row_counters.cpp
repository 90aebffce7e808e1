/// Counters of one row, from all enclosures and answers of its queries.
#include "bench/row_counters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace verisq::bench {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// 0 for [0, 0], which is exact.
double relative_width(const Enclosure& e) {
  return e.width() == 0.0 ? 0.0 : e.width() / std::abs(0.5 * (e.lo + e.hi));
}

}  // namespace

std::string row_name(std::string_view tool, std::string_view what, std::string_view object) {
  return fmt::format("{}/{}/{}", tool, what, object);
}

void add_row(std::string_view tool, std::string_view what, std::string_view object,
             const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(row_name(tool, what, object).c_str(), run)->UseRealTime()->Unit(benchmark::kMillisecond);
}

benchmark::Counter per_second(double amount) {
  return {amount, benchmark::Counter::kIsIterationInvariantRate};
}

void set_rate(benchmark::State& state, const char* name, std::size_t queries) {
  state.counters[name] = per_second(static_cast<double>(queries));
}

void set_widths(benchmark::State& state, std::span<const Enclosure> enclosures, double tolerance) {
  std::vector<double> widths;
  std::vector<double> relative_widths;
  for (const Enclosure& e : enclosures) {
    widths.push_back(e.width());
    relative_widths.push_back(relative_width(e));
  }
  const auto narrow = std::ranges::count_if(enclosures, [=](const Enclosure& e) { return verified(e, tolerance); });
  state.counters["width_median"] = median(widths);
  state.counters["width_mean"] = mean(widths);
  state.counters["width_largest"] = std::ranges::max(widths);
  state.counters["relative_width_median"] = median(relative_widths);
  state.counters["relative_width_mean"] = mean(relative_widths);
  state.counters["verified_fraction"] = static_cast<double>(narrow) / static_cast<double>(enclosures.size());
}

void set_errors(benchmark::State& state, std::span<const double> answers, std::span<const Enclosure> enclosures) {
  double above = 0.0;
  double below = 0.0;
  double largest_above = 0.0;
  double largest_below = 0.0;
  for (std::size_t i = 0; i < enclosures.size(); ++i) {
    above += answers[i] > enclosures[i].hi ? 1.0 : 0.0;
    below += answers[i] < enclosures[i].lo ? 1.0 : 0.0;
    largest_above = std::max(largest_above, answers[i] - enclosures[i].hi);
    largest_below = std::max(largest_below, enclosures[i].lo - answers[i]);
  }
  const auto count = static_cast<double>(enclosures.size());
  state.counters["outside_enclosure"] = (above + below) / count;
  state.counters["errs_upwards"] = above / count;
  state.counters["errs_downwards"] = below / count;
  state.counters["largest_error_upwards"] = largest_above;
  state.counters["largest_error_downwards"] = largest_below;
}

}  // namespace verisq::bench
