/// The boundary of a model's solid by dense samples in long double, each with its area and its distance from a mesh:
/// what proven areas, means and percentiles must contain. Shares nothing with verify/.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/deviation/brute_force.hpp"
#include "tests/oracle/exact_membership.hpp"

namespace verisq::testing {

/// Of a point on the surface of this primitive: whether it decides which points near it are of the solid.
inline bool is_boundary(const Model& model, const oracle::ExactMembership& membership, std::size_t primitive,
                        const Point& x) {
  const oracle::Vector exact{oracle::Real(x[0]), oracle::Real(x[1]), oracle::Real(x[2])};
  const auto in_primitive = [&](std::uint32_t i) {
    return i == primitive ? oracle::Membership::boundary : membership.in_primitive(i, exact);
  };
  return oracle::membership(model, in_primitive) == oracle::Membership::boundary;
}

struct SampledDistance {
  double distance;
  double area;
  std::size_t primitive;
};

struct SampledSurface {
  std::vector<SampledDistance> samples;  ///< by distance

  [[nodiscard]] double area_within(double distance) const {
    double area = 0.0;
    for (const SampledDistance& sample : samples) area += sample.distance <= distance ? sample.area : 0.0;
    return area;
  }
  /// Of those of the primitives that count, all where `counted` is empty.
  [[nodiscard]] SampledSurface of(const std::vector<bool>& counted) const {
    SampledSurface result = *this;
    std::erase_if(result.samples, [&](const SampledDistance& s) { return !counted.empty() && !counted[s.primitive]; });
    return result;
  }
  [[nodiscard]] double area() const { return area_within(HUGE_VAL); }
  [[nodiscard]] double mean() const {
    double moment = 0.0;
    for (const SampledDistance& sample : samples) moment += sample.distance * sample.area;
    return moment / area();
  }
  [[nodiscard]] double percentile(double percent) const {
    double reached = 0.0;
    for (const SampledDistance& sample : samples) {
      reached += sample.area;
      if (reached >= percent / 100.0 * area()) return sample.distance;
    }
    return samples.back().distance;
  }
};

/// On a grid of latitude and longitude, whose cells are weighed by the triangles of their corners.
inline SampledSurface sampled_surface(const Model& model, const Mesh& mesh, int steps) {
  SampledSurface surface;
  const oracle::ExactMembership membership(model);
  const Long half = std::numbers::pi_v<Long> / 2;
  const auto area_of = [](const Point& a, const Point& b, const Point& c) {
    const LongPoint normal = cross(difference(widened(b), widened(a)), difference(widened(c), widened(a)));
    return std::sqrt(dot(normal, normal)) / 2;
  };
  for (std::size_t k = 0; k < model.primitives.size(); ++k) {
    const auto at = [&](Long row, Long column) {
      return surface_point(model.primitives[k], half * row / steps, half * column / steps);
    };
    for (int row = -steps; row < steps; ++row) {
      for (int column = 0; column < 4 * steps; ++column) {
        const Point middle = at(row + 0.5L, column + 0.5L);
        if (!is_boundary(model, membership, k, middle)) continue;
        const Point a = at(row, column);
        const Point c = at(row + 1, column + 1);
        const Long area = area_of(a, at(row, column + 1), c) + area_of(a, at(row + 1, column), c);
        Long distance = HUGE_VALL;
        for (const Point& p : mesh.vertices)
          if (mesh.triangles.empty()) distance = std::min(distance, distance_to_triangle(middle, {p, p, p}));
        if (!mesh.triangles.empty()) distance = distance_to_mesh(middle, mesh);
        surface.samples.push_back({static_cast<double>(distance), static_cast<double>(area), k});
      }
    }
  }
  std::ranges::sort(surface.samples, {}, &SampledDistance::distance);
  return surface;
}

}  // namespace verisq::testing
