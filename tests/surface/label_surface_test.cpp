/// Surfaces of labels: how far from the solid that was turned into voxels, and how its normals lie.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <verisq/surface.hpp>

#include "host/surface/surface_steps.hpp"
#include "tests/fixtures/error_matchers.hpp"

namespace verisq {
namespace {

using testing::expect_error;

/// A capsule of radius 6 about the points within 12 of `centre` along an oblique axis.
struct Capsule {
  Point centre{3.1, -2.3, 40.7};
  Point axis{0.36, 0.48, 0.8};
  double radius = 6.0;
  double half_length = 12.0;

  [[nodiscard]] double volume() const {
    return std::numbers::pi * radius * radius * (2.0 * half_length + 4.0 / 3.0 * radius);
  }
  /// From the axis of the capsule to the point, the way.
  [[nodiscard]] Point from_axis(const Point& x) const {
    double along = 0.0;
    for (std::size_t i = 0; i < 3; ++i) along += (x[i] - centre[i]) * axis[i];
    along = std::clamp(along, -half_length, half_length);
    Point way{};
    for (std::size_t i = 0; i < 3; ++i) way[i] = x[i] - centre[i] - along * axis[i];
    return way;
  }
};

double length(const Point& x) {
  return std::hypot(x[0], x[1], x[2]);
}

/// Label 5 within the capsule, label 2 within three more around it.
LabelVolume voxels_of(const Capsule& capsule, const Point& spacing, bool mirrored) {
  LabelVolume volume{.counts = {},
                     .origin = {},
                     .steps = {Point{spacing[0], 0, 0}, Point{0, spacing[1], 0}, Point{0, 0, spacing[2]}},
                     .space = AnatomicalSpace::lps,
                     .labels = {}};
  const double reach = capsule.half_length + capsule.radius + 5.0;
  for (std::size_t i = 0; i < 3; ++i) {
    volume.counts[i] = static_cast<std::size_t>(2.0 * reach / spacing[i]);
    volume.origin[i] = capsule.centre[i] - reach;
  }
  if (mirrored) {
    volume.origin[1] += static_cast<double>(volume.counts[1] - 1) * spacing[1];
    volume.steps[1][1] = -spacing[1];
  }
  for (std::size_t k = 0; k < volume.counts[2]; ++k) {
    for (std::size_t j = 0; j < volume.counts[1]; ++j) {
      for (std::size_t i = 0; i < volume.counts[0]; ++i) {
        Point x = volume.origin;
        x[0] += static_cast<double>(i) * volume.steps[0][0];
        x[1] += static_cast<double>(j) * volume.steps[1][1];
        x[2] += static_cast<double>(k) * volume.steps[2][2];
        const double depth = capsule.radius - length(capsule.from_axis(x));
        volume.labels.push_back(depth >= 0.0 ? 5 : depth >= -3.0 ? 2 : 0);
      }
    }
  }
  return volume;
}

struct Deviation {
  double root_mean_square;
  double largest;
  double mean_degrees;  ///< between the normals of triangles and of the capsule
};

Deviation deviation_of(const Mesh& mesh, const Capsule& capsule) {
  double squares = 0.0;
  double largest = 0.0;
  for (const Point& x : mesh.vertices) {
    const double off = length(capsule.from_axis(x)) - capsule.radius;
    squares += off * off / static_cast<double>(mesh.vertices.size());
    largest = std::max(largest, std::abs(off));
  }
  double degrees = 0.0;
  double areas = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Point& p = mesh.vertices[a];
    const Point& q = mesh.vertices[b];
    const Point& r = mesh.vertices[c];
    const Point u{q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const Point v{r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    const Point normal{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const Point there =
        capsule.from_axis({(p[0] + q[0] + r[0]) / 3, (p[1] + q[1] + r[1]) / 3, (p[2] + q[2] + r[2]) / 3});
    const double dot = normal[0] * there[0] + normal[1] * there[1] + normal[2] * there[2];
    const double angle = std::acos(std::clamp(dot / (length(normal) * length(there)), -1.0, 1.0));
    degrees += length(normal) * angle * 180.0 / std::numbers::pi;
    areas += length(normal);
  }
  return {std::sqrt(squares), largest, degrees / areas};
}

PreparedSurface as_the_command_prepares(const Mesh& mesh, double edge) {
  return prepare_surface(mesh, {.method = SurfaceMethod::given, .smoothing_rounds = 20, .edge = edge});
}

/// Below a tenth of a voxel on average, normals within five degrees: the numbers that docs/formats.md tells.
TEST(LabelSurfaces, AreThoseOfTheSolid) {
  const Capsule capsule;
  for (const bool mirrored : {false, true}) {
    const LabelVolume volume = voxels_of(capsule, {0.8, 0.8, 1.0}, mirrored);
    const LabelSurface surface = label_surface(volume, 5);
    EXPECT_TRUE(mesh_topology(surface.mesh).bounds_solid());
    EXPECT_EQ(surface.parts_left_out, 0U);
    EXPECT_EQ(surface.voxels_at_border, 0U);
    EXPECT_NEAR(static_cast<double>(surface.voxels) * voxel_volume(volume), capsule.volume(), 0.01 * capsule.volume());
    const PreparedSurface prepared = as_the_command_prepares(surface.mesh, 1.3);
    EXPECT_TRUE(mesh_topology(prepared.mesh).bounds_solid());
    EXPECT_FALSE(check_surface(prepared.mesh, {}).self_intersecting);
    EXPECT_NEAR(signed_volume(prepared.mesh), capsule.volume(), 0.02 * capsule.volume());
    const Deviation deviation = deviation_of(prepared.mesh, capsule);
    EXPECT_LT(deviation.root_mean_square, 0.09);
    EXPECT_LT(deviation.largest, 0.5);
    EXPECT_LT(deviation.mean_degrees, 5.0);
  }
}

TEST(LabelSurfaces, OfALabelWithAVoidAreTheOuterOnes) {
  const Capsule capsule;
  const LabelSurface surface = label_surface(voxels_of(capsule, {1.0, 1.0, 1.0}, false), 2);
  EXPECT_EQ(surface.parts_left_out, 1U);
  const Capsule outer{.radius = capsule.radius + 3.0};
  EXPECT_NEAR(signed_volume(surface.mesh), outer.volume(), 0.03 * outer.volume());
}

TEST(LabelSurfaces, AreClosedAtTheBorderOfTheVolume) {
  const LabelVolume block{.counts = {20, 18, 16},
                          .origin = {},
                          .steps = {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}},
                          .labels = std::vector<std::uint16_t>(5760, 1)};
  const LabelSurface surface = label_surface(block, 1);
  EXPECT_EQ(surface.voxels_at_border, 5760U - 18U * 16U * 14U);
  EXPECT_TRUE(mesh_topology(surface.mesh).bounds_solid());
  EXPECT_NEAR(signed_volume(surface.mesh), 5760.0, 0.03 * 5760.0);  // edges and corners are rounded off
}

TEST(LabelSurfaces, NeedVoxels) {
  LabelVolume volume{.counts = {9, 9, 9},
                     .origin = {},
                     .steps = {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}},
                     .labels = std::vector<std::uint16_t>(729, 0)};
  expect_error([&] { (void)label_surface(volume, 3); }, ErrorKind::input, "", "no voxel has the label 3");
  volume.labels[364] = 3;
  expect_error([&] { (void)label_surface(volume, 3); }, ErrorKind::input, "",
               "label 3: it is thinner than a voxel everywhere");
}

/// Nothing smooth about it: every case of a cell comes up, and many at once.
TEST(LevelSurfaces, OfNoiseAreClosedManifoldAndOutward) {
  std::mt19937 generator(7);
  std::uniform_int_distribution<int> value(-2, 2);  // zeros, too
  surface::GridSamples samples{.counts = {14, 13, 12},
                               .origin = {1.0, 2.0, 3.0},
                               .steps = {Point{1.0, 0.1, 0.0}, Point{0.0, -2.0, 0.2}, Point{0.3, 0.0, 1.5}},
                               .values = std::vector<float>(14 * 13 * 12, -1.0F)};
  std::size_t inside = 0;
  for (std::size_t k = 1; k < 11; ++k) {
    for (std::size_t j = 1; j < 12; ++j) {
      for (std::size_t i = 1; i < 13; ++i) {
        const auto noise = static_cast<float>(value(generator));
        samples.values[samples.index(i, j, k)] = noise;
        if (noise > 0.0F) ++inside;
      }
    }
  }
  const Mesh mesh = surface::level_surface(samples);
  EXPECT_TRUE(mesh_topology(mesh).bounds_solid());
  // Outward: a sample inside has its cell, of a little over 3, less what is nearer to neighbours outside.
  EXPECT_GT(signed_volume(mesh), 1.5 * static_cast<double>(inside));
  EXPECT_LT(signed_volume(mesh), 3.1 * 13.0 * 12.0 * 11.0);
}

}  // namespace
}  // namespace verisq
