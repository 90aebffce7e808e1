/// What rows of several benchmarks report: rates, widths of enclosures, errors of peers.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <verisq/enclosure.hpp>

namespace verisq::bench {

/// "tool/what/object", the name of a row.
[[nodiscard]] std::string row_name(std::string_view tool, std::string_view what, std::string_view object);

/// Registers a row timed by the clock: work that runs on other threads or devices is no processor time of ours.
void add_row(std::string_view tool, std::string_view what, std::string_view object,
             const std::function<void(benchmark::State&)>& run);

/// `amount` a second, where each iteration does that amount.
[[nodiscard]] benchmark::Counter per_second(double amount);

/// The counter `name`: so many queries a second, where each iteration answers `queries`.
void set_rate(benchmark::State& state, const char* name, std::size_t queries);

/// width_…, relative_width_… (width / midpoint) and the share that is at most `tolerance` wide.
void set_widths(benchmark::State& state, std::span<const Enclosure> enclosures, double tolerance);

/// How a peer's answers lie to the enclosures of the same queries: what is outside one is certainly wrong.
/// Precondition: an answer for each enclosure, in the same order.
void set_errors(benchmark::State& state, std::span<const double> answers, std::span<const Enclosure> enclosures);

}  // namespace verisq::bench
