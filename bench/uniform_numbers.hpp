/// Reproducible random numbers: std::mt19937_64 is fixed by the standard, its distributions are not and hence not used.
#pragma once

#include <cstdint>
#include <random>

namespace verisq::bench {

class UniformNumbers {
 public:
  explicit UniformNumbers(std::uint64_t seed) : generator_(seed) {}

  /// In [0, 1).
  [[nodiscard]] double fraction() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

  /// In [-bound, bound).
  [[nodiscard]] double within(double bound) { return bound * (2.0 * fraction() - 1.0); }

 private:
  std::mt19937_64 generator_;
};

}  // namespace verisq::bench
