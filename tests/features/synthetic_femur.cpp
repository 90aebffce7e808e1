/// Marching tetrahedra over a grid; each vertex is moved along its edge onto the surface.
#include "tests/features/synthetic_femur.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <vector>

namespace verisq {
namespace {

using Eigen::Vector3d;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

double capsule(const Vector3d& x, const Vector3d& a, const Vector3d& b, double radius) {
  const Vector3d d = b - a;
  const double t = std::clamp(d.dot(x - a) / d.squaredNorm(), 0.0, 1.0);
  return (x - a - t * d).norm() - radius;
}

constexpr double shaft_radius = 14.0;
constexpr double neck_radius = 15.0;
constexpr double condyles_apart = 26.0;  // of each from the middle
constexpr double condyles_back = 18.0;

const Vector3d condyle_size(22.0, 28.0, 15.0);  // semi-axes of ellipsoids

/// Negative inside; of a right femur.
double level(const SyntheticFemur& femur, const Vector3d& x) {
  const Vector3d origin = Vector3d::Zero();
  const Vector3d knee(0.0, -femur.shaft_length, 0.0);
  double least = std::min((x - femur.head_centre()).norm() - femur.head_radius,
                          capsule(x, origin, femur.head_centre(), neck_radius));
  least = std::min(least, capsule(x, origin, knee, shaft_radius));
  if (!femur.condyles) return std::max(least, -femur.shaft_length - x[1]);
  for (const double side : {-1.0, 1.0}) {
    const Vector3d centre = knee + Vector3d(-condyles_back, 0.0, side * condyles_apart);
    least = std::min(least, condyle_size.minCoeff() * ((x - centre).cwiseQuotient(condyle_size).norm() - 1.0));
  }
  if (femur.ridge) least = std::min(least, (x - knee - Vector3d(0.0, 0.0, condyles_apart + 12.0)).norm() - 5.0);
  return least;
}

class Marching {
 public:
  Marching(const SyntheticFemur& femur, double step) : femur_(femur), step_(step) {
    const double reach = femur.head_radius + femur.neck_length + 2.0;
    // Off the solids' planes of symmetry: no corner of the grid lies on the surface.
    lowest_ = {-reach - 0.137, -femur.shaft_length - 32.291, -reach - 0.173};
    const Vector3d highest(reach, reach, std::max(reach, 60.0));
    for (std::size_t k = 0; k < 3; ++k)
      counts_[k] = static_cast<std::uint32_t>((highest[static_cast<int>(k)] - lowest_[static_cast<int>(k)]) / step) + 2;
    levels_.resize(std::size_t{counts_[0]} * counts_[1] * counts_[2]);
    for (std::uint32_t i = 0; i < levels_.size(); ++i) levels_[i] = level(femur, place(i));
  }

  Mesh mesh() {
    for (std::uint32_t z = 0; z + 1 < counts_[2]; ++z)
      for (std::uint32_t y = 0; y + 1 < counts_[1]; ++y)
        for (std::uint32_t x = 0; x + 1 < counts_[0]; ++x) add_cell(x, y, z);
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::uint32_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (z * counts_[1] + y) * counts_[0] + x;
  }
  [[nodiscard]] Vector3d place(std::uint32_t i) const {
    const std::uint32_t x = i % counts_[0];
    const std::uint32_t y = i / counts_[0] % counts_[1];
    const std::uint32_t z = i / counts_[0] / counts_[1];
    return lowest_ + step_ * Vector3d(x, y, z);
  }

  void add_cell(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    // Kuhn's six tetrahedra: the ways along the axes from one corner to the opposite one.
    constexpr std::array<std::array<int, 3>, 6> orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (const auto& order : orders) {
      std::array<std::uint32_t, 3> at{x, y, z};
      std::array<std::uint32_t, 4> corners{index(x, y, z), 0, 0, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        ++at[static_cast<std::size_t>(order[k])];
        corners[k + 1] = index(at[0], at[1], at[2]);
      }
      add_tetrahedron(corners);
    }
  }

  void add_tetrahedron(const std::array<std::uint32_t, 4>& corners) {
    std::vector<std::uint32_t> in;
    std::vector<std::uint32_t> out;
    for (const std::uint32_t corner : corners) (levels_[corner] < 0.0 ? in : out).push_back(corner);
    if (in.empty() || out.empty()) return;
    if (in.size() == 1) {
      add(vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2]), in[0]);
    } else if (out.size() == 1) {
      add(vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0]), in[0]);
    } else {
      const std::uint32_t a = vertex(in[0], out[0]);
      const std::uint32_t c = vertex(in[1], out[1]);
      add(a, vertex(in[0], out[1]), c, in[0]);
      add(a, c, vertex(in[1], out[0]), in[0]);
    }
  }

  /// Facing away from a corner inside.
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t inside) {
    const auto at = [&](std::uint32_t i) { return Vector3d(mesh_.vertices[i].data()); };
    const Vector3d normal = (at(b) - at(a)).cross(at(c) - at(a));
    if (normal.dot(place(inside) - at(a)) > 0.0) std::swap(b, c);
    mesh_.triangles.push_back({a, b, c});
  }

  std::uint32_t vertex(std::uint32_t in, std::uint32_t out) {
    const std::uint64_t key = (std::uint64_t{in} << 32U) | out;
    const auto [found, is_new] = vertices_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) {
      Vector3d a = place(in);
      Vector3d b = place(out);
      for (int i = 0; i < 50; ++i) {
        const Vector3d middle = 0.5 * (a + b);
        (level(femur_, middle) < 0.0 ? a : b) = middle;
      }
      mesh_.vertices.push_back({b[0], b[1], b[2]});
    }
    return found->second;
  }

  SyntheticFemur femur_;
  double step_;
  Vector3d lowest_;
  std::array<std::uint32_t, 3> counts_{};
  std::vector<double> levels_;
  std::unordered_map<std::uint64_t, std::uint32_t> vertices_;
  Mesh mesh_;
};

}  // namespace

/// Medial of a right femur is -z.
Vector3d SyntheticFemur::head_centre() const {
  const double across = neck_length * std::sin(radians(ccd_degrees));
  return {across * std::sin(radians(version_degrees)), -neck_length * std::cos(radians(ccd_degrees)),
          -across * std::cos(radians(version_degrees))};
}

double SyntheticFemur::offset() const {
  return neck_length * std::sin(radians(ccd_degrees));
}

Mesh mesh_of(const SyntheticFemur& femur, Side side, double step) {
  Mesh mesh = Marching(femur, step).mesh();
  if (side == Side::left) {
    for (Point& x : mesh.vertices) x[2] = -x[2];
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

}  // namespace verisq
