/// Fits of closed meshes: distances and gradients that the search climbs by, and what it finds of a tessellated solid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/requirements.hpp"
#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/random.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verisq/clearance.hpp"
#include "verisq/distance.hpp"
#include "verisq/fit.hpp"
#include "verisq/map.hpp"

namespace verisq {
namespace {

using fit_search::Candidate;
using fit_search::CandidateSpace;
using fit_search::Evaluation;
using fit_search::Parameters;
using fit_search::PointDistance;
using verisq::testing::join;
using verisq::testing::moved;
using verisq::testing::Random;
using verisq::testing::sphere_mesh;
using verisq::testing::star_mesh;
using verisq::testing::stretched;
using verisq::testing::turned;

constexpr Point semi_axes{3.0, 4.0, 8.0};
constexpr Pose place{{0.3, -0.2, 0.5}, {0.95, 0.1, -0.2, 0.1}};

/// No point of the tessellated ellipsoid is farther from the ellipsoid: 8 times as much as of the sphere.
double off_ellipsoid() {
  return 8.0 * (1.0 + verify::ClosedMesh(sphere_mesh(4)).signed_distance({0.0, 0.0, 0.0}).signed_distance.hi);
}

Model ellipsoid() {
  return {"mm", {{"body", {semi_axes, {1.0, 1.0}}, place}}};
}

Model tessellated() {
  return {"mm", {mesh_primitive("body", stretched(sphere_mesh(4), semi_axes), place)}};
}

std::vector<Point> random_points(std::size_t count, double size) {
  Random random(5);
  std::vector<Point> points(count);
  for (Point& point : points)
    for (double& x : point) x = random.uniform(-size, size);
  return points;
}

std::vector<PointDistance> distances(const Model& model, const std::vector<Point>& points,
                                     const Parameters& parameters) {
  const CandidateSpace space(model, {{}, 5.0, 30.0});
  const std::vector<double> weights(points.size(), 1.0);
  std::vector<PointDistance> found;
  fit_search::host_candidate_evaluator(points, weights)->distances(space.candidate(parameters), found);
  return found;
}

const Parameters aside{0.5, -0.3, 0.2, 0.1, -0.2, 0.15};

TEST(MeshFit, DistancesAreThoseOfAMap) {
  const std::vector<Point> points = random_points(500, 12.0);
  const Model model{"", {mesh_primitive("star", moved(star_mesh(2, 3), 5.0), place)}};
  const CandidateSpace space(model, {{}, 5.0, 30.0});
  const std::vector<PointDistance> found = distances(model, points, aside);
  std::vector<MapResult> rows(points.size());
  (void)PointMapper(posed(model, space.pose(aside)), {.tolerance = 1e-12, .device = "host"}).map(points, rows);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(found[i].distance, rows[i].distance.lo, 1e-12);
    EXPECT_NEAR(std::hypot(found[i].normal[0], found[i].normal[1], found[i].normal[2]), 1.0, 1e-9);
  }
}

TEST(MeshFit, DistancesAreThoseOfTheTessellatedSolid) {
  const std::vector<Point> points = random_points(500, 12.0);
  const std::vector<PointDistance> exact = distances(ellipsoid(), points, aside);
  const std::vector<PointDistance> found = distances(tessellated(), points, aside);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_GE(found[i].distance, exact[i].distance - 1e-9) << "inscribed";
    EXPECT_LE(found[i].distance, exact[i].distance + off_ellipsoid() + 1e-9);
  }
}

