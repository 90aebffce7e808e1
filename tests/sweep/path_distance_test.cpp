/// Distances along paths beside closed forms of balls that shift or circle, and beside the distances at single times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/path.hpp>

#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/sweep/random_paths.hpp"
#include "verify/solids/paths.hpp"

namespace verisq {
namespace {

using oracle::ball;
using oracle::pose_at;
using oracle::random_pose;
using oracle::random_union;
using oracle::RandomCases;
using Number = long double;

const PathDistanceOptions fine{.tolerance = 1e-9};
const PathDistanceOptions coarse{.tolerance = 1e-3, .time_tolerance = 1e-4};

/// VERISQ_PATH_CASES, for long runs.
int cases(int usually) {
  const char* asked = std::getenv("VERISQ_PATH_CASES");
  return asked != nullptr ? std::stoi(asked) : usually;
}

/// What is true of a motion.
struct Truth {
  Number smallest;  ///< of centres' distances, less the radii: below 0 where they overlap
  std::optional<Number> first_contact;
};

void expect_true(const PathDistance& found, const Truth& truth) {
  constexpr Number rounding = 1e-13L;  // of long double and of the closed forms
  constexpr Number of_time = 1e-9L;
  if (truth.smallest > rounding) {
    EXPECT_EQ(found.proximity, PathProximity::apart);
    EXPECT_LE(found.smallest.lo, truth.smallest + rounding);
    EXPECT_GE(found.smallest.hi, truth.smallest - rounding);
    EXPECT_TRUE(found.reached);
    return;
  }
  if (truth.smallest > -rounding) return;  // a graze
  EXPECT_EQ(found.smallest.lo, 0.0);
  if (found.proximity == PathProximity::undecided) {  // overlaps by less than moments can show
    EXPECT_GT(truth.smallest, -1e-6L);
    return;
  }
  ASSERT_EQ(found.proximity, PathProximity::meeting);
  EXPECT_LE(found.apart_before, *truth.first_contact + of_time);
  EXPECT_GE(*found.meet_at, *truth.first_contact - of_time);
}

/// The first root of |start + s way|^2 = reach^2 in [0, 1].
Truth of_shift(const Point& start, const Point& way, Number reach) {
  Number a = 0;
  Number b = 0;
  Number c = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    a += Number(way[i]) * way[i];
    b += Number(start[i]) * way[i];
    c += Number(start[i]) * start[i];
  }
  const Number nearest = std::clamp(-b / a, Number(0), Number(1));
  const Number smallest = std::sqrt(c + nearest * (2 * b + nearest * a)) - reach;
  if (smallest >= 0) return {smallest, std::nullopt};
  if (c <= reach * reach) return {smallest, 0};
  return {smallest, (-b - std::sqrt(b * b - a * (c - reach * reach))) / a};
}

Model of_two(const Primitive& first, const Primitive& second, SetOperation operation) {
  const auto leaf = [](std::uint32_t primitive) { return SetExpression{{}, SetOperation::unite, primitive}; };
  Model model{"", {first, second}, SetExpression{{leaf(0), leaf(1)}, operation}};
  model.primitives[0].name = "first";
  model.primitives[1].name = "second";
  return model;
}

/// The same ball for the search: hardly bent, hollow, or met with itself.
Model searched(RandomCases& random, Model ball) {
  Primitive& whole = ball.primitives[0];
  const std::size_t kind = random.choice(3);
  if (kind == 0) {
    whole.bend = Bend{.curvature = 1e-200, .angle_degrees = 20.0};
    return ball;
  }
  if (kind == 1) return of_two(whole, whole, SetOperation::intersect);
  Primitive hollow = whole;
  for (double& axis : hollow.superquadric.semi_axes) axis *= 0.2;
  return of_two(whole, hollow, SetOperation::subtract);
}

TEST(PathDistance, AgreesWithTheClosedFormOfBallsThatShift) {
  RandomCases random(41);
  for (int k = 0; k < cases(150); ++k) {
    SCOPED_TRACE(k);
    const double r = random.uniform(0.1, 1.0);
    const double s = random.uniform(0.1, 1.0);
    Point start;
    Point end;
    for (std::size_t i = 0; i < 3; ++i) {
      start[i] = random.uniform(-4.0, 4.0);
      end[i] = random.uniform(-4.0, 4.0);
    }
    const std::vector<Pose> path{{.translation = start}, {.translation = end}};
    const Point way{end[0] - start[0], end[1] - start[1], end[2] - start[2]};
    const Truth truth = of_shift(start, way, Number(r) + s);
    expect_true(distance_along(path, ball({}, r), ball({}, s), fine), truth);
    if (k % 5 != 0) continue;  // searches take longer
    expect_true(distance_along(path, searched(random, ball({}, r)), searched(random, ball({}, s)), coarse), truth);
  }
}

TEST(PathDistance, AgreesWithTheClosedFormOfBallsThatCircle) {
  RandomCases random(42);
  for (int k = 0; k < cases(150); ++k) {
    SCOPED_TRACE(k);
    const double r = random.uniform(0.1, 1.0);
    const double s = random.uniform(0.1, 1.0);
    const double radius = random.uniform(0.5, 4.0);
    const double height = random.uniform(-2.0, 2.0);
    const Point still{random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0), 0.0};
    const double half_turn = random.uniform(0.05, 1.5);
    const std::array<double, 4> last{std::cos(half_turn), 0.0, 0.0, std::sin(half_turn)};
    const std::vector<Pose> path{{}, {.quaternion = last}};
    // The distance falls and rises with the angle between the centres.
    const Number turn = 2 * std::atan2(Number(last[3]), Number(last[0]));
    Number angle = std::atan2(Number(still[1]), Number(still[0]));
    if (angle < 0) angle += 2 * std::numbers::pi_v<Number>;
    const Number away = std::hypot(Number(still[0]), Number(still[1]));
    const Number constant = Number(radius) * radius + away * away + Number(height) * height;
    const auto distance = [&](Number at) { return std::sqrt(constant - 2 * radius * away * std::cos(angle - at)); };
    const Number reach = Number(r) + s;
    Truth truth{std::min(distance(0), distance(turn)) - reach, std::nullopt};
    if (angle <= turn) truth.smallest = distance(angle) - reach;
    if (truth.smallest < 0) {
      const Number cosine = (constant - reach * reach) / (2 * radius * away);
      const Number half = std::acos(std::clamp(cosine, Number(-1), Number(1)));
      // Within `half` of the angle, or of the same angle a turn before.
      Number contact = angle - half;
      if (distance(0) <= reach) contact = 0;
      truth.first_contact = std::max(contact, Number(0)) / turn;
    }
    const Model moving = ball({radius, 0.0, height}, s);
    expect_true(distance_along(path, ball(still, r), moving, fine), truth);
    if (k % 5 != 0) continue;
    expect_true(distance_along(path, searched(random, ball(still, r)), searched(random, moving), coarse), truth);
  }
}

