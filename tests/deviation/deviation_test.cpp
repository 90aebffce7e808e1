/// Proven deviations contain those of dense samples both ways, and are hardly wider.
#include "verisq/deviation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

#include "tests/deviation/brute_force.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "verify/search/model_distances.hpp"

namespace verisq::testing {
namespace {

Primitive solid(const std::array<double, 3>& axes, const std::array<double, 2>& exponents, const Point& centre,
                double taper = 1.0) {
  return {"", {axes, exponents, taper}, {centre, {0.9, 0.2, -0.3, 0.1}}, {}};
}

DeviationOptions on_host() {
  DeviationOptions options;
  options.device = "host";
  return options;
}

/// Of both largest distances; each misses the supremum by no more than its samples are apart.
struct Sampled {
  double from_mesh = 0.0;
  double from_model = 0.0;
  double mean = 0.0;  ///< by area over the mesh, about
};

constexpr double tolerance_of_samples = 1e-4;

/// Distances of points to the model's surface, by a map.
std::vector<double> mapped(const Model& model, const std::vector<Point>& points) {
  std::vector<MapResult> rows(points.size());
  PointMapper(model, {.tolerance = tolerance_of_samples}).map(points, rows);
  std::vector<double> distances;
  distances.reserve(rows.size());
  for (const MapResult& row : rows) distances.push_back(std::abs(0.5 * row.distance.lo + 0.5 * row.distance.hi));
  return distances;
}

Sampled by_samples(const Model& model, const Mesh& mesh, int steps, int angles) {
  Sampled sampled;
  std::vector<Point> points;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    for (const Point& p : grid_on(corners_of(mesh, n), steps)) points.push_back(p);
  }
  sampled.from_mesh = std::ranges::max(mapped(model, points));

  // Quadratic functions exactly: corners 1/12 each, the centroid 3/4.
  points.clear();
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const Triangle triangle = corners_of(mesh, n);
    points.insert(points.end(), triangle.begin(), triangle.end());
    Point middle;
    for (std::size_t i = 0; i < 3; ++i) middle[i] = (triangle[0][i] + triangle[1][i] + triangle[2][i]) / 3.0;
    points.push_back(middle);
  }
  const std::vector<double> distances = mapped(model, points);
  Long area = 0;
  Long sum = 0;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const Triangle triangle = corners_of(mesh, n);
    const LongPoint normal = cross(difference(widened(triangle[1]), widened(triangle[0])),
                                   difference(widened(triangle[2]), widened(triangle[0])));
    const Long weight = std::sqrt(dot(normal, normal));
    const double* d = &distances[4 * n];
    sum += weight * ((d[0] + d[1] + d[2]) / 12 + d[3] * 3 / 4);
    area += weight;
  }
  sampled.mean = static_cast<double>(sum / area);

  points.clear();
  for (const Primitive& primitive : model.primitives) {
    for (int i = 0; i <= angles; ++i) {
      for (int j = 0; j < 2 * angles; ++j) {
        const Long pi = std::numbers::pi_v<Long>;
        points.push_back(surface_point(primitive, pi * i / angles - pi / 2, pi * j / angles));
      }
    }
  }
  const std::vector<double> from_surface = mapped(model, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (from_surface[i] > tolerance_of_samples) continue;  // within another primitive
    sampled.from_model = std::max(sampled.from_model, static_cast<double>(distance_to_mesh(points[i], mesh)));
  }
  return sampled;
}

/// `missed`: how much less than the supremum samples may find.
void expect_contains(const Enclosure& found, double sampled, double missed) {
  EXPECT_GE(found.hi, sampled - 2.0 * tolerance_of_samples);
  EXPECT_LE(found.lo, sampled + missed);
  EXPECT_LE(found.width(), 0.05 * found.hi);
}

void expect_proven(const Deviation& found, const Sampled& sampled, double missed) {
  EXPECT_TRUE(found.to_tolerance);
  ASSERT_TRUE(found.from_mesh);
  ASSERT_TRUE(found.from_model);
  expect_contains(found.from_mesh->largest, sampled.from_mesh, missed);
  expect_contains(found.from_model->largest, sampled.from_model, missed);
  expect_contains(*found.hausdorff, std::max(sampled.from_mesh, sampled.from_model), missed);
}

