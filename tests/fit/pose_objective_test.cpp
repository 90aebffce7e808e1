/// The evaluation of candidates on a device against proven distances, against differences of itself, and against sums
/// of its own distances.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "host/device/primitive_parameters.hpp"
#include "host/plan/pose_search.hpp"
#include "verisq/clearance.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

using fit_search::Candidate;
using fit_search::CandidateEvaluator;
using fit_search::Evaluation;
using fit_search::PointDistance;
using fit_search::PoseCell;

constexpr Fitness fitness{0.2, 0.5, {0.0, 0.4}};

Point moved(const Point& p, const Pose& pose) {
  const auto r = rotation_matrix(pose.quaternion);
  Point out{};
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = r[3 * i] * p[0] + r[3 * i + 1] * p[1] + r[3 * i + 2] * p[2] + pose.translation[i];
  return out;
}

using Quaternion = std::array<double, 4>;

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

// The rotation by |vector| radians about it.
Quaternion rotation(const Point& vector) {
  const double angle = std::hypot(vector[0], vector[1], vector[2]);
  const double share = angle == 0.0 ? 0.5 : std::sin(angle / 2.0) / angle;
  return {std::cos(angle / 2.0), share * vector[0], share * vector[1], share * vector[2]};
}

// Turned about the pivot, then shifted; the pivot stays where it was, so that derivatives refer to it.
Candidate displaced(Candidate candidate, const Point& shift, const Point& rotation_vector) {
  const Quaternion turn = rotation(rotation_vector);
  for (Primitive& primitive : candidate.primitives) {
    Point arm = primitive.pose.translation;
    for (std::size_t i = 0; i < 3; ++i) arm[i] -= candidate.pivot[i];
    primitive.pose.translation = moved(arm, {candidate.pivot, turn});
    for (std::size_t i = 0; i < 3; ++i) primitive.pose.translation[i] += shift[i];
    primitive.pose.quaternion = product(turn, primitive.pose.quaternion);
  }
  return candidate;
}

Candidate scaled(Candidate candidate, double factor) {
  for (Primitive& primitive : candidate.primitives) {
    for (double& axis : primitive.superquadric.semi_axes) axis *= factor;
    for (double& component : primitive.pose.translation) component *= factor;
  }
  for (double& component : candidate.pivot) component *= factor;
  return candidate;
}

class Random {
 public:
  double uniform(double lower, double upper) { return std::uniform_real_distribution(lower, upper)(engine_); }
  Point within(double limit) { return {uniform(-limit, limit), uniform(-limit, limit), uniform(-limit, limit)}; }
  // Of at most this length.
  Point in_ball(double radius) {
    Point p = within(radius);
    while (std::hypot(p[0], p[1], p[2]) > radius) p = within(radius);
    return p;
  }

 private:
  std::mt19937_64 engine_{1};
};

double taper_coefficient(const Superquadric& solid) {
  return (solid.taper - 1.0) / (solid.taper + 1.0);
}

// Of a point about the focus, in the frame of the solid.
double gauge(const Superquadric& solid, const Point& p) {
  const double p1 = 2.0 / solid.exponents[0];
  const double p2 = 2.0 / solid.exponents[1];
  const auto& a = solid.semi_axes;
  const double section = std::pow(std::pow(std::abs(p[0] / a[0]), p2) + std::pow(std::abs(p[1] / a[1]), p2), 1.0 / p2);
  const double norm = std::pow(std::pow(section, p1) + std::pow(std::abs(p[2] / a[2]), p1), 1.0 / p1);
  const double k = taper_coefficient(solid);
  return (norm - k * p[2] / a[2]) / (1.0 - k * k);
}

// At `lower` to `upper` times the primitive's own size.
Point point_about(Random& random, const Primitive& primitive, double lower, double upper) {
  Point p = random.within(1.0);
  for (std::size_t i = 0; i < 3; ++i) p[i] *= primitive.superquadric.semi_axes[i];
  const double factor = random.uniform(lower, upper) / gauge(primitive.superquadric, p);
  for (double& component : p) component *= factor;
  p[2] -= taper_coefficient(primitive.superquadric) * primitive.superquadric.semi_axes[2];
  return moved(p, primitive.pose);
}

