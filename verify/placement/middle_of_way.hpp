/// Where a part of a path is halved.
#pragma once

#include <cmath>

namespace verisq::verify {

/// Poses are the natural places to halve a path; between two of them, time. Such times have few digits.
[[nodiscard]] inline double middle_of_way(double begin, double end) {
  const double half = begin + (end - begin) / 2;
  return end - begin > 1.0 ? std::floor(half) : half;
}

}  // namespace verisq::verify