TEST(PathDistance, ContainsTheDistancesAtSingleTimes) {
  constexpr double rounding = 1e-11;
  constexpr double tolerance = 1e-6;
  constexpr int times = 40;
  RandomCases random(43);
  int apart = 0;
  int meeting = 0;
  for (int k = 0; k < cases(60); ++k) {
    SCOPED_TRACE(k);
    const Model a = random_union(random);
    const Model b = random_union(random);
    std::vector<Pose> path;
    for (std::size_t i = 0; i < 2 + random.choice(3); ++i) path.push_back(random_pose(random));
    const PathDistance found = distance_along(path, a, b, {.tolerance = tolerance});
    ++(found.proximity == PathProximity::apart ? apart : meeting);
    const PairDistance pair(a, b);
    const auto last = static_cast<double>(path.size() - 1);
    for (int i = 0; i <= times; ++i) {
      const double time = last * i / times;
      const ModelDistance at = pair(pose_at(path, time));
      EXPECT_GE(at.distance.hi, found.smallest.lo - rounding) << "time " << time;
      const bool proven_apart = time < found.apart_before;
      EXPECT_FALSE(proven_apart && at.proximity == Proximity::overlapping) << "time " << time;
    }
    EXPECT_LE(pair(pose_at(path, found.smallest_at)).distance.lo, found.smallest.hi + rounding);
    if (found.proximity == PathProximity::apart) {
      EXPECT_LE(found.smallest.width(), tolerance);
    }
    if (found.meet_at) {
      EXPECT_LE(pair(pose_at(path, *found.meet_at)).distance.lo, rounding);
    }
  }
  EXPECT_GT(apart, 0);
  EXPECT_GT(meeting, 0);
}

