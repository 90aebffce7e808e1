/// This file implements the sections, shaft and condyles of femur.hpp.
#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "host/prepare/eigen_points.hpp"
#include "host/prepare/femur.hpp"

namespace verisq::features {
namespace {

using Eigen::Vector3d;

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return (std::uint64_t{std::min(a, b)} << 32U) | std::max(a, b);
}

/// The place where the curve enters a triangle, and the next crossing.
struct Crossing {
  Vector3d point;
  std::uint64_t next;
};

class Cut {
 public:
  Cut(const Mesh& mesh, const Plane& plane) : mesh_(mesh) {
    heights_.reserve(mesh.vertices.size());
    for (const Point& x : mesh.vertices) heights_.push_back(plane.normal.dot(vector_of(x)) - plane.offset);
    for (const auto& triangle : mesh.triangles) add(triangle);
  }

  /// Takes out one curve after the other; returns the closed ones. Open curves are dropped.
  std::vector<std::vector<Vector3d>> curves() {
    std::vector<std::vector<Vector3d>> result;
    while (!crossings_.empty()) {
      const std::uint64_t start = crossings_.begin()->first;
      std::vector<Vector3d> points;
      std::uint64_t at = start;
      for (auto found = crossings_.find(at); found != crossings_.end(); found = crossings_.find(at)) {
        points.push_back(found->second.point);
        at = found->second.next;
        crossings_.erase(found);
      }
      if (at == start && points.size() > 2) result.push_back(std::move(points));
    }
    return result;
  }

 private:
  [[nodiscard]] bool above(std::uint32_t vertex) const { return heights_[vertex] >= 0.0; }

  [[nodiscard]] Vector3d crossing(std::uint32_t a, std::uint32_t b) const {
    const double t = heights_[a] / (heights_[a] - heights_[b]);
    return vector_of(mesh_.vertices[a]) + t * (vector_of(mesh_.vertices[b]) - vector_of(mesh_.vertices[a]));
  }

  void add(const std::array<std::uint32_t, 3>& triangle) {
    const bool side = above(triangle[0]);
    if (above(triangle[1]) == side && above(triangle[2]) == side) return;  // nearly all: the plane cuts few
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i];
      const std::uint32_t b = triangle[(i + 1) % 3];
      const std::uint32_t c = triangle[(i + 2) % 3];
      if (!above(a) || above(b)) continue;  // not downward through this edge
      const std::uint64_t next = above(c) ? edge_key(b, c) : edge_key(c, a);
      crossings_.insert({edge_key(a, b), {crossing(std::min(a, b), std::max(a, b)), next}});
    }
  }

  const Mesh& mesh_;
  std::vector<double> heights_;
  std::unordered_map<std::uint64_t, Crossing> crossings_;
};

SectionCurve measured(std::vector<Vector3d> points, const Vector3d& normal) {
  SectionCurve curve{0.0, 0.0, Vector3d::Zero(), {}};
  const Vector3d origin = points.front();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d a = points[i] - origin;
    const Vector3d b = points[(i + 1) % points.size()] - origin;
    const double area = 0.5 * normal.dot(a.cross(b));
    curve.perimeter += (b - a).norm();
    curve.area += area;
    curve.centroid += area / 3.0 * (a + b);
  }
  curve.centroid = curve.area != 0.0 ? Vector3d(origin + curve.centroid / curve.area) : origin;
  curve.points = std::move(points);
  return curve;
}

}  // namespace

std::vector<SectionCurve> plane_section(const Mesh& mesh, const Plane& plane) {
  std::vector<SectionCurve> result;
  for (std::vector<Vector3d>& points : Cut(mesh, plane).curves())
    result.push_back(measured(std::move(points), plane.normal));
  return result;
}

bool encloses(const SectionCurve& curve, const Plane& plane, const Vector3d& point) {
  const Vector3d u = plane.normal.unitOrthogonal();
  const Vector3d v = plane.normal.cross(u);
  bool inside = false;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const Vector3d a = curve.points[i] - point;
    const Vector3d b = curve.points[(i + 1) % curve.points.size()] - point;
    if ((a.dot(v) > 0.0) == (b.dot(v) > 0.0)) continue;
    const double at = a.dot(u) - a.dot(v) * (b.dot(u) - a.dot(u)) / (b.dot(v) - a.dot(v));
    if (at > 0.0) inside = !inside;
  }
  return inside;
}

