/// The posterior condylar line: the edge of the distal end's shadow, seen along the shaft, that the bone lies on; then
/// the most prominent points of both sides against it, smoothed.
#include "host/features/condyles.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <vector>

#include "host/mesh/eigen_points.hpp"

namespace verisq::features {
namespace {

using Eigen::Vector3d;

/// Condyles have more than this times the shaft's narrowest section.
constexpr double condyles_widen = 2.0;

/// A vertex seen along the shaft: to medial, and how far back.
struct Seen {
  double medial;
  double back;
  Vector3d vertex;
};

double turn(const Seen& a, const Seen& b, const Seen& c) {
  return (b.medial - a.medial) * (c.back - a.back) - (b.back - a.back) * (c.medial - a.medial);
}

/// The edge of the convex hull that faces backward and crosses the middle; lateral end first.
std::array<Seen, 2> rear_edge(std::vector<Seen> seen) {
  std::ranges::sort(seen, [](const Seen& a, const Seen& b) { return a.medial < b.medial; });
  const double middle = 0.5 * (seen.front().medial + seen.back().medial);
  std::vector<Seen> hull;  // its rear side, from lateral to medial
  for (const Seen& next : seen) {
    while (hull.size() > 1 && turn(hull[hull.size() - 2], hull.back(), next) >= 0.0) hull.pop_back();
    hull.push_back(next);
  }
  const auto beyond = std::ranges::find_if(hull, [&](const Seen& x) { return x.medial > middle; });
  return {*std::prev(beyond), *beyond};
}

constexpr double about_a_point = 5.0;  // mm

/// The top of the paraboloid of least squares through the vertices about `top`, which lie below it: what the noise of
/// single vertices and their places do not decide. `top` itself where there is no such paraboloid.
Vector3d smoothed(std::span<const Vector3d> points, const Vector3d& top, const Vector3d& direction) {
  using Coefficients = Eigen::Matrix<double, 6, 1>;
  const Vector3d u = direction.unitOrthogonal();
  const Vector3d v = direction.cross(u);
  Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Coefficients right_side = Coefficients::Zero();
  std::size_t count = 0;
  for (const Vector3d& x : points) {
    const Vector3d d = x - top;
    if (d.norm() > about_a_point) continue;
    const double a = u.dot(d);
    const double b = v.dot(d);
    Coefficients terms;
    terms << 1.0, a, b, a * a, a * b, b * b;
    normal_matrix += terms * terms.transpose();
    right_side += direction.dot(d) * terms;
    ++count;
  }
  constexpr std::size_t fewest = 12;
  if (count < fewest) return top;
  const Coefficients c = normal_matrix.ldlt().solve(right_side);
  Eigen::Matrix2d curvature;
  curvature << 2.0 * c[3], c[4], c[4], 2.0 * c[5];
  const bool is_top = curvature.determinant() > 0.0 && curvature(0, 0) < 0.0;
  if (!is_top || !c.allFinite()) return top;
  const Eigen::Vector2d place = curvature.inverse() * Eigen::Vector2d(-c[1], -c[2]);
  if (place.norm() > about_a_point) return top;
  const double height = c[0] + 0.5 * (c[1] * place[0] + c[2] * place[1]);
  return top + place[0] * u + place[1] * v + height * direction;
}

/// Precondition: not empty.
Vector3d most_prominent(std::span<const Vector3d> points, const Vector3d& direction) {
  const Vector3d top = *std::ranges::max_element(points, {}, [&](const Vector3d& x) { return direction.dot(x); });
  return smoothed(points, smoothed(points, top, direction), direction);
}

}  // namespace

std::vector<Vector3d> distal_end(const Mesh& mesh, const ShaftAxis& shaft) {
  std::vector<Vector3d> distal;
  if (shaft.distal_area < condyles_widen * shaft.area) return distal;
  for (const Point& x : mesh.vertices) {
    if (shaft.direction.dot(vector_of(x) - shaft.point) < shaft.distal) distal.push_back(vector_of(x));
  }
  constexpr std::size_t fewest = 10;
  if (distal.size() < fewest) distal.clear();
  return distal;
}

double excess(std::span<const Vector3d> distal, const ShaftAxis& shaft, const Vector3d& direction) {
  double farthest = -std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3d& x : distal) {
    farthest = std::max(farthest, direction.dot(x - shaft.point));
    least = std::min(least, direction.dot(x - shaft.point));
  }
  return farthest + least;
}

Condyles condyles(std::span<const Vector3d> distal, const ShaftAxis& shaft, const Vector3d& medial,
                  const Vector3d& posterior) {
  const double handedness = medial.cross(posterior).dot(shaft.direction) > 0.0 ? 1.0 : -1.0;
  std::vector<Seen> seen;
  for (const Vector3d& x : distal) seen.push_back({medial.dot(x), posterior.dot(x), x});
  const auto [lateral_end, medial_end] = rear_edge(std::move(seen));
  Condyles found{medial_end.vertex, lateral_end.vertex, {}, {}};
  Vector3d sideways = medial;
  constexpr int turns = 10;  // each by the line that the last one found
  for (int i = 0; i < turns; ++i) {
    const Vector3d line = found.medial_posterior - found.lateral_posterior;
    sideways = (line - shaft.direction.dot(line) * shaft.direction).normalized();
    const Vector3d back = handedness * shaft.direction.cross(sideways);
    const double middle = sideways.dot(0.5 * (found.medial_posterior + found.lateral_posterior));
    const auto side = [&](double sign) {
      std::vector<Vector3d> half;
      std::ranges::copy_if(distal, std::back_inserter(half),
                           [&](const Vector3d& x) { return sign * (sideways.dot(x) - middle) > 0.0; });
      return half;
    };
    found.medial_posterior = most_prominent(side(1.0), back);
    found.lateral_posterior = most_prominent(side(-1.0), back);
  }
  found.medial_epicondyle = most_prominent(distal, sideways);
  found.lateral_epicondyle = most_prominent(distal, -sideways);
  return found;
}

}  // namespace verisq::features
