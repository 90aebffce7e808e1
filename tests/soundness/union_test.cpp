/// Unions of posed solids: outside the smallest distance, inside an enclosure that is honest about overlap.
///
/// For a union U of solids K_i, and at every point q, sd(q, U) <= min_i sd(q, K_i), with equality outside; and
/// sd(q, U) >= -|q - w| for every point w outside all K_i, sd(q, U) <= -r for every ball about q that cubes, each in
/// one K_i, cover. Where the solids are disjoint, nested or equal, sd(q, U) is min_i sd(q, K_i) inside too.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>
#include <verisq/distance.hpp>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/oracle/covered_ball.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {
namespace {

/// How sd(q, U) follows from the sd(q, K_i) at points inside.
enum class Inside { bounded_by_facts, minimum_is_exact };

struct Scene {
  std::string name;
  std::vector<Primitive> primitives;
  Inside inside;

  [[nodiscard]] Model model() const { return {"", primitives}; }
  [[nodiscard]] double size() const { return bounding_radius(model()); }
};

class UnionReference {
 public:
  explicit UnionReference(const Scene& scene) : inside_(scene.inside), ball_(scene.primitives) {
    RandomCases random(7);
    for (const Primitive& p : scene.primitives) solids_.emplace_back(p.superquadric, p.pose);
    for (const PosedSolid& solid : solids_) {
      for (int i = 0; i < samples_a_solid; ++i) {
        Vector u = widened(random.direction());
        for (std::size_t k = 0; k < 3; ++k) u[k] *= solid.norm().semi_axes()[k];
        const Vector w = solid.from_own_frame(scaled<Real>(u, (1 + ldexp(Real(1), -40)) / solid.norm().gauge(u)));
        if (is_outside(w)) outside_points_.push_back(w);
      }
    }
  }

  struct Facts {
    Real lower;  ///< proven to be at most the signed distance
    Real upper;  ///< at least the signed distance
    bool outside;
    bool ball_is_covered;  ///< `upper` comes from a covered ball
  };

  [[nodiscard]] Facts facts(const Point& point, Search search) const {
    Facts facts{std::numeric_limits<Real>::infinity(), std::numeric_limits<Real>::infinity(), false, false};
    for (const PosedSolid& solid : solids_) {
      const ReferenceDistance distance = solid.signed_distance(point, search);
      facts.lower = std::min(facts.lower, distance.lower);
      facts.upper = std::min(facts.upper, distance.upper);
    }
    facts.outside = facts.lower > 0;
    if (facts.outside || inside_ == Inside::minimum_is_exact) return facts;
    facts.lower = -distance_to_outside(widened(point));
    const double radius = 0.9 * facts.lower.convert_to<double>();
    facts.ball_is_covered = radius < facts.upper && ball_.inside_union(point, -radius);
    if (facts.ball_is_covered) facts.upper = radius;
    return facts;
  }

 private:
  static constexpr int samples_a_solid = 250;
  static constexpr int refinements = 60;

  [[nodiscard]] bool is_outside(const Vector& w) const {
    const Real margin = 1 + ldexp(Real(1), -150);
    return std::all_of(solids_.begin(), solids_.end(),
                       [&](const PosedSolid& solid) { return solid.norm().gauge(solid.to_own_frame(w)) > margin; });
  }

  /// Distance to a point proven to be outside: the nearest sample, drawn nearer by trial.
  [[nodiscard]] Real distance_to_outside(const Vector& q) const {
    const auto distance = [&q](const Vector& w) { return length(difference(q, w)); };
    Vector best = *std::min_element(outside_points_.begin(), outside_points_.end(),
                                    [&](const Vector& a, const Vector& b) { return distance(a) < distance(b); });
    RandomCases random(8);
    double step = 0.25;
    for (int i = 0; i < refinements; ++i) {
      const Real reach = distance(best) * step;
      const Point u = random.direction();
      Vector trial;
      for (std::size_t k = 0; k < 3; ++k) trial[k] = best[k] + step / 2 * (q[k] - best[k]) + reach * u[k];
      if (distance(trial) < distance(best) && is_outside(trial)) {
        best = trial;
      } else {
        step *= 0.92;
      }
    }
    return distance(best);
  }

