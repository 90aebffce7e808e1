/// The winding number is the sum of the signs of the triangles above the point.
#include "host/fit/inside_test.hpp"

#include <algorithm>

#include "host/mesh/extent.hpp"
#include "verify/containment/rims.hpp"

namespace verisq::fit_search {
namespace {

constexpr std::size_t columns_a_side = 64;

/// Twice the area of p, a, b seen along z, positive where they turn to the left.
double turn(const Point& p, const Point& a, const Point& b) {
  return (a[0] - p[0]) * (b[1] - p[1]) - (a[1] - p[1]) * (b[0] - p[0]);
}

/// Where the ray upward from the point passes through the triangle: the way that it faces, else 0.
int passage(const Point& p, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const std::array<double, 3> weights{turn(p, b, c), turn(p, c, a), turn(p, a, b)};
  const bool left = weights[0] >= 0.0 && weights[1] >= 0.0 && weights[2] >= 0.0;
  const bool right = weights[0] < 0.0 && weights[1] < 0.0 && weights[2] < 0.0;
  const double area = weights[0] + weights[1] + weights[2];
  if ((!left && !right) || area == 0.0) return 0;
  const double height = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / area;
  if (height <= p[2]) return 0;
  return left ? 1 : -1;
}

}  // namespace

InsideTest::InsideTest(const Mesh& mesh)
    : triangles_(verify::closed_triangles(mesh, verify::closing_over_rims(mesh))),
      columns_(columns_a_side * columns_a_side) {
  const Extent extent = extent_of(mesh.vertices);  // which the means of rims do not leave
  lower_ = extent.lower;
  upper_ = extent.upper;
  for (std::uint32_t n = 0; n < triangles_.size(); ++n) add(n);
}

std::size_t InsideTest::column(double along, std::size_t axis) const {
  const double share = (along - lower_[axis]) / (upper_[axis] - lower_[axis]);
  if (!(share > 0.0)) return 0;
  return std::min(static_cast<std::size_t>(std::min(share, 1.0) * columns_a_side), columns_a_side - 1);
}

void InsideTest::add(std::uint32_t triangle) {
  const Triangle& corners = triangles_[triangle];
  const auto range = [&](std::size_t axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    return std::pair(column(low, axis), column(high, axis));
  };
  const auto [first_x, last_x] = range(0);
  const auto [first_y, last_y] = range(1);
  for (std::size_t x = first_x; x <= last_x; ++x) {
    for (std::size_t y = first_y; y <= last_y; ++y) columns_[x * columns_a_side + y].push_back(triangle);
  }
}

bool InsideTest::operator()(const Point& point) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(point[axis] >= lower_[axis] && point[axis] <= upper_[axis])) return false;
  }
  int winding = 0;
  for (const std::uint32_t n : columns_[column(point[0], 0) * columns_a_side + column(point[1], 1)]) {
    winding += passage(point, triangles_[n]);
  }
  return winding != 0;
}

}  // namespace verisq::fit_search