std::vector<Point> points_about(const Candidate& candidate, std::size_t count, double lower, double upper) {
  Random random;
  std::vector<Point> points;
  for (std::size_t n = 0; n < count; ++n)
    points.push_back(point_about(random, candidate.primitives[n % candidate.primitives.size()], lower, upper));
  return points;
}

Primitive primitive(const Superquadric& solid, const Pose& pose = {{0.3, -0.2, 0.1}, {1.0, 0.2, 0.3, -0.4}}) {
  return {"", solid, pose};
}

double size_of(const Candidate& candidate) {
  double size = 0.0;
  for (const Primitive& p : candidate.primitives)
    size = std::max(size, *std::max_element(p.superquadric.semi_axes.begin(), p.superquadric.semi_axes.end()));
  return size;
}

// An implant as they are made: parts that overlap.
Candidate implant() {
  return {{primitive({{0.5, 0.45, 2.4}, {0.7, 1.0}}, {{0.1, 0.0, -1.0}, {1.0, 0.1, 0.05, 0.0}}),
           primitive({{0.9, 0.7, 1.4}, {0.9, 0.6}}, {{0.3, 0.2, 0.8}, {1.0, -0.1, 0.1, 0.2}}),
           primitive({{0.9, 0.9, 0.9}, {1.0, 1.0}}, {{1.6, 0.1, 2.4}, {1.0, 0.0, 0.0, 0.0}})},
          {0.4, -0.3, 0.6}};
}

class PoseObjectiveTest : public ::testing::Test {
 protected:
  static const Device& device() {
    static const Selection selection = select_device("auto");
    return selection.device.value();
  }

  static std::unique_ptr<CandidateEvaluator> evaluator(const std::vector<Point>& points) {
    return device_candidate_evaluator(device(), points, weights(points.size()));
  }
  static std::vector<double> weights(std::size_t count) {
    std::vector<double> all(count);
    for (std::size_t n = 0; n < count; ++n) all[n] = static_cast<double>(n % 4) * 0.5;  // 0 too
    return all;
  }

  static std::vector<PointDistance> distances(const Candidate& candidate, const std::vector<Point>& points) {
    std::vector<PointDistance> all;
    evaluator(points)->distances(candidate, all);
    return all;
  }
  static Evaluation evaluation(CandidateEvaluator& evaluator, const Candidate& candidate, const PoseCell& cell = {},
                               std::size_t stride = 1) {
    std::vector<Evaluation> evaluations;
    evaluator.evaluate({&candidate, 1}, fitness, cell, stride, evaluations);
    return evaluations.at(0);
  }

  // Distances of points about the candidate's first primitive, to the proven enclosures.
  static void expect_proven(const Candidate& candidate, std::size_t count, double lower, double upper,
                            const std::string& what) {
    const std::vector<Point> points = points_about(candidate, count, lower, upper);
    const std::vector<PointDistance> found = distances(candidate, points);
    const SignedDistance proven(Model{"", candidate.primitives});
    const double size = size_of(candidate);
    for (std::size_t n = 0; n < count; ++n) {
      const Enclosure e = proven(points[n], 1e-11 * size);
      ASSERT_LE(e.width(), 1e-9 * size);
      const double tolerance = 1e-9 * std::abs(found[n].distance) + 1e-12 * size;
      EXPECT_GE(found[n].distance, e.lo - tolerance) << what << ", point " << n;
      EXPECT_LE(found[n].distance, e.hi + tolerance) << what << ", point " << n;
    }
  }
};

struct Shape {
  std::array<double, 2> exponents;
  double taper = 1.0;
};

class SinglePrimitiveTest : public PoseObjectiveTest, public ::testing::WithParamInterface<Shape> {
 protected:
  [[nodiscard]] static Superquadric solid(const std::array<double, 3>& semi_axes) {
    return {semi_axes, GetParam().exponents, GetParam().taper};
  }
  [[nodiscard]] static Candidate candidate() { return {{primitive(solid({1.0, 1.3, 2.9}))}, {}}; }
};

TEST_P(SinglePrimitiveTest, DistancesOutsideAreThoseProven) {
  expect_proven(candidate(), 40, 1.0, 3.0, "outside");
}

TEST_P(SinglePrimitiveTest, DistancesInsideCloseToTheSurfaceAreThoseProven) {
  expect_proven(candidate(), 40, 0.98, 1.0, "inside");
}