  Inside inside_;
  CoveredBall ball_;
  std::vector<PosedSolid> solids_;
  std::vector<Vector> outside_points_;
};

/// Points in and around every solid of the scene, and in the box of all of them.
[[nodiscard]] std::vector<Point> query_points(const Scene& scene, std::size_t count) {
  RandomCases random(9);
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Primitive& primitive = scene.primitives[random.choice(scene.primitives.size())];
    points.push_back(random.point(primitive).point);
    if (i % 4 == 0) {
      const double reach =
          2 * *std::max_element(primitive.superquadric.semi_axes.begin(), primitive.superquadric.semi_axes.end());
      for (std::size_t k = 0; k < 3; ++k) {
        points.back()[k] = primitive.pose.translation[k] + reach * random.uniform(-1, 1);
      }
    }
  }
  return points;
}

[[nodiscard]] Primitive sphere(double radius, const Point& centre) {
  return {"sphere", {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}};
}

[[nodiscard]] Primitive box(const Point& semi_axes, const Point& centre) {
  return {"box", {semi_axes, {0.1, 0.1}}, {centre, {1.0, 0.0, 0.0, 0.0}}};
}

/// Two to six random solids of like sizes, near each other.
[[nodiscard]] Scene random_scene(std::uint64_t seed) {
  RandomCases random(seed);
  Scene scene{fmt::format("random {}", seed), {}, Inside::bounded_by_facts};
  const std::size_t count = 2 + random.choice(5);
  while (scene.primitives.size() < count) {
    Primitive primitive = random.solid();
    auto& axes = primitive.superquadric.semi_axes;
    const double size = *std::max_element(axes.begin(), axes.end());
    const double wanted = random.log_uniform(0.3, 3.0);
    for (double& axis : axes) axis *= wanted / size;
    for (double& coordinate : primitive.pose.translation) coordinate = random.uniform(-1.5, 1.5);
    scene.primitives.push_back(primitive);
  }
  return scene;
}

[[nodiscard]] std::vector<Scene> chosen_scenes() {
  const Primitive stem{"stem", {{6.0, 9.0, 60.0}, {0.4, 0.9}}, {{1.0, -2.0, -40.0}, {0.9, 0.1, -0.2, 0.05}}};
  const Primitive shard{"shard", {{0.5, 2.0, 7.0}, {2.0, 1.3}}, {{0.3, 0.1, -0.2}, {0.3, 0.5, 0.1, -0.7}}};
  return {
      {"touching boxes", {box({1, 1, 1}, {-1, 0, 0}), box({1, 1, 1}, {1, 0, 0})}, Inside::bounded_by_facts},
      {"overlapping boxes", {box({1, 2, 1}, {-0.5, 0, 0}), box({2, 1, 1}, {0.5, 0, 0.25})}, Inside::bounded_by_facts},
      {"sphere on a stem", {sphere(14.0, {10.0, 0.0, 15.0}), stem}, Inside::bounded_by_facts},
      {"sphere far from a stem", {sphere(14.0, {200.0, 0.0, 15.0}), stem}, Inside::minimum_is_exact},
      {"nested", {shard, sphere(9.0, {0.0, 0.0, 0.0})}, Inside::minimum_is_exact},
      {"twins", {shard, shard}, Inside::minimum_is_exact},
      {"overlapping spheres", {sphere(1.0, {-0.5, 0, 0}), sphere(1.0, {0.5, 0, 0})}, Inside::bounded_by_facts},
  };
}

constexpr std::size_t random_scenes = 16;

[[nodiscard]] std::vector<Scene> all_scenes() {
  std::vector<Scene> scenes = chosen_scenes();
  for (std::uint64_t seed = 1; seed <= random_scenes; ++seed) scenes.push_back(random_scene(seed));
  return scenes;
}

[[nodiscard]] bool agree(const Enclosure& enclosure, const UnionReference::Facts& facts) {
  return enclosure.lo <= enclosure.hi && Real(enclosure.lo) <= facts.upper && Real(enclosure.hi) >= facts.lower;
}

