/// Two posed superquadrics A and B in A's own frame, and what one evaluation proves about their distance.
#pragma once

#include "verify/proof/posed_superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/pair_certificate.hpp"

namespace verisq::verify {

/// Bounds of the distance of A and B (docs/mathematics.md §7), each by a single evaluation in 127-bit interval
/// arithmetic. Points of B are stated in B's own frame, all else in A's. The solids must outlive this.
class PairBounds {
 public:
  /// `relative` leads from B's own frame to A's.
  PairBounds(const PosedSuperquadric& a, const PosedSuperquadric& b, const RigidMotion& relative)
      : a_(&a), b_(&b), relative_(relative) {}

  [[nodiscard]] const PosedSuperquadric& a() const { return *a_; }
  [[nodiscard]] const PosedSuperquadric& b() const { return *b_; }
  [[nodiscard]] const RigidMotion& relative() const { return relative_; }

  /// d >= (v·c - h_A(v) - h_B(R^T v)) / |v| for every v other than 0: A lies in {v·x <= h_A(v)}, B in
  /// {v·x >= v·c - h_B(R^T v)}. Rounded down.
  [[nodiscard]] Real lower_by_vector(const PreciseVector& v) const;

  /// d <= |c + R b / max(1, g_B(b)) - a / max(1, g_A(a))|, because both points are in their solids. Rounded up.
  [[nodiscard]] Real upper_by_points(const PreciseVector& on_a, const PreciseVector& on_b) const;

  /// Both ends rounded outward to binary64; -infinity and infinity for a zero or non-finite vector and for non-finite
  /// points. The lower end may be negative.
  [[nodiscard]] Enclosure distance(const Separation& separation) const;

 private:
  const PosedSuperquadric* a_;
  const PosedSuperquadric* b_;
  RigidMotion relative_;
};

}  // namespace verisq::verify
