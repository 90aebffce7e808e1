/// What our duality certificate proves of closest points that another tool found: turns any answer into an enclosure.
#pragma once

#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

#include "verify/proof/posed_superquadric.hpp"

namespace verisq::bench {

/// For points outside a superquadric in its own frame.
class PointCertifier {
 public:
  explicit PointCertifier(const Superquadric& solid) : check_(Model{"", {{"solid", solid, {}}}}) {}

  /// As narrow as `closest` is accurate, but for rounding; valid whatever it is.
  [[nodiscard]] Enclosure operator()(const Point& query, const Point& closest) const;

 private:
  Checker check_;
};

/// For two disjoint superquadrics, A in its own frame and B in a pose.
class PairCertifier {
 public:
  PairCertifier(const Superquadric& a, const Superquadric& b) : a_({"a", a, {}}), b_(b) {}

  /// `on_b` in B's own frame.
  [[nodiscard]] Enclosure operator()(const Pose& pose_of_b, const Point& on_a, const Point& on_b) const;

 private:
  verify::PosedSuperquadric a_;
  Superquadric b_;
};

}  // namespace verisq::bench
