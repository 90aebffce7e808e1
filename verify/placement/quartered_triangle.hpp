/// Pieces of a triangle, made by dividing it at the middles of its sides, and what its vertices say of them.
#pragma once

#include <array>

#include "verisq/mesh.hpp"

namespace verisq::verify {

/// The pieces at the first, the second, the third corner, and the middle one: together all of it. Corners to nearest.
[[nodiscard]] std::array<Triangle, 4> quarters(const Triangle& piece);

/// How far the corners of a piece, to nearest, are from the exact ones, at most, if it was made by no more than
/// `most_quarterings` divisions. Precondition: finite.
[[nodiscard]] double quartering_error(const Triangle& whole);

/// |a - b|, rounded up.
[[nodiscard]] double distance_in_binary64_up(const Point& a, const Point& b);

/// Of a function that changes by no more than the place does, and at the vertices is no less than `at_vertices`: no
/// less than this on all of the triangle. Precondition: no NaN.
[[nodiscard]] double least_on(const Triangle& whole, const std::array<double, 3>& at_vertices);

/// The same on all of a piece of it, whose corners are `off` at most.
[[nodiscard]] double least_on(const Triangle& piece, double off, const Triangle& whole,
                              const std::array<double, 3>& at_vertices);

}  // namespace verisq::verify