Model ball(double radius, const Point& centre = {0, 0, 0}) {
  return {"mm", {{"ball", {{radius, radius, radius}, {1.0, 1.0}}, {centre}, {}}}, {}};
}

TEST(Deviation, OfASphereFromItsBall) {
  const Mesh mesh = sphere_mesh(1);
  double inner = 1.0;  // to the nearest face
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    inner = std::min(inner, static_cast<double>(distance_to_triangle({0, 0, 0}, corners_of(mesh, n))));
  }
  const Deviation found = deviation(ball(1.0), mesh, on_host());
  EXPECT_TRUE(found.to_tolerance);
  // Radial, both ways.
  for (const Enclosure& e : {found.from_mesh->largest, found.from_model->largest, *found.hausdorff}) {
    EXPECT_LE(e.lo, 1.0 - inner + 1e-15);
    EXPECT_GE(e.hi, 1.0 - inner - 1e-15);
    EXPECT_LE(e.width(), 0.05 * e.hi);
  }
  EXPECT_EQ(found.vertices.size(), mesh.vertices.size());
  EXPECT_LE(found.of_vertices.largest.hi, 1e-12);
  ASSERT_EQ(found.from_mesh->percentiles.size(), 2U);
  EXPECT_LE(found.from_mesh->percentiles[0].lo, found.from_mesh->percentiles[1].hi);
}

TEST(Deviation, OfConcentricSpheresIsTheirDistance) {
  const Mesh mesh = sphere_mesh(3);
  double inner = 1.0;  // all distances lie between this less 0.8 and 0.2
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    inner = std::min(inner, static_cast<double>(distance_to_triangle({0, 0, 0}, corners_of(mesh, n))));
  }
  DeviationOptions options = on_host();
  options.tolerance = 1e-3;
  options.percentiles = {1.0, 50.0, 99.0};
  const Deviation found = deviation(ball(0.8), mesh, options);
  EXPECT_TRUE(found.to_tolerance);
  EXPECT_NEAR(found.from_mesh->largest.hi, 0.2, 1e-3);
  EXPECT_GE(found.from_mesh->largest.hi, 0.2);
  for (const Enclosure& e :
       {*found.from_mesh->mean, found.from_mesh->percentiles[0], found.from_mesh->percentiles[2]}) {
    EXPECT_GE(e.lo, inner - 0.8 - 1e-3);
    EXPECT_LE(e.hi, 0.2 + 1e-3);
    EXPECT_LE(e.width(), 1e-3);
  }
  EXPECT_LE(found.hausdorff->width(), 1e-3);
}

TEST(Deviation, ContainsThatOfSamplesForAUnion) {
  const Model model{
      "",
      {solid({1.0, 0.6, 0.8}, {0.5, 1.0}, {0, 0, 0}), solid({0.5, 0.5, 1.2}, {1.0, 0.7}, {0.7, 0.3, 0.2}, 2.0)},
      {}};
  const Mesh mesh = surface_mesh(solid({1.3, 0.8, 1.1}, {1.0, 1.0}, {0.3, 0.1, 0.1}), 10);
  const Deviation found = deviation(model, mesh, {});
  const Sampled sampled = by_samples(model, mesh, 6, 24);
  expect_proven(found, sampled, 0.03);
  EXPECT_LE(found.from_mesh->mean->lo, sampled.mean * 1.02);
  EXPECT_GE(found.from_mesh->mean->hi, sampled.mean * 0.98);
}

TEST(Deviation, ContainsThatOfSamplesForATaperedOneAndItsOwnMesh) {
  const Model model{"", {solid({1.0, 0.6, 1.5}, {0.6, 1.3}, {3, 2, 1}, 3.0)}, {}};
  const Mesh mesh = surface_mesh(model.primitives[0], 10);
  const Deviation found = deviation(model, mesh, {});
  expect_proven(found, by_samples(model, mesh, 6, 50), 0.01);
}

TEST(Deviation, ContainsThatOfSamplesForABentOne) {
  Primitive bent = solid({0.4, 0.3, 1.5}, {0.7, 1.0}, {1, 0, 0}, 1.5);
  bent.bend = Bend{0.5, 30.0};
  const Model model{"", {bent}, {}};
  bent.bend->curvature = 1.0;
  DeviationOptions options;
  options.relative_tolerance = 0.05;
  options.statistics_of_surface = false;
  const Mesh mesh = surface_mesh(bent, 4);
  const Deviation found = deviation(model, mesh, options);
  expect_proven(found, by_samples(model, mesh, 2, 14), 0.05);
  EXPECT_FALSE(found.from_mesh->mean);
}

