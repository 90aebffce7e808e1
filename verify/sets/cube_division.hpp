/// Cubes that halve exactly, and how far a point is from them.
#pragma once

#include <array>
#include <optional>

#include "verify/sets/bounding_box.hpp"
#include "verify/sets/cube.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// What a root cube has to keep to, in half-widths of it.
struct RootCubeRule {
  double margin = 0.0;         ///< the box lies so far within its faces; below 1/8
  double farthest = infinity;  ///< no coordinate of its centre is farther from 0; at least 16
};

/// Half-widths of root cubes are not less: cubes of the deepest levels would underflow.
inline constexpr double smallest_root = 0x1p-1001;

/// The cube that octrees and searches grow from, on the host and on devices: it contains the box. Its half-width is the
/// least power of two, from `smallest_root` on, for which a centre on a grid of 1/1024 of it keeps to the rule. Where
/// no coordinate of that is farther than 2^f half-widths (and f at least 4), centres and corners of all cubes that are
/// halved from it are binary64 numbers down to 2^-(51 - f) half-widths. Nothing where that overflows.
[[nodiscard]] std::optional<Cube> root_cube(const Box& box, const RootCubeRule& rule = {});

/// The eight halves, which cover the cube. Nothing where a centre is not representable.
[[nodiscard]] std::optional<std::array<Cube, 8>> halves(const Cube& cube);

/// Exactly: false proves that x lies beyond a face.
[[nodiscard]] bool contains(const Cube& cube, const Point& x);

/// Encloses the distance of x to the cube, 0 within.
[[nodiscard]] Enclosure distance(const Point& x, const Cube& cube);

/// Encloses the distance of an x within the cube to its faces. Precondition: contains(cube, x).
[[nodiscard]] Enclosure distance_to_faces(const Point& x, const Cube& cube);

}  // namespace verisq::verify
