/// Points between those of the cavity, which an implant is kept off during the search.
#pragma once

#include <vector>

#include "verisq/cavity.hpp"
#include "verisq/mesh.hpp"

namespace verisq::fit_search {

/// The cavity with points of weight 0 added, on a grid over each triangle of at most the given spacing, or a wider one
/// where that would be more than the given number. The area they belong to is the last; nothing changes where there are
/// no triangles. Precondition: spacing > 0.
[[nodiscard]] Cavity with_surface_points(const Cavity& cavity, double spacing, std::size_t most_points);

/// Points of a triangle about one of it, the closer together the nearer they are to it: a patch that an implant can
/// hardly slip off. The first is the point itself. `spacing` is that of the outer ones.
[[nodiscard]] std::vector<Point> patch(const Triangle& triangle, const Point& middle, double spacing);

}  // namespace verisq::fit_search
