/// Sections across a first guess; the narrow ones about the narrowest; the line through their centroids; again.
#include "host/features/shaft_axis.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "host/features/plane_section.hpp"
#include "host/mesh/eigen_points.hpp"

namespace verisq::features {
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

/// Those about the narrowest that are not much wider. The ends taper off: from the distal one the narrowest counts only
/// beyond where sections stop growing.
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

}  // namespace verisq::features