// Any direction bounds the depth from above, and none found is worse than the way to the faces of the box.
TEST_P(SinglePrimitiveTest, DepthsAreNeitherUnderestimatedNorAboveTheBoxes) {
  const Candidate unmoved{{primitive(solid({1.3, 1.0, 2.9}), {})}, {}};
  const double widening = 1.0 + std::abs(taper_coefficient(solid({1.3, 1.0, 2.9})));
  const std::vector<Point> points = points_about(unmoved, 200, 0.0, 1.0);
  const std::vector<PointDistance> found = distances(unmoved, points);
  const SignedDistance proven(Model{"", unmoved.primitives});
  for (std::size_t n = 0; n < points.size(); ++n) {
    const double depth_in_box = std::min({widening * 1.3 - std::abs(points[n][0]),
                                          widening * 1.0 - std::abs(points[n][1]), 2.9 - std::abs(points[n][2])});
    EXPECT_LE(found[n].distance, proven(points[n], 1e-6).hi + 1e-12) << n;
    EXPECT_GE(found[n].distance, -depth_in_box - 1e-12) << n;
  }
}

TEST_P(SinglePrimitiveTest, DistancesAreContinuousThroughTheSurface) {
  const Candidate solid = candidate();
  for (const double apart : {1e-6, 1e-9, 1e-12, 1e-14, 0.0}) {
    const auto outer = distances(solid, points_about(solid, 50, 1.0 + apart, 1.0 + apart));
    const auto inner = distances(solid, points_about(solid, 50, 1.0 - apart, 1.0 - apart));
    for (std::size_t n = 0; n < outer.size(); ++n) {
      EXPECT_NEAR(outer[n].distance, 0.0, 4.0 * apart + 1e-12);
      EXPECT_NEAR(inner[n].distance, 0.0, 4.0 * apart + 1e-12);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(outer[n].normal[i], inner[n].normal[i], 4e3 * apart + 1e-9) << n;
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<Shape>& test) {
  const auto& [exponents, taper] = test.param;
  const auto tenths = [](double number) { return std::lround(10.0 * number); };
  return fmt::format("Tenths{}And{}{}", tenths(exponents[0]), tenths(exponents[1]),
                     taper == 1.0 ? "" : fmt::format("Taper{}", tenths(taper)));
}

using Shapes = std::vector<Shape>;

INSTANTIATE_TEST_SUITE_P(Exponents, SinglePrimitiveTest,
                         ::testing::ValuesIn(Shapes{{{1.0, 1.0}},
                                                    {{0.1, 0.1}},
                                                    {{0.1, 1.0}},
                                                    {{0.3, 0.8}},
                                                    {{0.6, 0.9}},
                                                    {{0.9, 0.5}},
                                                    {{1.0, 0.2}},
                                                    {{1.5, 0.4}},
                                                    {{0.5, 1.6}},
                                                    {{1.4, 1.6}},
                                                    {{0.2, 1.9}},
                                                    {{1.9, 1.9}}}),
                         name_of);

INSTANTIATE_TEST_SUITE_P(Tapers, SinglePrimitiveTest, ::testing::ValuesIn(Shapes{{{0.3, 0.4}, 1.9}, {{0.9, 1.2}, 0.3}}),
                         name_of);

// Exponent 2 is taken for a smaller one: a solid at most 3.5 % larger.
TEST_F(PoseObjectiveTest, AnOctahedronIsALittleTooLarge) {
  const Candidate octahedron{{primitive({{1.0, 1.3, 0.9}, {2.0, 2.0}})}, {}};
  const std::vector<Point> points = points_about(octahedron, 200, 0.9, 2.0);
  const std::vector<PointDistance> found = distances(octahedron, points);
  const SignedDistance proven(Model{"", octahedron.primitives});
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Enclosure e = proven(points[n], 1e-6);
    EXPECT_LE(found[n].distance, e.hi + 1e-12) << n;
    EXPECT_GE(found[n].distance, e.lo - 0.035 * 1.3) << n;
  }
}

TEST_F(PoseObjectiveTest, DistancesOfAUnionAreTheLeastOfItsPrimitives) {
  const Candidate whole = implant();
  const std::vector<Point> points = points_about(whole, 500, 0.8, 4.0);
  const std::vector<PointDistance> found = distances(whole, points);
  std::vector<std::vector<PointDistance>> parts;
  for (const Primitive& part : whole.primitives) parts.push_back(distances({{part}, whole.pivot}, points));
  std::vector<std::size_t> decided(parts.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    const auto nearest = std::min_element(parts.begin(), parts.end(),
                                          [n](const auto& a, const auto& b) { return a[n].distance < b[n].distance; });
    EXPECT_NEAR(found[n].distance, (*nearest)[n].distance, 1e-12);
    EXPECT_EQ(found[n].primitive, nearest - parts.begin());
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(found[n].normal[i], (*nearest)[n].normal[i], 1e-9);
      EXPECT_NEAR(found[n].size_gradient[i], (*nearest)[n].size_gradient[i], 1e-9);
    }
    ++decided[found[n].primitive];
  }
  for (const std::size_t count : decided) EXPECT_GT(count, 20U);
}

