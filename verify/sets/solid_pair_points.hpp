/// Upper bounds of the distance of two solids: points proven to lie in them, improved as long as that pays.
#pragma once

#include <optional>

#include "verify/sets/bounded_motion.hpp"
#include "verify/sets/solid_pair_cells.hpp"

namespace verisq::verify {

/// A point of each, in their own frames, and their distance, rounded up.
struct NearPoints {
  Point on_a;
  Point on_b;
  double distance;
};

class PointSearch {
 public:
  /// All must outlive this.
  PointSearch(const SearchSolid& a, const SearchSolid& b, const BoundedMotion& motion)
      : a_(&a), b_(&b), motion_(&motion) {}

  /// Points proven to lie in the cells' parts, next to the proposed ones; nothing where the proof fails. `scale` is the
  /// size of the cells. The cells' own sets lead there, and prove nothing, because points may leave the cubes.
  [[nodiscard]] std::optional<NearPoints> settled(const Cell& x, const Cell& y, const Point& near_a,
                                                  const Point& near_b, double scale) const;

  /// The same where planes do not tell the shape, as at tips.
  [[nodiscard]] std::optional<NearPoints> settled_towards_centres(const Cell& x, const Cell& y, const Point& near_a,
                                                                  const Point& near_b) const;

  /// Descends to closer points of the same parts, until a step within a cube of the half-width `scale` or less promises
  /// no more than `gain`.
  [[nodiscard]] NearPoints improved(const Cell& x, const Cell& y, NearPoints points, double scale, double gain) const;

  /// Whether `at`, of A's frame, is proven to lie in both cells' parts.
  [[nodiscard]] bool common(const Cell& x, const Cell& y, const Point& at) const;

 private:
  [[nodiscard]] std::optional<NearPoints> both(const std::optional<Point>& on_a,
                                               const std::optional<Point>& on_b) const;

  const SearchSolid* a_;
  const SearchSolid* b_;
  const BoundedMotion* motion_;
};

}  // namespace verisq::verify