TEST(Deviation, ContainsThatOfSamplesForADifference) {
  Model model{"", {solid({1.0, 1.0, 1.0}, {1.0, 1.0}, {0, 0, 0}), solid({0.6, 0.6, 0.6}, {1.0, 1.0}, {0.9, 0, 0})}, {}};
  model.csg = SetExpression{.operands = {{.primitive = 0}, {.primitive = 1}}, .operation = SetOperation::subtract};
  const Mesh mesh = surface_mesh(model.primitives[0], 8);
  DeviationOptions options;
  options.statistics_of_surface = false;
  // The bite is as far from the sphere as it is deep: 0.7.
  const Deviation found = deviation(model, mesh, options);
  expect_proven(found, by_samples(model, mesh, 3, 30), 0.03);
  EXPECT_GT(found.from_model->largest.lo, 0.6);
}

constexpr std::array statistics_percents{50.0, 95.0};

/// Of the model's boundary, by area: centroids of fine triangles on its primitives' surfaces that no other holds.
void expect_statistics_of_model(const DistanceStatistics& found, const Model& model, const Mesh& mesh) {
  std::vector<Point> points;
  std::vector<double> areas;
  for (const Primitive& primitive : model.primitives) {
    constexpr std::uint32_t bands = 40;
    const Mesh fine = surface_mesh(primitive, bands);
    for (std::size_t n = 0; n < fine.triangles.size(); ++n) {
      const Triangle t = corners_of(fine, n);
      const LongPoint normal =
          cross(difference(widened(t[1]), widened(t[0])), difference(widened(t[2]), widened(t[0])));
      areas.push_back(static_cast<double>(std::sqrt(dot(normal, normal)) / 2));
      Point middle;
      for (std::size_t i = 0; i < 3; ++i) middle[i] = (t[0][i] + t[1][i] + t[2][i]) / 3.0;
      points.push_back(middle);
    }
  }
  constexpr double off_the_surface = 0.01;  // chords of bands are within it
  std::vector<double> from_boundary(points.size(), 0.0);
  if (model.primitives.size() > 1) from_boundary = mapped(model, points);
  std::vector<std::pair<double, double>> distances;  // and areas
  double area = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (from_boundary[i] > off_the_surface) continue;
    distances.emplace_back(static_cast<double>(distance_to_mesh(points[i], mesh)), areas[i]);
    area += areas[i];
    sum += areas[i] * distances.back().first;
  }
  std::ranges::sort(distances);
  constexpr double sampling = 0.02;
  const double mean = sum / area;
  EXPECT_LE(found.mean->lo, mean * (1.0 + sampling) + off_the_surface / 4);
  EXPECT_GE(found.mean->hi, mean * (1.0 - sampling) - off_the_surface / 4);
  for (std::size_t k = 0; k < statistics_percents.size(); ++k) {
    double reached = 0.0;
    std::size_t i = 0;
    while (reached < statistics_percents[k] / 100.0 * area) reached += distances[i++].second;
    EXPECT_LE(found.percentiles[k].lo, distances[i - 1].first * (1.0 + sampling) + off_the_surface / 4);
    EXPECT_GE(found.percentiles[k].hi, distances[i - 1].first * (1.0 - sampling) - off_the_surface / 4);
  }
}

TEST(Deviation, MeanAndPercentilesOfAUnionsSurface) {
  const Model model{
      "",
      {solid({1.0, 0.6, 0.8}, {0.5, 1.0}, {0, 0, 0}), solid({0.5, 0.5, 1.2}, {1.0, 0.7}, {0.7, 0.3, 0.2}, 2.0)},
      {}};
  const Mesh mesh = surface_mesh(solid({1.8, 1.3, 1.6}, {1.0, 1.0}, {0.3, 0.1, 0.1}), 8);
  DeviationOptions options;
  options.relative_tolerance = 0.2;
  options.statistics_of_surface = false;
  options.statistics_of_model = true;
  const Deviation found = deviation(model, mesh, options);
  EXPECT_TRUE(found.to_tolerance);
  expect_statistics_of_model(*found.from_model, model, mesh);
}