namespace {

using Eigen::Vector3d;

constexpr std::size_t section_count = 100;
constexpr std::size_t least_sections = 5;
constexpr double still_shaft = 1.4;     // times the area of the narrowest section
constexpr double below_the_head = 2.0;  // head radii: there the neck has met the shaft
constexpr int rounds = 4;

struct Section {
  double height;
  double area;
  Vector3d centroid;
};

struct Extent {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
};

Extent extent_along(const Mesh& mesh, const Vector3d& direction) {
  Extent extent;
  for (const Point& x : mesh.vertices) {
    const double height = direction.dot(vector_of(x));
    extent.lowest = std::min(extent.lowest, height);
    extent.highest = std::max(extent.highest, height);
  }
  return extent;
}

/// The outermost curve alone: a canal leaves the centroid of the whole bone.
std::optional<Section> section_at(const Mesh& mesh, const Vector3d& direction, double height) {
  const std::vector<SectionCurve> curves = plane_section(mesh, {direction, height});
  const auto largest = std::ranges::max_element(curves, {}, &SectionCurve::area);
  if (largest == curves.end() || !(largest->area > 0.0)) return std::nullopt;
  return Section{height, largest->area, largest->centroid};
}

std::vector<Section> sections(const Mesh& mesh, const Vector3d& direction, double from, double to) {
  std::vector<Section> result;
  for (std::size_t i = 0; i < section_count; ++i) {
    const double height = from + (to - from) * (static_cast<double>(i) + 0.5) / section_count;
    if (const auto section = section_at(mesh, direction, height)) result.push_back(*section);
  }
  return result;
}

/// The line of least squares through the centroids; those far from it, for their kind, count less and less.
void fit_line(std::span<const Section> shaft, Vector3d& point, Vector3d& direction) {
  std::vector<double> weights(shaft.size(), 1.0);
  constexpr int reweightings = 20;
  for (int round = 0; round < reweightings; ++round) {
    double sum = 0.0;
    Vector3d mean = Vector3d::Zero();
    for (std::size_t i = 0; i < shaft.size(); ++i) {
      sum += weights[i];
      mean += weights[i] * shaft[i].centroid;
    }
    mean /= sum;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < shaft.size(); ++i) {
      const Vector3d d = shaft[i].centroid - mean;
      covariance += weights[i] * d * d.transpose();
    }
    const Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
    direction = axis.dot(direction) < 0.0 ? Vector3d(-axis) : axis;
    point = mean;
    std::vector<double> residuals;
    for (const Section& section : shaft) residuals.push_back(direction.cross(section.centroid - point).norm());
    std::vector<double> sorted = residuals;
    std::ranges::sort(sorted);
    const double scale = std::max(3.0 * sorted[sorted.size() / 2], 1e-9);
    for (std::size_t i = 0; i < shaft.size(); ++i) weights[i] = 1.0 / (1.0 + std::pow(residuals[i] / scale, 4.0));
  }
}

/// The sections about the narrowest that are not much wider. The ends taper off: from the distal end, the narrowest
/// counts only beyond the place where sections stop growing.
std::span<const Section> shaft_of(std::span<const Section> all) {
  std::size_t first = 0;
  while (first + 1 < all.size() && all[first + 1].area > 1.01 * all[first].area) ++first;
  const std::span<const Section> rest = all.subspan(first);
  const auto narrowest = std::ranges::min_element(rest, {}, &Section::area);
  if (narrowest == rest.end()) return {};
  auto begin = narrowest;
  auto end = narrowest;
  while (begin != rest.begin() && std::prev(begin)->area <= still_shaft * narrowest->area) --begin;
  while (end != rest.end() && end->area <= still_shaft * narrowest->area) ++end;
  return {begin, end};
}

}  // namespace

std::optional<ShaftAxis> shaft_axis(const Mesh& mesh, const Vector3d& head, double head_radius, const Vector3d& along) {
  Vector3d direction = along.normalized();
  std::optional<ShaftAxis> found;
  for (int round = 0; round < rounds; ++round) {
    const Extent extent = extent_along(mesh, direction);
    const double top = direction.dot(head) - below_the_head * head_radius;
    if (!(top > extent.lowest)) return std::nullopt;
    const std::vector<Section> all = sections(mesh, direction, extent.lowest, top);
    const std::span<const Section> shaft = shaft_of(all);
    if (shaft.size() < least_sections) return std::nullopt;
    Vector3d point = shaft[shaft.size() / 2].centroid;
    const Vector3d across = direction;  // of the sections
    fit_line(shaft, point, direction);
    const double middle = across.dot(point);
    double distal_area = 0.0;
    for (const Section& section : all) {
      if (section.height < shaft.front().height) distal_area = std::max(distal_area, section.area);
    }
    found = ShaftAxis{point,
                      direction,
                      shaft.front().height - middle,
                      shaft.back().height - middle,
                      std::ranges::min_element(shaft, {}, &Section::area)->area,
                      distal_area,
                      extent.lowest - middle};
  }
  return found;
}

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

/// The top of the paraboloid of least squares through the vertices about `top`, which lie below it: noise and the
/// places of single vertices do not decide it. `top` itself if there is no such paraboloid.
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

