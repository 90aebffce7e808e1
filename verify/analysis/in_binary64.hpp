/// Precise enclosures with binary64 ends, rounded outward: for searches, which ask more often.
#pragma once

#include "verify/numbers/vector.hpp"

namespace verisq::verify {

[[nodiscard]] inline Interval in_binary64(const PreciseInterval& a) {
  return {a.lower().to_double(Direction::down), a.upper().to_double(Direction::up)};
}

[[nodiscard]] inline Vector3<double> in_binary64(const PreciseVector& v) {
  return {in_binary64(v[0]), in_binary64(v[1]), in_binary64(v[2])};
}

[[nodiscard]] inline Matrix3<double> in_binary64(const PreciseMatrix& m) {
  return {in_binary64(m.row(0)), in_binary64(m.row(1)), in_binary64(m.row(2))};
}

}  // namespace verisq::verify
