/// Random numbers and points for tests that need nothing more particular.
#pragma once

#include <random>

#include "verisq/model.hpp"

namespace verisq::testing {

/// The same numbers for the same seed.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  [[nodiscard]] double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }

  /// Each coordinate uniform in [-reach, reach].
  [[nodiscard]] Point point(double reach) {
    // Braces, unlike parentheses, fix the order in which the coordinates are drawn.
    return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace verisq::testing