/// The most prominent of some of the vertices, smoothed by all of them. Precondition: not empty.
Vector3d most_prominent(std::span<const Vector3d> some, std::span<const Vector3d> all, const Vector3d& direction) {
  const Vector3d top = *std::ranges::max_element(some, {}, [&](const Vector3d& x) { return direction.dot(x); });
  return smoothed(all, smoothed(all, top, direction), direction);
}

/// Seen from the side.
struct Profile {
  Vector3d back;
  Vector3d up;
};

struct Circle {
  Eigen::Vector2d centre;
  double radius;
};

/// Returns whether a point of a profile belongs to the round rear of a condyle, from its lowest part to the place where
/// it leaves the shaft.
bool is_rear(const Eigen::Vector2d& from_centre, double radius) {
  constexpr double lowest = -0.6 * std::numbers::pi;  // of angles from backward to upward
  constexpr double highest = std::numbers::pi / 3.0;
  constexpr double roundness = 0.15;
  const double angle = std::atan2(from_centre[1], from_centre[0]);
  return lowest < angle && angle < highest && std::fabs(from_centre.norm() - radius) < roundness * radius;
}

/// The circle of least squares of the points that belong to the circle before: |q|² = 2 c·q + (r² - |c|²).
std::optional<Circle> next_circle(std::span<const Eigen::Vector2d> profile, const Circle& before) {
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
  Vector3d right_side = Vector3d::Zero();
  std::size_t count = 0;
  for (const Eigen::Vector2d& q : profile) {
    if (!is_rear(q - before.centre, before.radius)) continue;
    const Vector3d terms(2.0 * q[0], 2.0 * q[1], 1.0);
    normal_matrix += terms * terms.transpose();
    right_side += q.squaredNorm() * terms;
    ++count;
  }
  constexpr std::size_t fewest = 12;
  if (count < fewest) return std::nullopt;
  const Vector3d c = normal_matrix.ldlt().solve(right_side);
  const double square = c[2] + c.head<2>().squaredNorm();
  if (!c.allFinite() || !(square > 0.0)) return std::nullopt;
  return Circle{c.head<2>(), std::sqrt(square)};
}

constexpr double usual_condyle = 20.0;  // mm: radius of its rear

/// The centre of the rear of the condyle that ends at `rearmost`; nothing where it is not round, or has few vertices.
std::optional<Vector3d> centre_of_rear(std::span<const Vector3d> distal, const Vector3d& rearmost,
                                       const Vector3d& sideways, const Profile& seen) {
  constexpr double slice = 6.0;  // mm to both sides
  std::vector<Eigen::Vector2d> profile;
  for (const Vector3d& x : distal) {
    const Vector3d d = x - rearmost;
    if (std::fabs(sideways.dot(d)) < slice) profile.emplace_back(seen.back.dot(d), seen.up.dot(d));
  }
  Circle circle{{-usual_condyle, 0.0}, usual_condyle};
  constexpr int steps = 30;
  for (int i = 0; i < steps; ++i) {
    const std::optional<Circle> next = next_circle(profile, circle);
    if (!next || next->radius < 0.5 * usual_condyle || next->radius > 2.0 * usual_condyle) return std::nullopt;
    circle = *next;
  }
  return rearmost + circle.centre[0] * seen.back + circle.centre[1] * seen.up;
}

/// The epicondyles carry the ligaments about which the knee turns. So they are the part of the surface near the axis
/// through the centres of the condyles' rears (Hollister et al. 1993), not edges before or above it that reach as far
/// out. All vertices if that axis is not known.
std::vector<Vector3d> beside_axis(std::span<const Vector3d> distal, const Condyles& found, const Vector3d& sideways,
                                  const Profile& seen) {
  const std::optional<Vector3d> medial = centre_of_rear(distal, found.medial_posterior, sideways, seen);
  const std::optional<Vector3d> lateral = centre_of_rear(distal, found.lateral_posterior, sideways, seen);
  std::vector<Vector3d> beside;
  if (medial && lateral) {
    const Vector3d axis = (*medial - *lateral).normalized();
    std::ranges::copy_if(distal, std::back_inserter(beside),
                         [&](const Vector3d& x) { return axis.cross(x - *lateral).norm() < 0.5 * usual_condyle; });
  }
  constexpr std::size_t fewest = 2;
  if (beside.size() < fewest) beside.assign(distal.begin(), distal.end());
  return beside;
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
    const std::vector<Vector3d> medial_half = side(1.0);
    const std::vector<Vector3d> lateral_half = side(-1.0);
    found.medial_posterior = most_prominent(medial_half, medial_half, back);
    found.lateral_posterior = most_prominent(lateral_half, lateral_half, back);
  }
  const Profile seen_from_aside{handedness * shaft.direction.cross(sideways), shaft.direction};
  const std::vector<Vector3d> beside = beside_axis(distal, found, sideways, seen_from_aside);
  found.medial_epicondyle = most_prominent(beside, distal, sideways);
  found.lateral_epicondyle = most_prominent(beside, distal, -sideways);
  return found;
}

}  // namespace verisq::features
