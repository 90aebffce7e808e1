/// This file implements the head and neck of femur.hpp.
#include <fmt/format.h>
#include <nlopt.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "host/errors/refusal.hpp"
#include "host/prepare/eigen_points.hpp"
#include "host/prepare/femur.hpp"

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

/// Three times the median of the residuals of the elements that agree to 5 % of the radius: the neck's edge and the
/// fovea drop out.
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

void count_cover(HeadSphere& sphere, const std::vector<Element>& elements) {
  double area = 0.0;
  for (const Element& element : elements) {
    if (!agrees(element, sphere.centre, sphere.radius, 0.05 * sphere.radius)) continue;
    area += element.area;
    ++sphere.vertices;
  }
  sphere.coverage = area / (4.0 * std::numbers::pi * sphere.radius * sphere.radius);
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
  count_cover(*found, elements);
  return found;
}

namespace {

using Eigen::Vector3d;

constexpr double farthest_section = 2.2;
constexpr double thinnest_neck = 0.4;  // head radii
constexpr double thickest_neck = 1.15;
constexpr double none = std::numeric_limits<double>::infinity();

/// The bone about the head: all that the planes can cut of the neck.
Mesh bone_near(const Mesh& mesh, const Vector3d& head, double reach) {
  Mesh near{mesh.vertices, {}};
  for (const auto& triangle : mesh.triangles) {
    const bool inside = std::ranges::any_of(
        triangle, [&](std::uint32_t i) { return (vector_of(mesh.vertices[i]) - head).norm() <= reach; });
    if (inside) near.triangles.push_back(triangle);
  }
  return near;
}

class Neck {
 public:
  Neck(const Mesh& mesh, const Vector3d& head, double head_radius)
      : near_(bone_near(mesh, head, 4.0 * head_radius)), head_(head), radius_(head_radius) {}

  /// The curve about the line from the head, `distance` head radii on, if it is a neck's.
  [[nodiscard]] std::optional<SectionCurve> curve(const Vector3d& direction, double distance) const {
    const Vector3d place = head_ + distance * radius_ * direction;
    const Plane plane{direction, direction.dot(place)};
    for (SectionCurve& found : plane_section(near_, plane)) {
      const double size = std::sqrt(std::fabs(found.area) / std::numbers::pi) / radius_;
      if (found.area > 0.0 && thinnest_neck <= size && size <= thickest_neck && encloses(found, plane, place))
        return std::move(found);
    }
    return std::nullopt;
  }

  /// The narrowest of some sections along the direction.
  [[nodiscard]] std::optional<double> narrowest(const Vector3d& direction) const {
    std::optional<double> best;
    double least = none;
    constexpr int tries = 30;
    for (int i = 0; i <= tries; ++i) {
      const double distance = nearest_neck_section + (farthest_section - nearest_neck_section) * i / tries;
      const auto found = curve(direction, distance);
      if (!found || found->perimeter >= least) continue;
      least = found->perimeter;
      best = distance;
    }
    return best;
  }

  [[nodiscard]] const Vector3d& head() const { return head_; }
  [[nodiscard]] double radius() const { return radius_; }

 private:
  Mesh near_;
  Vector3d head_;
  double radius_;
};

/// A plane's direction, turned by two angles from a first one, and its distance.
struct Search {
  const Neck& neck;
  Vector3d direction;

  [[nodiscard]] Vector3d turned(double a, double b) const {
    const Vector3d u = direction.unitOrthogonal();
    return (direction + std::tan(a) * u + std::tan(b) * direction.cross(u)).normalized();
  }

  [[nodiscard]] double perimeter(std::span<const double> at) const {
    const auto found = neck.curve(turned(at[0], at[1]), at[2]);
    // Nelder and Mead's method compares, so a number that is larger than every perimeter means "none".
    return found ? found->perimeter / neck.radius() : 1e3;
  }
};

struct Destroy {
  void operator()(nlopt_opt optimiser) const { nlopt_destroy(optimiser); }
};

double objective(unsigned count, const double* at, double* /*gradient*/, void* search) {
  return static_cast<Search*>(search)->perimeter({at, count});
}

std::array<double, 3> least_perimeter(Search search, double distance) {
  const std::unique_ptr<nlopt_opt_s, Destroy> optimiser(nlopt_create(NLOPT_LN_NELDERMEAD, 3));
  constexpr double most_turned = 0.4;
  const std::array lower{-most_turned, -most_turned, nearest_neck_section};
  const std::array upper{most_turned, most_turned, farthest_section};
  nlopt_set_min_objective(optimiser.get(), objective, &search);
  nlopt_set_lower_bounds(optimiser.get(), lower.data());
  nlopt_set_upper_bounds(optimiser.get(), upper.data());
  nlopt_set_initial_step1(optimiser.get(), 0.05);
  nlopt_set_xtol_abs1(optimiser.get(), 1e-6);
  nlopt_set_maxeval(optimiser.get(), 600);
  std::array<double, 3> best{0.0, 0.0, distance};
  double value = 0.0;
  nlopt_optimize(optimiser.get(), best.data(), &value);
  return best;
}

}  // namespace

