/// The vector product of vectors of intervals.
#pragma once

#include "verify/numbers/vector.hpp"

namespace verisq::verify {

template <class T>
[[nodiscard]] Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace verisq::verify
