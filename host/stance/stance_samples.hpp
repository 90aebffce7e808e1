/// Monte-Carlo samples of uncertain parameters: whether enclosures contain them, and how much of each they fill.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/stance_analysis.hpp>

namespace verisq::stance {

/// What is sampled: numbers that `claimed` is said to enclose over the box of the uncertain set. Called on any thread.
struct Sampled {
  std::vector<Enclosure> claimed;
  std::function<std::vector<double>(std::span<const double> parameters)> evaluate;  ///< in plain floating point
  /// Enclosures of the exact values at one point, which tell an escape from rounding errors of `evaluate`.
  std::function<std::vector<Enclosure>(std::span<const double> parameters)> enclose;
};

[[nodiscard]] Sampled sampled_wrench_of(const Model& model, std::vector<Enclosure> claimed);
[[nodiscard]] Sampled sampled_accelerations_of(const Model& model, const Instant& instant,
                                               std::vector<Enclosure> claimed);

/// A proven error: no exact value at `parameters` lies in the claimed enclosure.
struct Escape {
  std::size_t component;
  Enclosure exact;
  std::vector<double> parameters;
};

struct Samples {
  std::uint64_t count;          ///< taken; fewer than asked for where interrupted or escaped
  std::vector<Enclosure> hull;  ///< of the samples, within what was claimed; empty ([inf, -inf]) without samples
  std::optional<Escape> escape;
};

struct SampleOptions {
  std::uint64_t count;
  std::function<bool()> interrupted = {};
  std::function<void(std::uint64_t done)> progress = {};  ///< one call at a time
};

/// Uniform and independent over the ranges of the uncertain set, all others nominal; the same samples each time.
[[nodiscard]] Samples take_samples(const Model& model, UncertainSet uncertain, const Sampled& sampled,
                                   const SampleOptions& options);

/// The part of the enclosure that the hull fills, in [0, 1]; 1 for an enclosure that is a point.
[[nodiscard]] double filled_part(const Enclosure& hull, const Enclosure& claimed);

}  // namespace verisq::stance
