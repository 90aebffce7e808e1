/// The root that a tapered solid's support function takes, in plain floating point (docs/mathematics.md §18).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// About the root τ of ‖(r, Z + k τ)‖_q = τ, as `proposed::support_root` states it.
template <class Float>
[[nodiscard]] Float near_root_of_support(Float section, Float height, Float k, Float q) {
  // ‖(r, Z + k τ)‖ - τ is convex and not negative at the start, from where Newton ascends to the root: with the maximum
  // norm it is there.
  Float root = std::max({section, height / (1 - k), -height / (1 + k)});
  for (int i = 0; i < 60 && q < infinity && root > 0; ++i) {
    const Float moved = height + k * root;
    const Float large = std::max(section, std::fabs(moved));
    const Float small = std::min(section, std::fabs(moved));
    const Float norm = large * std::pow(1 + std::pow(small / large, q), 1 / q);
    const Float slope = std::copysign(k, k * moved) * std::pow(std::fabs(moved) / norm, q - 1) - 1;
    const Float step = (root - norm) / slope;
    root += step;
    if (!(step > 4 * std::numeric_limits<Float>::epsilon() * root)) break;
  }
  return root;
}

}  // namespace verisq::verify
