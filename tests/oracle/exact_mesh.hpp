/// The test oracle for a point and a triangle mesh: exact squared distances and winding numbers by integers without
/// limit; independent of verify/.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <span>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>

namespace verisq::oracle {

using Integer = boost::multiprecision::cpp_int;

/// A fraction, of a denominator above 0.
struct Fraction {
  Integer numerator;
  Integer denominator;
};

/// Coordinates are multiples of 2^-300, as all binary64 numbers of at least 2^-247 are. The answers are exact.
class ExactMesh {
 public:
  explicit ExactMesh(std::span<const Triangle> triangles);

  /// The squared distance to the nearest triangle. Brute force: all triangles in floating point, exactly those that are
  /// about as near as the nearest.
  [[nodiscard]] Fraction squared_distance(const Point& point) const;

  /// By a segment in a direction of no particular kind. Precondition: the point lies on no triangle.
  [[nodiscard]] int winding_number(const Point& point) const;

 private:
  std::vector<Triangle> triangles_;
};

/// True where lo² <= fraction <= hi². Precondition: 0 <= lo, hi; multiples of 2^-600.
[[nodiscard]] bool holds_root(const Enclosure& distance, const Fraction& squared);

}  // namespace verisq::oracle
