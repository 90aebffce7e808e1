/// Vectors and matrices of any size whose components are intervals: Eigen's.
#pragma once

#include <Eigen/Core>

#include "verify/numbers/vector.hpp"

template <class T>
struct Eigen::NumTraits<verisq::verify::BasicInterval<T>> : Eigen::GenericNumTraits<verisq::verify::BasicInterval<T>> {
  using Real = verisq::verify::BasicInterval<T>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 8,
    MulCost = 16
  };
};

namespace verisq::verify {

// A block of a larger vector or matrix as one of three dimensions, and back.

template <class T>
[[nodiscard]] Eigen::Matrix<BasicInterval<T>, 3, 1> block(const Vector3<T>& v) {
  return {v[0], v[1], v[2]};
}

template <class T>
[[nodiscard]] Eigen::Matrix<BasicInterval<T>, 3, 3> block(const Matrix3<T>& m) {
  Eigen::Matrix<BasicInterval<T>, 3, 3> result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result(i, j) = m(i, j);
  }
  return result;
}

/// Components `first` to `first` + 2.
template <class T, int N>
[[nodiscard]] Vector3<T> three_of(const Eigen::Matrix<BasicInterval<T>, N, 1>& v, int first = 0) {
  return {v[first], v[first + 1], v[first + 2]};
}

}  // namespace verisq::verify
