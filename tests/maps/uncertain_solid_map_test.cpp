/// Maps of bent solids and set operations whose sizes are uncertain: every member's distances lie in the rows.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/map.hpp>
#include <verisq/model.hpp>

#include "tests/fixtures/error_matchers.hpp"

namespace verisq {
namespace {

SetExpression leaf(std::uint32_t primitive) {
  return {.primitive = primitive};
}

/// A bent rod, a ball and a bore; what the bore takes away has a core that is kept: all uncertain.
UncertainModel scene(const SetExpression& csg) {
  UncertainModel model =
      Model{"",
            {{"rod", {{0.6, 0.8, 3.0}, {0.6, 0.8}}, {{0.1, 0.0, 0.0}, {0.9, 0.1, 0.3, 0.2}}, Bend{0.2, 40.0}},
             {"ball", {{1.2, 1.2, 1.2}, {1.0, 1.0}}, {{0.5, 0.2, 1.0}}},
             {"bore", {{0.4, 0.4, 2.5}, {0.3, 1.0}}, {{0.4, 0.1, 0.9}, {0.9, 0.3, 0.0, 0.1}}}},
            csg};
  for (UncertainPrimitive& primitive : model.primitives) {
    for (Enclosure& a : primitive.semi_axes) a = {0.95 * a.lo, 1.05 * a.hi};
    for (Enclosure& e : primitive.exponents) e = {0.9 * e.lo, e.hi};
  }
  return model;
}

std::vector<SetExpression> trees() {
  return {{{leaf(0), leaf(1), leaf(2)}, SetOperation::unite},
          {{{{leaf(0), leaf(1)}, SetOperation::unite}, leaf(2)}, SetOperation::subtract},
          {{leaf(1), {{leaf(2), leaf(0)}, SetOperation::subtract}}, SetOperation::subtract},
          {{{{leaf(1), leaf(2)}, SetOperation::subtract}, {{leaf(0), leaf(2)}, SetOperation::intersect}},
           SetOperation::unite}};
}

Model member(const UncertainModel& model, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto number = [&](const Enclosure& e) {
    const double at = std::clamp(1.6 * uniform(random) - 0.3, 0.0, 1.0);  // often an end
    return e.lo + at * (e.hi - e.lo);
  };
  Model result{model.units, {}, model.csg};
  for (const UncertainPrimitive& p : model.primitives) {
    const auto& [a, b, c] = p.semi_axes;
    result.primitives.push_back({p.name,
                                 {{number(a), number(b), number(c)}, {number(p.exponents[0]), number(p.exponents[1])}},
                                 {{p.translation[0].lo, p.translation[1].lo, p.translation[2].lo}, p.quaternion},
                                 p.bend});
  }
  return result;
}

std::vector<Point> points_around(std::size_t count) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> anywhere(-3.0, 3.5);
  std::vector<Point> points(count);
  for (Point& p : points) p = {anywhere(random) / 1.5, anywhere(random) / 1.5, anywhere(random)};
  return points;
}

template <class Query>
std::vector<MapResult> map(Mapper<Query> mapper, std::span<const Query> queries) {
  std::vector<MapResult> rows;
  mapper.map(
      [&](std::span<Query> chunk) {
        const std::size_t count = std::min(chunk.size(), queries.size());
        std::ranges::copy(queries.first(count), chunk.begin());
        queries = queries.subspan(count);
        return count;
      },
      [&](std::span<const Query>, std::span<const MapResult> results, std::span<const Certificate>) {
        rows.insert(rows.end(), results.begin(), results.end());
      });
  return rows;
}

class UncertainSolidMap : public ::testing::TestWithParam<int> {
 protected:
  [[nodiscard]] static UncertainModel model() { return scene(trees()[static_cast<std::size_t>(GetParam())]); }
};

TEST_P(UncertainSolidMap, PointsHoldEveryMember) {
  const std::vector<Point> points = points_around(40);
  constexpr double tolerance = 1e-4;
  for (const char* const device : {"host", "auto"}) {
    const auto rows = map<Point>(PointMapper(model(), {.tolerance = tolerance, .device = device}), points);
    ASSERT_EQ(rows.size(), points.size());
    const Bracket models = bracket(model());
    const SignedDistance smallest(models.smallest);
    const SignedDistance largest(models.largest);
    for (std::size_t i = 0; i < points.size(); i += 4) {
      EXPECT_GE(rows[i].distance.lo, largest(points[i], tolerance).lo - tolerance) << i;
      EXPECT_LE(rows[i].distance.hi, smallest(points[i], tolerance).hi + tolerance) << i;
    }
    std::mt19937_64 random(3);
    for (int draw = 0; draw < 12; ++draw) {
      const SignedDistance distance(member(model(), random));
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Enclosure found = distance(points[i], 1e-3);
        EXPECT_LE(rows[i].distance.lo, found.hi) << device << ' ' << i;
        EXPECT_GE(rows[i].distance.hi, found.lo) << device << ' ' << i;
      }
    }
  }
}

