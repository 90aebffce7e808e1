/// The kernels of bent and combined models contain the exact signed distance: closed forms, and the host's own proofs,
/// on vectors and on scalars.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/map.hpp>

#include "host/device/device.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/device/query_batches.hpp"
#include "host/device/solid_model.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/fixtures/large_models.hpp"
#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/solid_escape.hpp"
#include "tests/oracle/sphere_solid.hpp"

namespace verisq::device {
namespace {

using oracle::PlacedModel;
using oracle::RandomSolids;
using oracle::solid_point_families;
using oracle::SphereSolid;

SetExpression leaf(std::uint32_t primitive) {
  return {{}, SetOperation::unite, primitive};
}
SetExpression combined(SetOperation operation, std::vector<SetExpression> operands) {
  return {std::move(operands), operation, 0};
}

/// Sets of numbers for each structure; compiling it is what takes time.
std::size_t models_of_structure() {
  return oracle::requested_count("VERISQ_SOLID_KERNEL_MODELS", 3);
}

/// The device with its kernels compiled for vectors of the parameter's length.
class SolidKernelTest : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const Selection selection = select_device("auto");
    if (!selection.device) GTEST_SKIP() << "no OpenCL device: " << selection.notice;
    device_ = *selection.device;
    device_->vector_width = GetParam();
    ASSERT_EQ(solid_vector_width(*device_), GetParam());
  }

  [[nodiscard]] std::vector<Enclosure> proven(const Model& model, std::span<const Point> points,
                                              double tolerance) const {
    const auto batch = solid_batch(*device_, model, tolerance);
    batch->submit(points);
    std::vector<Enclosure> enclosures;
    std::vector<Certificate> certificates;
    batch->collect(enclosures, certificates);
    return enclosures;
  }

  std::optional<Device> device_;
};

/// A sphere of the model, in any pose.
Primitive sphere(oracle::RandomCases& random, double scale) {
  const double radius = scale * random.uniform(0.6, 1.2);
  Pose pose;
  for (double& t : pose.translation) t = 0.7 * scale * random.uniform(-1.0, 1.0);
  if (random.choice(2) == 0)
    for (double& component : pose.quaternion) component = random.uniform(-1.0, 1.0);
  return {"", {{radius, radius, radius}, {1.0, 1.0}}, pose, {}};
}

void expect_closed_form(const Model& model, std::span<const Point> points, std::span<const Enclosure> proven,
                        double tolerance, std::size_t& verified_rows) {
  const SphereSolid spheres(model);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto exact = spheres.signed_distance(points[i]);
    if (!exact || !isfinite(exact->upper)) continue;
    verified_rows += verified(proven[i], tolerance) ? 1 : 0;
    const auto evidence = oracle::escape(proven[i], model, points[i], exact->lower, exact->upper);
    if (evidence) ADD_FAILURE() << *evidence;
  }
}

/// Union, lens, bored sphere, and a tree of them.
TEST_P(SolidKernelTest, ContainsTheClosedFormOfSpheres) {
  const std::vector<SetExpression> trees{
      combined(SetOperation::unite, {leaf(0), leaf(1)}),
      combined(SetOperation::intersect, {leaf(0), leaf(1)}),
      combined(SetOperation::subtract, {combined(SetOperation::unite, {leaf(0), leaf(1)}), leaf(2),
                                        combined(SetOperation::intersect, {leaf(3)})}),
  };
  oracle::RandomCases random(7);
  std::size_t count = 0;
  std::size_t verified_rows = 0;
  for (const SetExpression& tree : trees) {
    for (std::size_t n = 0; n < models_of_structure(); ++n) {
      const double scale = random.log_uniform(1e-2, 1e2);
      Model model{"", {}, tree};
      for (int i = 0; i < 4; ++i) model.primitives.push_back(sphere(random, scale));  // not all are in each tree
      RandomSolids solids(n);
      const PlacedModel placed(model);
      std::vector<Point> points;
      for (std::size_t i = 0; i < 70; ++i)
        points.push_back(solids.point(placed, solid_point_families[i % solid_point_families.size()]));
      for (const double far : {1e6, 1e12}) points.push_back({far * scale, -0.3 * far * scale, 0.1 * far * scale});
      const double tolerance = 1e-6 * placed.bounding_ball().radius;
      expect_closed_form(model, points, proven(model, points, tolerance), tolerance, verified_rows);
      count += points.size();
    }
  }
  fmt::print("{} of {} verified\n", verified_rows, count);
  EXPECT_GT(2 * verified_rows, count);
}

