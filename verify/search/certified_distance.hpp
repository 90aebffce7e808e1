/// What searches find of a point, as certificates have it.
#pragma once

#include <algorithm>
#include <cmath>

#include "verify/proof/certificate.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// An enclosure of the signed distance and what certifies its ends, in the solid's frame.
struct CertifiedDistance {
  Enclosure distance;
  Proposal direction;     ///< of the lower end
  Proposal witness = {};  ///< of the upper end outside: leads from a point near the solid's surface to the query
};

/// To nearest; zero, which proves nothing, where that is not finite.
[[nodiscard]] inline std::array<double, 3> rounded(const Proposal& v) {
  const std::array result{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  return std::ranges::all_of(result, [](double c) { return std::isfinite(c); }) ? result : std::array<double, 3>{};
}

}  // namespace verisq::verify