std::optional<NeckSection> neck_section(const Mesh& mesh, const Vector3d& head, double head_radius,
                                        const Vector3d& towards_shaft) {
  const Neck neck(mesh, head, head_radius);
  Vector3d direction = towards_shaft.normalized();
  std::optional<double> distance;
  constexpr int turns = 8;
  for (int i = 0; i < turns; ++i) {
    distance = neck.narrowest(direction);
    if (!distance) return std::nullopt;
    const auto found = neck.curve(direction, *distance);
    direction = (found->centroid - head).normalized();
  }
  distance = neck.narrowest(direction);
  if (!distance) return std::nullopt;
  const Search search{neck, direction};
  const auto [a, b, at] = least_perimeter(search, *distance);
  const auto found = neck.curve(search.turned(a, b), at);
  if (!found) return std::nullopt;
  return NeckSection{found->centroid, found->perimeter, at * head_radius};
}

namespace {

constexpr const char* advice = "give landmarks, or a finer mesh";

struct Range {
  const char* feature;
  double lowest;
  double highest;
  bool is_proportion;  ///< range relative to the head's radius, for a length; for angles the range is in degrees
};

/// - ccd: 150 degrees at birth, 120 to 140 of adults, above 140 in valga, down to 80 in a shepherd's crook.
/// - version: 30 to 50 degrees at birth, up to 80 in dysplasia, down to -40 in retroversion. The line of the
///   epicondyles turns it by 6 degrees, more where they are found badly.
/// - anatomical_mechanical_angle: 5 to 7 degrees, more of short femora.
/// - offset: 30 to 60 mm beside a head of a radius of 20 to 28 mm, less in valga, more in vara.
/// - length: 17 to 21 head radii of adults; children's heads are partly cartilage, which images may show or not.
/// - epicondylar_width: 3.2 to 3.8 head radii.
constexpr std::array<Range, 6> ranges{{{"ccd", 75.0, 165.0, false},
                                       {"version", -60.0, 90.0, false},
                                       {"anatomical_mechanical_angle", 0.0, 20.0, false},
                                       {"offset", 0.3, 4.0, true},
                                       {"length", 7.0, 28.0, true},
                                       {"epicondylar_width", 2.0, 6.0, true}}};

void check(const Range& range, const Feature& feature, double head_radius) {
  const double found = 0.5 * (feature.value.lo + feature.value.hi) / (range.is_proportion ? head_radius : 1.0);
  if (range.lowest <= found && found <= range.highest) return;
  refuse(fmt::format("mesh: what was found is no femur's: {} ({}) would be {:.1f} {}, and bones have {:g} to {:g}; {}",
                     feature.name, feature.method, found,
                     range.is_proportion ? fmt::format("times the head's radius of {:.1f} mm", head_radius) : "degrees",
                     range.lowest, range.highest, advice));
}

}  // namespace

void check_head_and_neck(const HeadSphere& head, const NeckSection& neck) {
  const std::string sphere = fmt::format(
      "mesh: what was found is no femur's: the sphere of its head, of a radius of {:.1f} mm about ({:.1f}, "
      "{:.1f}, {:.1f}), would be ",
      head.radius, head.centre[0], head.centre[1], head.centre[2]);
  if (!(head.coverage <= 1.0)) {
    refuse(fmt::format("{}covered to {:.0f} %, more than the whole: triangles are too large to tell; {}", sphere,
                       100.0 * head.coverage, advice));
  }
  // Each vertex represents its triangles: with fewer, one of them would be more than 1 % of the sphere.
  constexpr std::size_t fewest_vertices = 40;
  if (head.vertices < fewest_vertices) {
    refuse(
        fmt::format("{}that of {} vertices, and {} can tell it; {}", sphere, head.vertices, fewest_vertices, advice));
  }
  if (neck.distance <= 1.01 * nearest_neck_section * head.radius) {
    refuse(fmt::format("{}no narrower below: its neck would be narrowest {:.1f} mm from its centre, inside of it; {}",
                       sphere, neck.distance, advice));
  }
}

void check_proportions(const FemurLandmarks& landmarks, std::optional<Side> side) {
  for (const Feature& feature : femur_features(landmarks, side, 0.0).features) {
    const auto range = std::ranges::find(ranges, feature.name, &Range::feature);
    if (range != ranges.end()) check(*range, feature, *landmarks.head_radius);
  }
}

}  // namespace verisq::features