TEST(MeshFit, GradientIsThatOfTheObjective) {
  const std::vector<Point> points = random_points(40, 12.0);
  const std::vector<double> weights(points.size(), 1.0);
  const Model model = tessellated();
  const CandidateSpace space(model, {{}, 5.0, 30.0});
  const auto evaluator = fit_search::host_candidate_evaluator(points, weights);
  const Fitness fitness = cementless(2.0, 0.0);
  const auto at = [&](const Parameters& parameters) {
    const Candidate candidate = space.candidate(parameters);
    std::vector<Evaluation> found;
    evaluator->evaluate({&candidate, 1}, fitness, {}, 1, found);
    return found.front();
  };
  const Evaluation here = at(aside);
  const Parameters gradient = space.gradient(aside, here.pose_gradient, here.size_gradient);
  ASSERT_EQ(gradient.size(), 6U) << "a mesh has no sizes to choose";
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    constexpr double step = 1e-6;
    Parameters above = aside;
    Parameters below = aside;
    above[i] += step;
    below[i] -= step;
    EXPECT_NEAR(gradient[i], (at(above).objective - at(below).objective) / (2.0 * step),
                1e-4 * std::max(1.0, std::abs(gradient[i])));
  }
}

/// The cavity has play all around. The best poses of solid and mesh serve about alike.
TEST(MeshFit, FindsAsGoodAPoseAsOfTheTessellatedSolid) {
  const Mesh bone = stretched(sphere_mesh(3), {3.6, 4.6, 8.6});
  const Cavity cavity{
      bone.vertices, {{"all", 1.0}}, std::vector<std::uint32_t>(bone.vertices.size(), 0), bone.triangles};
  const FitOptions options{.fitness = cementless(2.0, 0.0),
                           .penetration_limit = 0.0,
                           .surface_tolerance = 1e-3,
                           .range = {{}, 1.0, 20.0},
                           .sides = {{SurfaceSide::inside}},
                           .samples = 256,
                           .device = "host"};
  const std::vector<UncertainModel> solid{UncertainModel(ellipsoid())};
  const std::vector<UncertainModel> mesh{UncertainModel(tessellated())};
  const Fit of_solid = fit(solid, cavity, options);
  const Fit of_mesh = fit(mesh, cavity, options);
  EXPECT_TRUE(of_solid.within_limit);
  EXPECT_TRUE(of_mesh.within_limit);
  EXPECT_EQ(of_mesh.device, "host");
  EXPECT_GT(of_mesh.objective, 0.98 * of_solid.objective);
  EXPECT_EQ(prove_sides(of_mesh.model, bone, options.sides[0], 0.0).of_primitives[0], SideFinding::kept);
  const MeshClearance clearance = mesh_clearance(of_mesh.model, bone, {.tolerance = 1e-3, .device = "host"});
  EXPECT_EQ(clearance.proven_within, bone.triangles.size());
}

/// Nothing of a shell lies inside it but for its wall.
TEST(MeshFit, SamplesLieInTheSolid) {
  const Mesh shell = join(sphere_mesh(3), turned(moved(sphere_mesh(3), 0.6)));
  for (const Mesh& mesh : {sphere_mesh(2), shell, moved(star_mesh(2, 3), 1e-3)}) {
    const fit_search::SolidMesh solid(mesh);
    EXPECT_GT(solid.samples.size(), 10U);
    for (const Point& sample : solid.samples) EXPECT_LE(solid.solid.signed_distance(sample).signed_distance.hi, 0.0);
  }
  const Mesh thin = join(sphere_mesh(3), turned(moved(sphere_mesh(3), 1.0 - 1e-9)));
  for (const Point& sample : fit_search::SolidMesh(thin).samples)
    EXPECT_NEAR(std::hypot(sample[0], sample[1], sample[2]), 1.0, 0.01);
}

TEST(MeshFit, SizesCountTheVolumeWhateverItsOrientation) {
  const double volume = implant_size(tessellated());
  EXPECT_NEAR(volume, implant_size(ellipsoid()), 0.01 * volume);
  EXPECT_DOUBLE_EQ(implant_size({"", {mesh_primitive("", turned(sphere_mesh(2)))}}),
                   implant_size({"", {mesh_primitive("", sphere_mesh(2))}}));
}

}  // namespace
}  // namespace verisq