/// Terms have 32 bits: primitives without one are in no term, wherever they lie.
TEST_P(SolidKernelTest, PrimitivesThatNoLeafNamesDoNotMatter) {
  const Primitive whole{"", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}, {}};
  const Primitive bite{"", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {{0.7, 0.0, 0.0}}, {}};
  const Primitive elsewhere{"", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {{9.0, 0.0, 0.0}}, {}};
  Model model{"", {whole, bite}, combined(SetOperation::subtract, {leaf(0), leaf(1)})};
  model.primitives.resize(35, elsewhere);
  oracle::RandomCases random(12);
  std::vector<Point> points(80);
  for (Point& point : points)
    for (double& coordinate : point) coordinate = random.uniform(-2.0, 2.0);
  std::size_t verified_rows = 0;
  expect_closed_form(model, points, proven(model, points, 1e-5), 1e-5, verified_rows);
  EXPECT_GT(2 * verified_rows, points.size());
}

/// Facing the middle of the arc, a bent tube is as far as the arc's circle less its radius.
TEST_P(SolidKernelTest, ContainsTheClosedFormOfArcs) {
  constexpr double ends = 1e-9;  // (|z| / a3)^(2 / e1) e1 / 2 for |z| < 0.3 a3: what the tube tapers, relatively
  const std::vector<Bend> bends{{1.0, 0.0}, {-0.6, 40.0}, {1e-5, 100.0}};
  oracle::RandomCases random(3);
  for (const Bend& bend : bends) {
    const double radius = 0.2;
    const Superquadric tube{{radius, radius, 2.0}, {0.1, 1.0}};
    const Model model{"", {{"tube", tube, {}, bend}}, {}};
    const double k = std::abs(bend.curvature);
    const double angle = bend.angle_degrees * std::numbers::pi / 180 + (bend.curvature < 0 ? std::numbers::pi : 0.0);
    std::vector<Point> points;
    std::vector<double> distances;
    for (int i = 0; i < 60; ++i) {
      const double off = random.uniform(-0.5, 0.5);  // from the arc, away from its centre
      const double s = random.uniform(-0.5, 0.5);
      const double z = random.uniform(-0.5, 0.5);
      const double half_sine = std::sin(k * z / 2);
      const double along = 2 * half_sine * half_sine / k - off * std::cos(k * z);
      points.push_back({along * std::cos(angle) - s * std::sin(angle), along * std::sin(angle) + s * std::cos(angle),
                        (1 / k + off) * std::sin(k * z)});
      distances.push_back(std::hypot(off, s) - radius);
    }
    const std::vector<Enclosure> found = proven(model, points, 1e-5);
    std::size_t verified_rows = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LE(found[i].lo, distances[i] + ends) << bend.curvature << ' ' << i;
      EXPECT_GE(found[i].hi, distances[i] - ends) << bend.curvature << ' ' << i;
      verified_rows += verified(found[i], 1e-5) ? 1 : 0;
    }
    EXPECT_GT(2 * verified_rows, points.size()) << bend.curvature;
  }
}