TEST(PathDistance, ContainsTheDistancesOfBendsAndSetOperationsAtSingleTimes) {
  constexpr int times = 12;
  constexpr std::uint64_t quick = 500;  // cubes of a search: a path takes hundreds
  oracle::RandomSolids solids(44);
  RandomCases random(45);
  int apart = 0;
  int meeting = 0;
  for (int k = 0; k < cases(11); ++k) {
    SCOPED_TRACE(k);
    const auto [a, b] = solids.pair();
    const double size = std::max(bounding_radius(a), bounding_radius(b));
    const double rounding = 1e-11 * size;
    std::vector<Pose> path;
    for (std::size_t i = 0; i < 2 + random.choice(2); ++i) {
      path.push_back(random_pose(random));
      for (double& t : path.back().translation) t *= 0.7 * size;
    }
    const double tolerance = 0.01 * size;
    const ModelSearch pair(a, b);
    if (pair(path.front(), {.tolerance = 0.1 * tolerance}).cubes > quick) continue;
    const PathDistance found = distance_along(path, a, b, {.tolerance = tolerance, .time_tolerance = 1e-3});
    apart += found.proximity == PathProximity::apart ? 1 : 0;
    meeting += found.proximity == PathProximity::meeting ? 1 : 0;
    const auto last = static_cast<double>(path.size() - 1);
    for (int i = 0; i <= times; ++i) {
      const double time = last * i / times;
      const SearchedDistance at = pair(pose_at(path, time), {.tolerance = 0.1 * tolerance});
      EXPECT_GE(at.distance.hi, found.smallest.lo - rounding) << "time " << time;
      EXPECT_FALSE(time < found.apart_before && at.proximity == Proximity::overlapping) << "time " << time;
    }
    const double nearest = found.meet_at.value_or(found.smallest_at);
    EXPECT_LE(pair(pose_at(path, nearest), {.tolerance = 0.1 * tolerance}).distance.lo, found.smallest.hi + rounding);
    if (found.proximity == PathProximity::apart) {
      EXPECT_LE(found.smallest.width(), tolerance);
    }
  }
  EXPECT_GT(apart, 0);
  EXPECT_GT(meeting, 0);
}

TEST(PathDistance, FindsWhatNoPoseShows) {
  // A ball through a gap that it touches at neither end: the poses alone are 4 apart from the other one.
  const std::vector<Pose> path{{.translation = {-5.0, 1.2, 0.0}}, {.translation = {5.0, 1.2, 0.0}}};
  const PathDistance found = distance_along(path, ball({}, 1.0), ball({}, 0.5), {.tolerance = 1e-6});
  ASSERT_EQ(found.proximity, PathProximity::meeting);
  EXPECT_LE(found.apart_before, 0.41);
  EXPECT_GE(*found.meet_at, 0.41);
  EXPECT_LE(*found.meet_at - found.apart_before, 1e-6);
}

TEST(PathDistance, IsTheDistanceOfASinglePose) {
  const std::vector<Pose> path{{.translation = {3.0, 0.0, 0.0}}};
  const PathDistance found = distance_along(path, ball({}, 1.0), ball({}, 0.5), {.tolerance = 1e-12});
  EXPECT_EQ(found.proximity, PathProximity::apart);
  EXPECT_LE(found.smallest.lo, 1.5);
  EXPECT_GE(found.smallest.hi, 1.5);
  EXPECT_TRUE(found.reached);
}

