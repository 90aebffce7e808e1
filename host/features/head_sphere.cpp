/// Spheres of pairs of surface elements whose normals meet; the one that most surface agrees with; least squares.
#include "host/features/head_sphere.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "host/mesh/eigen_points.hpp"

namespace verisq::features {
namespace {

using Eigen::Vector3d;

struct Element {
  Vector3d place;
  Vector3d normal;
  double area;
};

/// About each vertex a third of its triangles: vertices lie on the surface, centroids of triangles below it.
std::vector<Element> surface_elements(const Mesh& mesh) {
  std::vector<Element> elements(mesh.vertices.size());
  for (std::size_t i = 0; i < elements.size(); ++i) elements[i] = {vector_of(mesh.vertices[i]), Vector3d::Zero(), 0.0};
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vector3d a = vector_of(mesh.vertices[i]);
    const Vector3d cross = (vector_of(mesh.vertices[j]) - a).cross(vector_of(mesh.vertices[k]) - a);
    for (const std::uint32_t vertex : {i, j, k}) {
      elements[vertex].normal += cross;
      elements[vertex].area += cross.norm() / 6.0;
    }
  }
  std::erase_if(elements, [](const Element& element) { return element.area == 0.0 || element.normal.norm() == 0.0; });
  for (Element& element : elements) element.normal.normalize();
  return elements;
}

constexpr std::size_t sample_size = 2'000;
constexpr int proposals = 20'000;
constexpr double normals_agree = 0.9;  // cosine: of noisy surfaces, too

bool agrees(const Element& element, const Vector3d& centre, double radius, double tolerance) {
  const Vector3d out = element.place - centre;
  const double distance = out.norm();
  return std::fabs(distance - radius) <= tolerance && out.dot(element.normal) >= normals_agree * distance;
}

/// Each element as often as its share of the area, evenly spaced.
std::vector<Element> even_sample(const std::vector<Element>& elements, double area) {
  std::vector<Element> sample;
  const double step = area / static_cast<double>(sample_size);
  double next = 0.5 * step;
  double passed = 0.0;
  for (const Element& element : elements) {
    passed += element.area;
    for (; next < passed; next += step) sample.push_back(element);
  }
  return sample;
}

/// The sphere that both normals point away from: least squares of the meeting.
std::optional<HeadSphere> sphere_of(const Element& a, const Element& b) {
  const Vector3d normals = a.normal - b.normal;
  const double size = normals.squaredNorm();
  if (size < 0.1) return std::nullopt;
  const double radius = (a.place - b.place).dot(normals) / size;
  if (!(smallest_head <= radius && radius <= largest_head)) return std::nullopt;
  const Vector3d from_a = a.place - radius * a.normal;
  const Vector3d from_b = b.place - radius * b.normal;
  if ((from_a - from_b).norm() > 2.0) return std::nullopt;
  return HeadSphere{0.5 * (from_a + from_b), radius, 0.0};
}

std::optional<HeadSphere> best_proposal(const std::vector<Element>& sample, double area_of_each) {
  std::mt19937 random(1);  // any seed: the same sphere for the same mesh
  std::uniform_int_distribution<std::size_t> any(0, sample.size() - 1);
  std::optional<HeadSphere> best;
  for (int i = 0; i < proposals; ++i) {
    const std::optional<HeadSphere> sphere = sphere_of(sample[any(random)], sample[any(random)]);
    if (!sphere) continue;
    const double tolerance = 0.05 * sphere->radius;
    const auto agreeing = static_cast<double>(std::ranges::count_if(
        sample, [&](const Element& e) { return agrees(e, sphere->centre, sphere->radius, tolerance); }));
    const double coverage = agreeing * area_of_each / (4.0 * std::numbers::pi * sphere->radius * sphere->radius);
    if (!best || coverage > best->coverage) best = HeadSphere{sphere->centre, sphere->radius, coverage};
  }
  return best;
}

/// Gauss's and Newton's step of the least squares of |x - c| - r.
void step_to_least_squares(HeadSphere& sphere, const std::vector<Element>& elements, double tolerance) {
  Eigen::Matrix4d normal_matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right_side = Eigen::Vector4d::Zero();
  for (const Element& element : elements) {
    if (!agrees(element, sphere.centre, sphere.radius, tolerance)) continue;
    const Vector3d out = element.place - sphere.centre;
    Eigen::Vector4d gradient;
    gradient << -out.normalized(), -1.0;
    normal_matrix += element.area * gradient * gradient.transpose();
    right_side -= element.area * (out.norm() - sphere.radius) * gradient;
  }
  const Eigen::Vector4d step = normal_matrix.ldlt().solve(right_side);
  if (!step.allFinite() || step.norm() > sphere.radius) return;
  sphere.centre += step.head<3>();
  sphere.radius += step[3];
}

/// Three times the median of the residuals of what agrees to 5 % of the radius: the neck's edge and the fovea drop out.
double tolerance_of(const HeadSphere& sphere, const std::vector<Element>& elements) {
  std::vector<double> residuals;
  for (const Element& element : elements) {
    if (agrees(element, sphere.centre, sphere.radius, 0.05 * sphere.radius))
      residuals.push_back(std::fabs((element.place - sphere.centre).norm() - sphere.radius));
  }
  if (residuals.empty()) return 0.0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle);
  return std::max(3.0 * *middle, 1e-6 * sphere.radius);
}

double coverage_of(const HeadSphere& sphere, const std::vector<Element>& elements) {
  double area = 0.0;
  for (const Element& element : elements) {
    if (agrees(element, sphere.centre, sphere.radius, 0.05 * sphere.radius)) area += element.area;
  }
  return area / (4.0 * std::numbers::pi * sphere.radius * sphere.radius);
}

}  // namespace

std::optional<HeadSphere> head_sphere(const Mesh& mesh) {
  const std::vector<Element> elements = surface_elements(mesh);
  double area = 0.0;
  for (const Element& element : elements) area += element.area;
  const std::vector<Element> sample = even_sample(elements, area);
  if (sample.empty()) return std::nullopt;
  std::optional<HeadSphere> found = best_proposal(sample, area / static_cast<double>(sample_size));
  if (!found) return std::nullopt;
  constexpr int steps = 30;
  for (int i = 0; i < steps; ++i) step_to_least_squares(*found, elements, tolerance_of(*found, elements));
  found->coverage = coverage_of(*found, elements);
  return found;
}

}  // namespace verisq::features