/// On the border and the faces of the cubes that are searched, and on the way to the centre of a bend and past it.
std::vector<Point> special_points(const Model& model) {
  std::vector<Point> points;
  const int scale = scale_exponent(model);
  const verify::Cube root = root_cube(model, scale);
  const auto at = [&](double x, double y, double z) {
    Point p{root.centre[0] + x * root.half_width, root.centre[1] + y * root.half_width,
            root.centre[2] + z * root.half_width};
    for (double& coordinate : p) coordinate = std::ldexp(coordinate, -scale);
    points.push_back(p);
  };
  for (const double x : {-1.0, 0.0, 0.5}) {
    at(x, x, x);
    at(x, 0.25, -1.0);
    at(1e6, 0.3e6 * x, x);
  }
  const PlacedModel placed(model);
  for (const oracle::PlacedPrimitive& primitive : placed.primitives()) {
    points.push_back(primitive.centre());
    if (!primitive.primitive().bend || std::abs(primitive.primitive().bend->curvature) < 1e-6) continue;
    const double radius = 1 / primitive.primitive().bend->curvature;
    const double angle = primitive.primitive().bend->angle_degrees * std::numbers::pi / 180;
    // The centre of the bend lies in the plane z = 0 of the pose, which the bend keeps.
    const oracle::PlacedPrimitive straight({"", primitive.primitive().superquadric, primitive.primitive().pose, {}});
    for (const double share : {0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 4.0})
      points.push_back(straight.placed({share * radius * std::cos(angle), share * radius * std::sin(angle), 0.0}));
  }
  return points;
}

void expect_meeting(const Model& model, std::span<const Point> points, std::span<const Enclosure> found,
                    double tolerance) {
  const SignedDistance host(model);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Enclosure truth = host(points[i], tolerance);
    const auto evidence = oracle::escape(found[i], model, points[i], oracle::Real(truth.lo), oracle::Real(truth.hi));
    if (evidence) ADD_FAILURE() << *evidence;
    EXPECT_FALSE(std::isnan(found[i].lo) || std::isnan(found[i].hi));
    EXPECT_LE(found[i].lo, found[i].hi);
  }
}

std::vector<Point> queries(const Model& model, std::uint64_t seed, std::size_t rounds) {
  RandomSolids solids(seed);
  const PlacedModel placed(model);
  std::vector<Point> points = special_points(model);
  for (std::size_t i = 0; i < rounds * solid_point_families.size(); ++i)
    points.push_back(solids.point(placed, solid_point_families[i % solid_point_families.size()]));
  return points;
}

/// Beside the surface inside of a gently bent stem: to rounding, where a search would stop at the tolerance.
TEST_P(SolidKernelTest, MostShallowPointsOfAStemNeedNoSearch) {
  constexpr double tolerance = 1e-6;
  const Pose pose{{0.4, -0.2, 1.0}, {0.9, 0.3, -0.2, 0.1}};
  const Model model{"", {{"stem", {{0.25, 0.3, 1.6}, {0.4, 0.9}}, pose, Bend{0.2, 25.0}}}, {}};
  const PlacedModel placed(model);
  const oracle::PlacedPrimitive& stem = placed.primitives().front();
  oracle::RandomCases random(11);
  std::vector<Point> points;
  for (int i = 0; i < 160; ++i) {
    const auto [foot, normal] = random.boundary_point(stem.primitive().superquadric);
    const double depth = random.log_uniform(1e-4, 0.03);
    points.push_back(
        stem.placed({foot[0] - depth * normal[0], foot[1] - depth * normal[1], foot[2] - depth * normal[2]}));
  }
  const std::vector<Enclosure> found = proven(model, points, tolerance);
  const auto tight = std::count_if(found.begin(), found.end(), [](const Enclosure& d) { return d.width() < 1e-9; });
  fmt::print("{} of {} to 1e-9\n", tight, points.size());
  EXPECT_GT(4 * static_cast<std::size_t>(tight), 3 * points.size());
  std::vector<Point> some;
  std::vector<Enclosure> of_some;
  for (std::size_t i = 0; i < points.size(); i += 8) {
    some.push_back(points[i]);
    of_some.push_back(found[i]);
  }
  expect_meeting(model, some, of_some, 1e-4);
}

TEST_P(SolidKernelTest, OfOneBentSolidMeetsTheHost) {
  for (std::size_t n = 0; n < 2 * models_of_structure(); ++n) {
    RandomSolids solids(100 + n);
    Model model = solids.model(oracle::ModelFamily::bent);
    Primitive& primitive = model.primitives.front();
    if (n % 3 == 1) primitive.superquadric.exponents = {n % 2 == 0 ? 2.0 : 0.05, n % 2 == 0 ? 0.05 : 2.0};
    if (n % 3 == 1) primitive.bend->curvature *= 0.7;  // corners reach farther
    if (n % 3 == 2) primitive.bend->curvature = n % 2 == 0 ? 1e-300 : -1e-9 / primitive.superquadric.semi_axes[2];
    const double tolerance = 1e-4 * PlacedModel(model).bounding_ball().radius;
    const std::vector<Point> points = queries(model, n, 2);
    expect_meeting(model, points, proven(model, points, tolerance), tolerance);
  }
}