TEST_F(PoseObjectiveTest, DistancesOfAUnionAreThoseProven) {
  expect_proven(implant(), 100, 1.0, 4.0, "union");
}

TEST_F(PoseObjectiveTest, AnyScaleGivesTheSameDistances) {
  const Candidate unit = implant();
  const std::vector<Point> points = points_about(unit, 200, 0.9, 3.0);
  const std::vector<PointDistance> expected = distances(unit, points);
  for (const double factor : {1e-3, 1e3, 1e-60}) {
    std::vector<Point> larger = points;
    for (Point& point : larger)
      for (double& component : point) component *= factor;
    const std::vector<PointDistance> found = distances(scaled(unit, factor), larger);
    for (std::size_t n = 0; n < points.size(); ++n) {
      EXPECT_NEAR(found[n].distance / factor, expected[n].distance, 1e-11);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(found[n].normal[i], expected[n].normal[i], 1e-8);
        EXPECT_NEAR(found[n].size_gradient[i], expected[n].size_gradient[i], 1e-8);
      }
    }
  }
}

TEST_F(PoseObjectiveTest, NormalsAreUnitGradientsOfTheDistance) {
  const Candidate candidate = implant();
  const std::vector<Point> points = points_about(candidate, 300, 0.95, 3.0);
  const std::vector<PointDistance> found = distances(candidate, points);
  constexpr double step = 1e-5;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<Point> before = points;
    std::vector<Point> behind = points;
    for (std::size_t n = 0; n < points.size(); ++n) {
      before[n][axis] -= step;
      behind[n][axis] += step;
    }
    const auto lower = distances(candidate, before);
    const auto upper = distances(candidate, behind);
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (lower[n].primitive != upper[n].primitive) continue;  // a kink between
      EXPECT_NEAR(found[n].normal[axis], (upper[n].distance - lower[n].distance) / (2.0 * step), 1e-6) << n;
    }
  }
  for (const PointDistance& at : found) EXPECT_NEAR(std::hypot(at.normal[0], at.normal[1], at.normal[2]), 1.0, 1e-12);
}