TEST_P(UncertainSolidMap, TrianglesAndPosesHoldEveryMember) {
  const std::vector<Point> corners = points_around(12);
  std::vector<Triangle> triangles;
  for (const Point& p : corners)
    triangles.push_back({p, {p[0] + 0.3, p[1], p[2] - 0.1}, {p[0], p[1] + 0.2, p[2] + 0.2}});
  const auto rows = map<Triangle>(TriangleMapper(model(), {.tolerance = 1e-3, .device = "host"}), triangles);
  const Model ball{"", {{"ball", {{0.3, 0.3, 0.3}, {1.0, 1.0}}, {}}}};
  std::vector<Pose> poses;
  for (const Point& p : corners) poses.push_back({p, {1.0, 0.0, 0.0, 0.0}});
  const auto pairs = map<Pose>(PoseMapper(model(), ball, {.tolerance = 1e-3}), poses);
  ASSERT_EQ(pairs.size(), poses.size());
  std::mt19937_64 random(5);
  for (int draw = 0; draw < 4; ++draw) {
    const Model drawn = member(model(), random);
    const TriangleSearch to_triangle(drawn);
    const ModelSearch to_ball(drawn, ball);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Enclosure found = to_triangle(triangles[i], 1e-3, {});
      EXPECT_LE(rows[i].distance.lo, found.hi) << i;
      EXPECT_GE(rows[i].distance.hi, found.lo) << i;
      const Enclosure apart = to_ball(poses[i], {.tolerance = 1e-3}).distance;
      EXPECT_LE(pairs[i].distance.lo, apart.hi) << i;
      EXPECT_GE(pairs[i].distance.hi, apart.lo) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Trees, UncertainSolidMap, ::testing::Range(0, 4));

/// Two balls of this radius, 2 apart.
UncertainModel lens(const Enclosure& radius) {
  UncertainModel model =
      Model{"",
            {{"a", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}, {"b", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {{2, 0, 0}}}},
            SetExpression{{leaf(0), leaf(1)}, SetOperation::intersect}};
  for (UncertainPrimitive& primitive : model.primitives) primitive.semi_axes = {radius, radius, radius};
  return model;
}

TEST(UncertainSolidMap, SaysWhetherAllMembersOrOnlySomeMayBeEmpty) {
  const auto refused = [](const UncertainModel& model, const std::string& message) {
    const MapOptions options{.tolerance = 0.3, .device = "host"};
    testing::expect_error([&] { (void)PointMapper(model, options); }, ErrorKind::input, "", message);
    testing::expect_error([&] { (void)TriangleMapper(model, options); }, ErrorKind::input, "", message);
    testing::expect_error([&] { (void)PoseMapper(lens({1.5, 1.5}), model, options); }, ErrorKind::input, "", message);
  };
  const std::string some =
      "the model's intervals are too wide: with what is kept at its smallest and what is removed at its largest the "
      "set "
      "operations leave no point, so that no distance is known to hold for all models that they allow; narrow them";
  refused(lens({0.9, 1.1}), some);
  refused(lens({0.7, 0.9}), "no model that the intervals allow has a point: the set operations leave nothing");
  refused(lens({0.9, 0.9}), "the model has no point at all: its set operations leave nothing");
  UncertainModel shell = lens({0.9, 1.1});
  shell.primitives[1] = shell.primitives[0];
  shell.primitives[1].semi_axes = {{{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}};
  shell.csg->operation = SetOperation::subtract;
  refused(shell, some);
}

}  // namespace
}  // namespace verisq