/// (A and B) or (C - A - B - D) or (C and (A or E)): with a primitive on both sides of a difference, one in two places,
/// a difference of many, and one that is in no place.
Model tangled(std::uint64_t seed) {
  const SetExpression both = combined(SetOperation::intersect, {leaf(0), leaf(1)});
  const SetExpression rest = combined(SetOperation::subtract, {leaf(2), leaf(0), leaf(1), leaf(3)});
  const SetExpression nested =
      combined(SetOperation::intersect,
               {leaf(2), combined(SetOperation::unite, {leaf(0), combined(SetOperation::unite, {leaf(1)})})});
  Model model{"", {}, combined(SetOperation::unite, {both, rest, nested})};
  for (std::uint64_t i = 0; i < 5; ++i) {
    RandomSolids solids(10 * seed + i);
    Primitive primitive = solids.model(oracle::ModelFamily::bent).primitives.front();
    const double size = primitive.superquadric.semi_axes[2];
    for (double& axis : primitive.superquadric.semi_axes) axis /= size;
    oracle::RandomCases random(seed + i);
    for (double& t : primitive.pose.translation) t = 0.5 * random.uniform(-1.0, 1.0);
    primitive.bend->curvature *= size;
    if (i % 2 == 1) primitive.bend.reset();
    model.primitives.push_back(primitive);
  }
  return model;
}

TEST_P(SolidKernelTest, OfATangledTreeMeetsTheHost) {
  for (std::size_t n = 0; n < models_of_structure(); ++n) {
    const Model model = tangled(n + 1);
    const double tolerance = 1e-3;
    const std::vector<Point> points = queries(model, n, 3);
    expect_meeting(model, points, proven(model, points, tolerance), tolerance);
  }
}

/// On vectors alone: so large a tree takes long to compile.
class LargeTreeTest : public SolidKernelTest {};

/// More than there are bits to remember them by: a row of overlapping spheres, every third of them taken away.
TEST_P(LargeTreeTest, MeetsTheHost) {
  constexpr std::uint32_t count = 36;
  Model model;
  SetExpression row = combined(SetOperation::unite, {});
  SetExpression holes = combined(SetOperation::unite, {});
  for (std::uint32_t i = 0; i < count; ++i) {
    model.primitives.push_back({"", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {{1.5 * i, 0.3 * (i % 2), 0.0}}, {}});
    (i % 3 == 0 ? holes : row).operands.push_back(leaf(i));
  }
  model.csg = combined(SetOperation::subtract, {row, holes});
  std::vector<Point> points;
  for (std::uint32_t i = 0; i < count; i += 2) {
    points.push_back({1.5 * i, 0.1, 1.3});
    points.push_back({1.5 * i + 0.8, 0.4, 0.2});
  }
  const double tolerance = 1e-2;
  expect_meeting(model, points, proven(model, points, tolerance), tolerance);
}

INSTANTIATE_TEST_SUITE_P(Widths, SolidKernelTest, ::testing::Values(1, 8),
                         [](const auto& test) { return fmt::format("Width{}", test.param); });

INSTANTIATE_TEST_SUITE_P(Widths, LargeTreeTest, ::testing::Values(8),
                         [](const auto& test) { return fmt::format("Width{}", test.param); });

/// The whole way: device, and the host for what that leaves wide.
TEST(SolidMapTest, MeetsTheHost) {
  const Model model = tangled(1);
  const double tolerance = 1e-3;
  const std::vector<Point> points = queries(model, 9, 2);
  const oracle::FinishedMap map = oracle::map_in_memory(model, points, {.tolerance = tolerance});
  std::vector<Enclosure> found;
  found.reserve(map.rows.size());
  for (const MapResult& row : map.rows) found.push_back(row.distance);
  ASSERT_EQ(found.size(), points.size());
  expect_meeting(model, points, found, tolerance);
}