// Every symmetry plane and the centre: nothing there has one normal, but everything is finite.
TEST_F(PoseObjectiveTest, PointsOnAxesHaveDistances) {
  const Candidate candidate{{primitive({{1.0, 2.0, 3.0}, {0.4, 0.7}}, {})}, {}};
  const std::vector<Point> points{{0, 0, 0},   {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {0.9, 0, 0}, {0, 1.9, 0},
                                  {0, 0, 2.9}, {0, 1, 4}, {2, 0, 1}, {1, 0, 0}, {0, 2, 0},   {0, 0, 3}};
  const std::vector<double> expected{-1.0, 3.0, 2.0, 1.0, -0.1, -0.1, -0.1};
  const std::vector<PointDistance> found = distances(candidate, points);
  for (std::size_t n = 0; n < expected.size(); ++n) EXPECT_NEAR(found[n].distance, expected[n], 1e-11) << n;
  for (std::size_t n = 9; n < points.size(); ++n) EXPECT_NEAR(found[n].distance, 0.0, 1e-12) << n;
  for (const PointDistance& at : found) {
    EXPECT_TRUE(std::isfinite(at.distance));
    EXPECT_NEAR(std::hypot(at.normal[0], at.normal[1], at.normal[2]), 1.0, 1e-12);
    for (const double derivative : at.size_gradient) EXPECT_TRUE(std::isfinite(derivative));
  }
}

// Work-items of one point, as graphics processors get them, have so many slices that sums of sums are summed again.
TEST_F(PoseObjectiveTest, SumsByOnePointAWorkItemAreThoseByVectors) {
  Device scalar = device();
  scalar.vector_width = 1;
  Candidate moved_one = implant();
  moved_one.primitives[0].pose.translation[2] -= 0.2;
  const std::vector<Candidate> candidates{implant(), moved_one};
  const std::vector<Point> points = points_about(implant(), 9001, 0.9, 3.0);
  std::vector<Evaluation> by_vectors;
  std::vector<Evaluation> by_points;
  evaluator(points)->evaluate(candidates, fitness, {0.01, 0.02}, 1, by_vectors);
  device_candidate_evaluator(scalar, points, weights(points.size()))
      ->evaluate(candidates, fitness, {0.01, 0.02}, 1, by_points);
  ASSERT_EQ(by_points.size(), candidates.size());
  for (std::size_t n = 0; n < candidates.size(); ++n) {
    EXPECT_NEAR(by_points[n].objective, by_vectors[n].objective, 1e-9);
    EXPECT_NEAR(by_points[n].objective_bound, by_vectors[n].objective_bound, 1e-9);
    EXPECT_NEAR(by_points[n].smallest_distance, by_vectors[n].smallest_distance, 1e-12);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(by_points[n].pose_gradient[i], by_vectors[n].pose_gradient[i], 1e-7);
    for (std::size_t i = 0; i < implant().primitives.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(by_points[n].size_gradient[i][axis], by_vectors[n].size_gradient[i][axis], 1e-7);
  }
}

TEST_F(PoseObjectiveTest, SumsAreThoseOfTheDistances) {
  const Candidate candidate = implant();
  const std::vector<Point> points = points_about(candidate, 333, 0.9, 3.0);  // no multiple of a vector
  const std::vector<double> weight = weights(points.size());
  const auto evaluated = evaluator(points);
  std::vector<PointDistance> found;
  evaluated->distances(candidate, found);
  const PoseCell cell{0.05, 0.02};
  for (const std::size_t stride : {1U, 7U, 332U, 1000U, 1U}) {
    double objective = 0.0;
    double bound = 0.0;
    double smallest = infinity;
    std::vector<std::array<double, 3>> sizes(candidate.primitives.size());
    for (std::size_t n = 0; n < points.size(); n += stride) {
      const double d = found[n].distance;
      const double reach = cell.translation + cell.rotation * std::hypot(points[n][0] - candidate.pivot[0],
                                                                         points[n][1] - candidate.pivot[1],
                                                                         points[n][2] - candidate.pivot[2]);
      objective += weight[n] * value(fitness, d);
      bound += weight[n] * value(fitness, std::clamp(fitness.target, d - reach, d + reach));
      smallest = std::min(smallest, d);
      for (std::size_t i = 0; i < 3; ++i)
        sizes[found[n].primitive][i] += weight[n] * slope(fitness, d) * found[n].size_gradient[i];
    }
    const Evaluation sums = evaluation(*evaluated, candidate, cell, stride);
    EXPECT_NEAR(sums.objective, objective, 1e-10) << stride;
    EXPECT_NEAR(sums.objective_bound, bound, 1e-10) << stride;
    EXPECT_EQ(sums.smallest_distance, smallest) << stride;
    ASSERT_EQ(sums.size_gradient.size(), sizes.size());
    for (std::size_t k = 0; k < sizes.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(sums.size_gradient[k][i], sizes[k][i], 1e-9) << stride;
  }
}

// Points at which primitives are equally near would be kinks; these are none.
class GradientTest : public PoseObjectiveTest, public ::testing::WithParamInterface<double> {};

TEST_P(GradientTest, IsThatOfCentralDifferences) {
  Candidate candidate = implant();
  candidate.primitives[0].superquadric.taper = GetParam();
  candidate.primitives[1].superquadric.taper = 1.0 / GetParam();
  const auto evaluated = evaluator(points_about(candidate, 200, 0.93, 1.6));
  const Evaluation at = evaluation(*evaluated, candidate);
  ASSERT_LT(at.smallest_distance, 0.0);
  constexpr double step = 1e-5;
  const auto difference = [&](const auto& changed) {
    return (evaluation(*evaluated, changed(step)).objective - evaluation(*evaluated, changed(-step)).objective) /
           (2.0 * step);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const auto along = [i](double length) {
      Point vector{};
      vector[i] = length;
      return vector;
    };
    EXPECT_NEAR(at.pose_gradient[i], difference([&](double h) { return displaced(candidate, along(h), {}); }), 1e-5);
    EXPECT_NEAR(at.pose_gradient[3 + i], difference([&](double h) { return displaced(candidate, {}, along(h)); }),
                1e-5);
    EXPECT_GT(std::abs(at.pose_gradient[i]) + std::abs(at.pose_gradient[3 + i]), 0.1);
  }
  for (std::size_t k = 0; k < candidate.primitives.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto resized = [&](double h) {
        Candidate other = candidate;
        other.primitives[k].superquadric.semi_axes[i] += h;
        return other;
      };
      EXPECT_NEAR(at.size_gradient[k][i], difference(resized), 1e-5) << k << ", " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Tapers, GradientTest, ::testing::Values(1.0, 1.8));

TEST_F(PoseObjectiveTest, NoCandidateOfTheCellIsAboveTheBound) {
  const Candidate centre = implant();
  const auto evaluated = evaluator(points_about(centre, 200, 0.9, 1.5));
  Random random;
  for (const PoseCell& cell : {PoseCell{0.02, 0.0}, PoseCell{0.0, 0.05}, PoseCell{0.1, 0.1}, PoseCell{1.0, 1.0}}) {
    const Evaluation at = evaluation(*evaluated, centre, cell);
    EXPECT_GT(at.objective_bound, at.objective);
    for (int n = 0; n < 100; ++n) {
      const Candidate other = displaced(centre, random.in_ball(cell.translation), random.in_ball(cell.rotation));
      EXPECT_LE(evaluation(*evaluated, other).objective, at.objective_bound + 1e-10);
    }
  }
  EXPECT_EQ(evaluation(*evaluated, centre).objective_bound, evaluation(*evaluated, centre).objective);
}

bool same_bits(const Evaluation& a, const Evaluation& b) {
  return a.objective == b.objective && a.pose_gradient == b.pose_gradient && a.size_gradient == b.size_gradient &&
         a.smallest_distance == b.smallest_distance && a.objective_bound == b.objective_bound;
}

// More candidates than a launch takes on a processor.
TEST_F(PoseObjectiveTest, CandidatesGetTheSameBitsAloneAndAmongOthers) {
  const auto evaluated = evaluator(points_about(implant(), 700, 0.9, 3.0));
  Random random;
  std::vector<Candidate> candidates;
  candidates.reserve(1500);
  for (int n = 0; n < 1500; ++n) candidates.push_back(displaced(implant(), random.within(0.5), random.within(0.5)));
  std::vector<Evaluation> once;
  std::vector<Evaluation> again;
  evaluated->evaluate(candidates, fitness, {0.1, 0.1}, 1, once);
  evaluated->evaluate(candidates, fitness, {0.1, 0.1}, 1, again);
  ASSERT_EQ(once.size(), candidates.size());
  ASSERT_EQ(again.size(), candidates.size());
  for (std::size_t n = 0; n < once.size(); ++n) EXPECT_TRUE(same_bits(once[n], again[n])) << n;
  for (std::size_t n = 0; n < once.size(); n += 97)
    EXPECT_TRUE(same_bits(once[n], evaluation(*evaluated, candidates[n], {0.1, 0.1}))) << n;
  EXPECT_FALSE(same_bits(once[0], once[1]));
}

TEST_F(PoseObjectiveTest, CallsMayDifferInTheNumberOfPrimitives) {
  const auto evaluated = evaluator(points_about(implant(), 100, 0.9, 3.0));
  Candidate one = implant();
  one.primitives.resize(1);
  const Evaluation before = evaluation(*evaluated, one);
  EXPECT_EQ(evaluation(*evaluated, implant()).size_gradient.size(), 3U);
  EXPECT_TRUE(same_bits(evaluation(*evaluated, one), before));
  std::vector<Evaluation> none{before};
  evaluated->evaluate({}, fitness, {}, 1, none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace verisq::device
