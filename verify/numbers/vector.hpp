/// Vectors of enclosures.
#pragma once

#include <array>
#include <cstddef>
#include <verisq/model.hpp>

#include "verify/numbers/interval.hpp"

namespace verisq::verify {

// Vectors and matrices of three dimensions whose components are intervals.

// T is the type of the ends: double or Real. Like the operations of intervals, every operation contains all exact
// results.

template <class T>
class Vector3 {
 public:
  using Component = BasicInterval<T>;

  Vector3() = default;  ///< zero
  Vector3(const Component& x, const Component& y, const Component& z) : components_{x, y, z} {}

  [[nodiscard]] const Component& operator[](std::size_t i) const { return components_[i]; }
  [[nodiscard]] Component& operator[](std::size_t i) { return components_[i]; }

  [[nodiscard]] Component dot(const Vector3& b) const {
    const auto& [x, y, z] = components_;
    return x * b[0] + (y * b[1] + z * b[2]);
  }

  friend Vector3 operator-(const Vector3& a) { return {-a[0], -a[1], -a[2]}; }
  friend Vector3 operator+(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
  friend Vector3 operator-(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  friend Vector3 operator*(const Vector3& a, const Component& s) { return {a[0] * s, a[1] * s, a[2] * s}; }
  friend Vector3 operator/(const Vector3& a, const Component& s) { return {a[0] / s, a[1] / s, a[2] / s}; }

 private:
  std::array<Component, 3> components_;
};

template <class T>
class Matrix3 {
 public:
  using Component = BasicInterval<T>;

  Matrix3() = default;  ///< zero
  Matrix3(const Vector3<T>& row_0, const Vector3<T>& row_1, const Vector3<T>& row_2) : rows_{row_0, row_1, row_2} {}

  [[nodiscard]] static Matrix3 identity() { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }

  [[nodiscard]] const Component& operator()(std::size_t i, std::size_t j) const { return rows_[i][j]; }
  [[nodiscard]] Component& operator()(std::size_t i, std::size_t j) { return rows_[i][j]; }

  [[nodiscard]] const Vector3<T>& row(std::size_t i) const { return rows_[i]; }
  [[nodiscard]] Vector3<T> column(std::size_t j) const { return {rows_[0][j], rows_[1][j], rows_[2][j]}; }
  [[nodiscard]] Matrix3 transpose() const { return {column(0), column(1), column(2)}; }

  friend Matrix3 operator-(const Matrix3& a) { return {-a.rows_[0], -a.rows_[1], -a.rows_[2]}; }
  friend Matrix3 operator+(const Matrix3& a, const Matrix3& b) {
    return {a.rows_[0] + b.rows_[0], a.rows_[1] + b.rows_[1], a.rows_[2] + b.rows_[2]};
  }
  friend Matrix3 operator*(const Matrix3& a, const Component& s) {
    return {a.rows_[0] * s, a.rows_[1] * s, a.rows_[2] * s};
  }
  friend Vector3<T> operator*(const Matrix3& a, const Vector3<T>& v) {
    return {a.rows_[0].dot(v), a.rows_[1].dot(v), a.rows_[2].dot(v)};
  }
  friend Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    return Matrix3(a * b.column(0), a * b.column(1), a * b.column(2)).transpose();
  }

 private:
  std::array<Vector3<T>, 3> rows_;
};

using PreciseVector = Vector3<Real>;
using PreciseMatrix = Matrix3<Real>;

/// Euclidean length.
template <class T>
[[nodiscard]] BasicInterval<T> length(const Vector3<T>& v) {
  return sqrt(square(v[0]) + square(v[1]) + square(v[2]));
}

}  // namespace verisq::verify