/// min and max of the balls' own distances: right of its sign, and of outer distances from below.
double by_balls(const Model& model, const SetExpression& node, const Point& q) {
  if (node.operands.empty()) {
    const Primitive& ball = model.primitives[node.primitive];
    const Point& c = ball.pose.translation;
    return std::hypot(q[0] - c[0], q[1] - c[1], q[2] - c[2]) - ball.superquadric.semi_axes[0];
  }
  double result = by_balls(model, node.operands.front(), q);
  for (std::size_t k = 1; k < node.operands.size(); ++k) {
    const double other = by_balls(model, node.operands[k], q);
    if (node.operation == SetOperation::unite) result = std::min(result, other);
    if (node.operation == SetOperation::intersect) result = std::max(result, other);
    if (node.operation == SetOperation::subtract) result = std::max(result, -other);
  }
  return result;
}

/// More leaves than kernels are compiled for: as fast by the host, and the same answers however they are nested.
TEST(SolidMapTest, TreesThatAreNotCompiledAreTheHosts) {
  using namespace verisq::testing;
  constexpr std::uint32_t count = 1000;
  const double tolerance = 1e-2;
  const std::vector<Point> points{{-1.0, -1.0, -1.0}, {4.5, 4.5, 4.5}, {5.2, 5.1, 5.0}, {3.0, 4.0, 12.0}};
  for (const SetExpression& tree :
       {deep_tree(count, in_turn), deep_tree_of_last_operands(count, in_turn), balanced_tree(0, count, in_turn)}) {
    const Model model{"", grid_of_balls(count, 0.6), tree};
    const oracle::FinishedMap map = oracle::map_in_memory(model, points, {.tolerance = tolerance});
    EXPECT_EQ(map.summary.device, "host");
    EXPECT_EQ(map.summary.notice,
              "the model's tree has 1000 leaves, of which the device's kernels take 100: the host does all");
    EXPECT_EQ(map.summary.host_verified, points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double estimate = by_balls(model, tree, points[i]);
      const Enclosure& found = map.rows[i].distance;
      if (estimate > 0.0) {
        EXPECT_GE(found.hi, estimate - 1e-12) << i;
        EXPECT_GE(found.lo, 0.0) << i;
      } else {
        EXPECT_LE(found.lo, estimate + 1e-12) << i;
        EXPECT_LE(found.hi, 0.0) << i;
      }
    }
  }
}

TEST(SolidMapTest, NestedUnionsOfManyAreMappedAsPlainOnes) {
  using namespace verisq::testing;
  constexpr std::uint32_t count = 1000;
  const std::vector<Point> points{{-1.0, -1.0, -1.0}, {4.5, 4.5, 4.5}, {3.0, 4.0, 12.0}};
  const Model plain{"", grid_of_balls(count, 0.6)};
  const MapOptions options{.tolerance = 1e-2, .device = "host", .certificates = true};
  const oracle::FinishedMap expected = oracle::map_in_memory(plain, points, options);
  for (const SetExpression& tree : {deep_tree(count, always_union), balanced_tree(0, count, always_union)}) {
    const oracle::FinishedMap map = oracle::map_in_memory(Model{"", plain.primitives, tree}, points, options);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(map.rows[i].distance.lo, expected.rows[i].distance.lo);
      EXPECT_EQ(map.rows[i].distance.hi, expected.rows[i].distance.hi);
    }
  }
}

/// Nothing at all is an infinite distance away.
TEST_P(SolidKernelTest, OfAnEmptySolidHasNoUpperEnd) {
  Model model{"", {}, combined(SetOperation::intersect, {leaf(0), leaf(1)})};  // a structure of the spheres above
  for (const double x : {-3.0, 3.0, 6.0, 9.0})
    model.primitives.push_back({"", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {{x, 0.0, 0.0}}, {}});
  const std::vector<Point> points{{0.0, 0.0, 0.0}, {-3.0, 0.1, 0.0}, {9.0, 1.0, 2.0}};
  for (const Enclosure& found : proven(model, points, 1e-3)) EXPECT_EQ(found.hi, infinity);
}

}  // namespace
}  // namespace verisq::device