/// All of a single primitive's surface is the boundary: no distance to the model is asked for.
TEST(ModelDistances, OfABentAndTaperedSurface) {
  Primitive bent = solid({0.4, 0.3, 1.5}, {0.7, 1.0}, {1, 0, 0}, 1.5);
  bent.bend = Bend{0.5, 30.0};
  const Model model{"", {bent}, {}};
  const Mesh mesh = surface_mesh(solid({0.9, 0.8, 1.9}, {1.0, 1.0}, {1, 0, 0}), 8);
  const verify::TriangleTree triangles(verify::triangles_of(mesh));
  constexpr double tolerance = 0.1;
  const verify::DeviationSearch search{.to_model = {},
                                       .allowed = [](double size) { return tolerance * size; },
                                       .in_parallel =
                                           [](std::size_t count, const std::function<void(std::size_t)>& work) {
                                             for (std::size_t i = 0; i < count; ++i) work(i);
                                           },
                                       .ended = [] { return false; },
                                       .progress = [](double) {}};
  const verify::ModelDistances found =
      verify::distances_of_model(model, triangles, statistics_percents, infinity, search);
  EXPECT_FALSE(found.ended);
  EXPECT_LE(found.mean.width(), tolerance * found.mean.hi);
  expect_statistics_of_model({{0.0, infinity}, {}, found.mean, found.percentiles}, model, mesh);
}

void expect_scaled(const DistanceStatistics& found, const DistanceStatistics& ordinary, double size) {
  const auto scaled = [size](const Enclosure& e) { return Enclosure{e.lo * size, e.hi * size}; };
  EXPECT_EQ(found.largest, scaled(ordinary.largest));
  EXPECT_EQ(*found.mean, scaled(*ordinary.mean));
  for (std::size_t i = 0; i < ordinary.percentiles.size(); ++i)
    EXPECT_EQ(found.percentiles.at(i), scaled(ordinary.percentiles[i]));
}

// In units of their size they are the same numbers: squares and cubes of these lengths are none of binary64.
TEST(Deviation, OfHugeAndTinyModelsIsThatOfOrdinaryOnes) {
  const auto at_size = [](double size) {
    Mesh mesh = torus_mesh(3.0, 1.0, 6, 4);
    for (Point& vertex : mesh.vertices) {
      for (double& coordinate : vertex) coordinate *= size;
    }
    const Model model{"",
                      {solid({2.0 * size, 1.5 * size, size}, {0.5, 1.0}, {0, 0, 0}),
                       solid({size, size, size}, {1.0, 1.0}, {size, 0, 0})}};
    DeviationOptions options = on_host();
    options.relative_tolerance = 0.2;
    options.statistics_of_model = true;
    return deviation(model, mesh, options);
  };
  const Deviation ordinary = at_size(1.0);
  EXPECT_TRUE(ordinary.to_tolerance);
  for (const double size : {0x1p-997, 0x1p997}) {
    SCOPED_TRACE(size);
    const Deviation found = at_size(size);
    EXPECT_TRUE(found.to_tolerance);
    expect_scaled(found.of_vertices, ordinary.of_vertices, size);
    expect_scaled(*found.from_mesh, *ordinary.from_mesh, size);
    expect_scaled(*found.from_model, *ordinary.from_model, size);
    EXPECT_EQ(found.vertices[0].distance.lo, ordinary.vertices[0].distance.lo * size);
    EXPECT_EQ(found.hausdorff->hi, ordinary.hausdorff->hi * size);
  }
}

TEST(Deviation, TellsWhereItIs) {
  // A ball of radius 1 from one of radius 1.1 that is moved: far to the one side, near to the other.
  const Model model = ball(1.0);
  const Mesh mesh = surface_mesh(ball(1.1, {0.1, 0, 0}).primitives[0], 24);
  DeviationOptions options = on_host();
  options.regions = 3;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n)
    options.region_of.push_back(corners_of(mesh, n)[0][0] > 0.1 ? 0 : 1);
  const Deviation found = deviation(model, mesh, options);
  EXPECT_TRUE(found.to_tolerance);
  ASSERT_EQ(found.by_region.size(), 3U);
  EXPECT_NEAR(found.by_region[0].largest.lo, 0.2, 0.01);
  EXPECT_NEAR(found.by_region[1].largest.hi, 0.11, 0.02);
  EXPECT_GT(found.by_region[0].mean->lo, found.by_region[1].mean->hi);
  EXPECT_EQ(found.by_region[0].largest, found.from_mesh->largest);
  EXPECT_EQ(found.by_region[2].largest, (Enclosure{0.0, 0.0}));
  options.region_of.pop_back();
  EXPECT_THROW(static_cast<void>(deviation(model, mesh, options)), Error);
}