TEST(PathDistance, LeavesAGrazeUndecided) {
  const std::vector<Pose> path{{.translation = {-2.0, 1.5, 0.0}}, {.translation = {2.0, 1.5, 0.0}}};
  const PathDistance found = distance_along(path, ball({}, 1.0), ball({}, 0.5), {.tolerance = 1e-9});
  EXPECT_EQ(found.smallest.lo, 0.0);
  EXPECT_LE(found.smallest.hi, 1e-9);
  EXPECT_FALSE(found.proximity == PathProximity::apart);
}

// In units of their size they are the same numbers: squares of these lengths are none of binary64.
TEST(PathDistance, OfHugeAndTinyModelsIsThatOfOrdinaryOnes) {
  const auto at_size = [](double size, std::optional<Bend> bend, const Point& least_translation) {
    const auto solid = [&](double radius, double z) {
      return Primitive{"", {{radius * size, 0.5 * size, size}, {0.5, 1.0}}, {{0.0, 0.0, z * size}}, {}};
    };
    Model a{"", {solid(0.75, 0.0), solid(0.5, 1.0)}};
    if (bend) {
      a.primitives[0].bend = Bend{bend->curvature / size, bend->angle_degrees};
    } else {
      a.csg = SetExpression{{{.primitive = 0}, {.primitive = 1}}, SetOperation::subtract};
    }
    std::vector<Pose> path{{.translation = {3.0, 0.0, 0.0}},
                           {.translation = least_translation, .quaternion = {0.9, 0.1, 0.0, 0.2}}};
    for (Pose& pose : path) {
      for (double& t : pose.translation) t *= size;
    }
    return distance_along(path, a, ball({}, 0.5 * size), {.tolerance = 1e-3 * size});
  };
  for (const std::optional<Bend>& bend : {std::optional<Bend>(), std::optional(Bend{0.5, 30.0})}) {
    for (const Point& least : {Point{2.0, 0.25, 0.5}, Point{0.25, 0.25, 0.5}}) {
      const PathDistance ordinary = at_size(1.0, bend, least);
      for (const double size : {0x1p-997, 0x1p-664, 0x1p-515, 0x1p332, 0x1p997}) {
        SCOPED_TRACE(size);
        const PathDistance found = at_size(size, bend, least);
        EXPECT_EQ(found.proximity, ordinary.proximity);
        EXPECT_EQ(found.smallest.lo, ordinary.smallest.lo * size);
        EXPECT_EQ(found.smallest.hi, ordinary.smallest.hi * size);
        EXPECT_EQ(found.meet_at, ordinary.meet_at);
        EXPECT_EQ(found.apart_before, ordinary.apart_before);
      }
    }
  }
}

TEST(PathDistance, EndsWhenInterrupted) {
  const std::vector<Pose> path(500, Pose{.translation = {3.0, 0.0, 0.0}});
  PathDistanceOptions options{.tolerance = 0.0};
  options.interrupted = [] { return true; };
  const PathDistance found = distance_along(path, ball({}, 1.0), ball({}, 0.5), options);
  EXPECT_TRUE(found.interrupted);
  EXPECT_FALSE(found.reached);
  EXPECT_EQ(found.proximity, PathProximity::undecided);
}

TEST(PathDistance, RefusesWhatItCannotFollow) {
  const Model a = ball({}, 1.0);
  EXPECT_THROW((void)distance_along({}, a, a, fine), Error);
  const std::vector<Pose> nowhere{{.quaternion = {0.0, 0.0, 0.0, 0.0}}};
  EXPECT_THROW((void)distance_along(nowhere, a, a, fine), Error);
  const std::vector<Pose> path(2);
  EXPECT_THROW((void)distance_along(path, a, a, {.tolerance = -1.0}), Error);
  EXPECT_THROW((void)distance_along(path, a, a, {.tolerance = 1.0, .time_tolerance = 0.0}), Error);
  const std::vector<Pose> half_a_turn{{}, {.quaternion = {0.0, 0.0, 0.0, -1.0}}};
  EXPECT_THROW((void)distance_along(half_a_turn, a, a, fine), Error);
}

}  // namespace
}  // namespace verisq
