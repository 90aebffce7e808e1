/// Sections along the guess, each of which turns it to its own centroid; then the least perimeter by Nelder and Mead.
#include "host/features/neck_section.hpp"

#include <nlopt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "host/features/plane_section.hpp"
#include "host/mesh/eigen_points.hpp"

namespace verisq::features {
namespace {

using Eigen::Vector3d;

constexpr double nearest_section = 0.75;  // head radii from the head's centre
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
      const double distance = nearest_section + (farthest_section - nearest_section) * i / tries;
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
    // Nelder and Mead compare, so a number that is larger than every perimeter says "none".
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
  const std::array lower{-most_turned, -most_turned, nearest_section};
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

}  // namespace verisq::features