TEST(Deviation, OfACloudIsThatOfItsPoints) {
  Mesh cloud{.vertices = {{2, 0, 0}, {0, 0.5, 0}, {0, 0, -1}}, .triangles = {}};
  DeviationOptions options = on_host();
  options.from_model = false;
  const Deviation found = deviation(ball(1.0), cloud, options);
  EXPECT_FALSE(found.from_mesh);
  EXPECT_FALSE(found.from_model);
  EXPECT_FALSE(found.hausdorff);
  EXPECT_NEAR(found.of_vertices.largest.hi, 1.0, 1e-9);
  EXPECT_NEAR(found.of_vertices.mean->lo, 0.5, 1e-9);
  EXPECT_NEAR(found.of_vertices.percentiles[0].lo, 0.5, 1e-9);
  EXPECT_LT(found.vertices[1].distance.hi, 0.0);

  options.from_model = true;
  cloud.vertices = {{1, 0, 0}};
  const Deviation both = deviation(ball(1.0), cloud, options);
  EXPECT_LE(both.from_model->largest.lo, 2.0);
  EXPECT_GE(both.from_model->largest.hi, 2.0);
  EXPECT_TRUE(both.to_tolerance);
  EXPECT_GE(both.hausdorff->hi, 2.0);
}

/// One triangle alone bounds nothing: neither closed nor near.
TEST(Deviation, OfAnOpenMeshCountsWhatIsMissing) {
  const Mesh mesh{.vertices = {{1, 0, 0}, {1, 0.1, 0}, {1, 0, 0.1}}, .triangles = {{0, 1, 2}}};
  const Deviation found = deviation(ball(1.0), mesh, on_host());
  EXPECT_TRUE(found.to_tolerance);
  EXPECT_GE(found.from_model->largest.hi, 2.0);
  EXPECT_LE(found.from_model->largest.lo, 2.0);
  EXPECT_LE(found.from_mesh->largest.hi, 0.01);
}

TEST(Deviation, EndsWithWhatIsProven) {
  DeviationOptions options = on_host();
  int asked = 0;
  options.out_of_time = [&asked] { return ++asked > 40; };
  const Deviation late = deviation(ball(1.0), sphere_mesh(3), options);
  EXPECT_TRUE(late.out_of_time);
  EXPECT_FALSE(late.to_tolerance);
  EXPECT_GE(late.hausdorff->hi, late.hausdorff->lo);
  EXPECT_GE(late.hausdorff->hi, 0.005);

  options.out_of_time = {};
  options.most_samples = 500;
  const Deviation few = deviation(ball(1.0), sphere_mesh(3), options);
  EXPECT_FALSE(few.to_tolerance);
  EXPECT_TRUE(few.out_of_time);
  EXPECT_GE(few.hausdorff->hi, 0.005);

  options.interrupted = [] { return true; };
  EXPECT_TRUE(deviation(ball(1.0), sphere_mesh(3), options).interrupted);
}

TEST(Deviation, RefusesWhatItCannotMeasure) {
  const auto refused = [](const Mesh& mesh, const std::string& message, const DeviationOptions& options = on_host()) {
    expect_error([&] { (void)deviation(ball(1.0), mesh, options); }, ErrorKind::input, "", message);
  };
  refused({}, "the mesh has no vertices");
  refused({.vertices = {{0, std::numeric_limits<double>::quiet_NaN(), 0}}, .triangles = {}},
          "vertex 0 of the mesh, (0, nan, 0), is not finite");
  refused({.vertices = {{0, 0, 0}}, .triangles = {{0, 0, 1}}}, "triangle 0 of the mesh names vertex 1, of 1");
  DeviationOptions options = on_host();
  options.percentiles = {0.0};
  refused(sphere_mesh(0), "there is no percentile 0", options);
  options = on_host();
  options.tolerance = 0.0;
  refused(sphere_mesh(0), "the tolerance 0 is not above 0", options);
  options = on_host();
  options.relative_tolerance = -1.0;
  refused(sphere_mesh(0), "the relative tolerance -1 is not above 0", options);
}

}  // namespace
}  // namespace verisq::testing