/// `prove(scene, points, tolerance)` returns one enclosure a point.
template <class Prove>
void expect_honest(std::size_t points_a_scene, const Prove& prove) {
  std::size_t inside = 0;
  std::size_t covered = 0;
  std::size_t cases = 0;
  for (const Scene& scene : all_scenes()) {
    const std::vector<Point> points = query_points(scene, points_a_scene);
    const std::array<double, 2> tolerances{0.0, 1e-6 * scene.size()};
    const std::array proven{prove(scene, points, tolerances[0]), prove(scene, points, tolerances[1])};
    ASSERT_EQ(proven[0].size(), points.size());
    ASSERT_EQ(proven[1].size(), points.size());
    const UnionReference reference(scene);
    std::vector<UnionReference::Facts> facts(points.size());
    in_parallel(points.size(), [&](std::size_t i) {
      facts[i] = reference.facts(points[i], Search::usual);
      const bool again = !agree(proven[0][i], facts[i]) || !agree(proven[1][i], facts[i]);
      if (again) facts[i] = reference.facts(points[i], Search::thorough);
    });
    for (std::size_t i = 0; i < points.size(); ++i) {
      inside += facts[i].outside ? 0 : 1;
      covered += facts[i].ball_is_covered ? 1 : 0;
      for (const std::vector<Enclosure>& enclosures : proven) {
        ++cases;
        EXPECT_TRUE(agree(enclosures[i], facts[i])) << fmt::format(
            "{}, point {:.17g}: [{:.17g}, {:.17g}] against [{}, {}]", scene.name, fmt::join(points[i], " "),
            enclosures[i].lo, enclosures[i].hi, text(facts[i].lower), text(facts[i].upper));
      }
    }
  }
  fmt::print("{} enclosures; of their points {} inside, {} of them deeper than any one solid says\n", cases, inside,
             covered);
}

[[nodiscard]] std::vector<Enclosure> by_host(const Scene& scene, std::span<const Point> points, double tolerance) {
  const SignedDistance distance(scene.model());
  std::vector<Enclosure> enclosures(points.size());
  in_parallel(points.size(), [&](std::size_t i) { enclosures[i] = distance(points[i], tolerance); });
  return enclosures;
}

[[nodiscard]] std::vector<Enclosure> by_map(const Scene& scene, std::span<const Point> points, double tolerance) {
  std::vector<Enclosure> enclosures;
  for (const MapResult& row : map_in_memory(scene.model(), points, {.tolerance = tolerance}).rows) {
    enclosures.push_back(row.distance);
  }
  return enclosures;
}

TEST(UnionTest, HostIsHonest) {
  expect_honest(60, by_host);
}

TEST(UnionTest, MapIsHonest) {
  expect_honest(120, by_map);
}

/// Spheres of radius 1 about (-c, 0, 0) and (c, 0, 0): the boundary nearest to the origin is the circle where they
/// meet, sqrt(1 - c^2) away, although either sphere alone is only 1 - c deep there.
TEST(UnionTest, OverlapOfTwoSpheresIsDeeperThanEither) {
  const Scene scene{"lens", {sphere(1.0, {-0.5, 0, 0}), sphere(1.0, {0.5, 0, 0})}, Inside::bounded_by_facts};
  const Real exact = -sqrt(Real(0.75));
  const std::vector<Point> origin{{0.0, 0.0, 0.0}};
  for (const double tolerance : {0.0, 1e-6}) {
    for (const Enclosure& enclosure : {by_host(scene, origin, tolerance)[0], by_map(scene, origin, tolerance)[0]}) {
      EXPECT_LE(Real(enclosure.lo), exact);
      EXPECT_GE(Real(enclosure.hi), exact);
    }
  }
}

/// Boxes that touch in one point: that point is on the boundary of the union, points on either side of it inside.
TEST(UnionTest, TouchingBoxesMeetOnTheBoundary) {
  const Scene scene{"touching", {box({1, 1, 1}, {-1, 0, 0}), box({1, 1, 1}, {1, 0, 0})}, Inside::bounded_by_facts};
  const std::vector<Point> origin{{0.0, 0.0, 0.0}};
  for (const Enclosure& enclosure : {by_host(scene, origin, 0.0)[0], by_map(scene, origin, 0.0)[0]}) {
    EXPECT_LE(enclosure.lo, 0.0);
    EXPECT_GE(enclosure.hi, 0.0);
  }
}

}  // namespace
}  // namespace verisq::oracle
