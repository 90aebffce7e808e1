/// The way of points along a path of poses against 200 bits of MPFR: where they are, how far they travel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <vector>

#include "tests/oracle/random_cases.hpp"
#include "verify/solids/paths.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;
using Number =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>, boost::multiprecision::et_off>;
using Vector = std::array<Number, 3>;
using Quaternion = std::array<Number, 4>;

Number dot(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Quaternion unit(const std::array<double, 4>& q) {
  const Quaternion exact{q[0], q[1], q[2], q[3]};
  const Number length = sqrt(dot(exact, exact));
  return {exact[0] / length, exact[1] / length, exact[2] / length, exact[3] / length};
}

/// Shoemake's formula for the great arc: sines instead of the halvings that are tested.
Quaternion on_arc(const Quaternion& a, Quaternion b, const Number& s) {
  Number cosine = dot(a, b);
  if (cosine < 0) {
    for (Number& element : b) element = -element;
    cosine = -cosine;
  }
  if (cosine >= 1) return a;
  const Number angle = acos(cosine);
  const Number of_a = sin((1 - s) * angle) / sin(angle);
  const Number of_b = sin(s * angle) / sin(angle);
  Quaternion q;
  for (std::size_t i = 0; i < 4; ++i) q[i] = of_a * a[i] + of_b * b[i];
  return q;
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// R^T (c - t) at a time of the path.
Vector exact_local_point(const std::vector<Pose>& poses, const Point& c, double time) {
  const auto k = std::min(static_cast<std::size_t>(time), poses.size() - 1);
  const Pose& from = poses[k];
  const Pose& to = poses[std::min(k + 1, poses.size() - 1)];
  const Number s = Number(time) - Number(k);
  const Quaternion q = on_arc(unit(from.quaternion), unit(to.quaternion), s);
  Vector d;
  for (std::size_t i = 0; i < 3; ++i)
    d[i] = Number(c[i]) - Number(from.translation[i]) - s * (Number(to.translation[i]) - Number(from.translation[i]));
  const Vector back{-q[1], -q[2], -q[3]};
  const Vector once = cross(back, d);
  const Vector twice = cross(back, once);
  for (std::size_t i = 0; i < 3; ++i) d[i] += 2 * q[0] * once[i] + 2 * twice[i];
  return d;
}

Number distance(const Vector& a, const Vector& b) {
  const Number x = a[0] - b[0];
  const Number y = a[1] - b[1];
  const Number z = a[2] - b[2];
  return sqrt(x * x + y * y + z * z);
}

std::vector<Pose> random_poses(RandomCases& random, std::size_t count, double size) {
  std::vector<Pose> poses(count);
  for (Pose& pose : poses) {
    pose = random.solid().pose;
    for (double& coordinate : pose.translation) coordinate = size * random.uniform(-1.0, 1.0);
    const double length = random.log_uniform(1e-3, 1e3);
    for (double& element : pose.quaternion) element *= length;
  }
  return poses;
}

TEST(RigidPath, HoldsTheExactPointAtEveryTime) {
  RandomCases random(11);
  for (int n = 0; n < 100; ++n) {
    const double size = random.log_uniform(1e-6, 1e6);
    const std::vector<Pose> poses = random_poses(random, 3, size);
    const RigidPath path(poses);
    EXPECT_EQ(path.last_time(), 2.0);
    for (const double time : {0.0, 0.5, 0.25, 1.0, 1.0 + 0x1p-20, 1.6875, 2.0}) {
      const Point c{size * random.uniform(-2, 2), size * random.uniform(-2, 2), size * random.uniform(-2, 2)};
      const auto [centre, radius] = RigidPath::local_point(path.nearest_pose(time), c);
      const Number error = distance(exact_local_point(poses, c, time), {centre[0], centre[1], centre[2]});
      EXPECT_LE(error, Number(radius));
      EXPECT_LE(radius, 1e-13 * size);
    }
  }
}

/// The chords of a way are no longer than it, and of many chords hardly shorter.
/// Each digit costs an enclosure some of its own: what it has lost is in the radius, or nothing is known.
TEST(RigidPath, HoldsTheExactPointAtTimesOfManyDigits) {
  RandomCases random(9);
  std::size_t known = 0;
  for (int digits = 1; digits < 400; ++digits) {
    const std::vector<Pose> poses = random_poses(random, 2, 9.0);
    const RigidPath path(poses);
    const Point c{random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0)};
    // Ones and zeros in turn cost most.
    const double time = std::ldexp(digits % 2 == 0 ? 0x1.5555555555555p-1 : random.uniform(0.5, 1.0), -digits);
    const auto [centre, radius] = RigidPath::local_point(path.nearest_pose(time), c);
    if (!std::isfinite(radius)) continue;
    ++known;
    const Number error = distance(exact_local_point(poses, c, time), {centre[0], centre[1], centre[2]});
    EXPECT_LE(error, Number(radius)) << digits;
  }
  EXPECT_GT(known, 10U);
}

TEST(RigidPath, BoundsTheLengthOfTheWayTightly) {
  RandomCases random(12);
  for (int n = 0; n < 100; ++n) {
    const double size = random.log_uniform(1e-3, 1e3);
    const std::vector<Pose> poses = random_poses(random, 3, size);
    const RigidPath path(poses);
    const Point c{size * random.uniform(-2, 2), size * random.uniform(-2, 2), size * random.uniform(-2, 2)};
    Number whole = 0;
    double bounds = 0.0;
    const int chords = 64;
    for (int k = 0; k < chords; ++k) {
      const double begin = 2.0 * k / chords;
      const double end = 2.0 * (k + 1) / chords;
      const Number chord = distance(exact_local_point(poses, c, begin), exact_local_point(poses, c, end));
      EXPECT_LE(chord, Number(path.length_up(c, begin, end)));
      whole += chord;
      bounds += path.length_up(c, begin, end);
    }
    EXPECT_LE(whole, Number(path.length_up(c, 0.0, 2.0)));
    EXPECT_LE(bounds, 1.1 * whole.convert_to<double>());
  }
}

/// A path that winds, each leg as long as `step` times `size` at most.
std::vector<Pose> winding_path(RandomCases& random, std::size_t count, double size, double step) {
  std::vector<Pose> poses = random_poses(random, count, size);
  for (std::size_t k = 1; k < count; ++k) {
    for (std::size_t i = 0; i < 3; ++i)
      poses[k].translation[i] = poses[k - 1].translation[i] + step * poses[k].translation[i];
    const Quaternion last = unit(poses[k - 1].quaternion);
    const Quaternion next = unit(poses[k].quaternion);
    for (std::size_t i = 0; i < 4; ++i)
      poses[k].quaternion[i] = (last[i] + Number(step) * next[i]).convert_to<double>();
  }
  return poses;
}

/// Over many legs the bound is by sums that are made once: no shorter than the chords, and for the point that it is
/// about as tight as leg by leg.
TEST(RigidPath, BoundsTheLengthOfManyLegs) {
  RandomCases random(13);
  for (int n = 0; n < 30; ++n) {
    const double size = random.log_uniform(1e-3, 1e3);
    const std::vector<Pose> poses = winding_path(random, 60, size, 0.1);
    const Point about{size * random.uniform(-2, 2), size * random.uniform(-2, 2), size * random.uniform(-2, 2)};
    const RigidPath path(poses, about);
    const double begin = random.uniform(0.0, 20.0);
    const double end = random.uniform(40.0, 59.0);
    Point c = about;
    for (const double apart : {0.0, 1e-3, 1.0, 10.0}) {
      for (double& coordinate : c) coordinate += apart * size * random.uniform(-1.0, 1.0);
      Number chords = 0;
      double by_legs = 0.0;
      const int count = 240;
      for (int k = 0; k < count; ++k) {
        const double from = begin + (end - begin) * k / count;
        const double to = begin + (end - begin) * (k + 1) / count;
        chords += distance(exact_local_point(poses, c, from), exact_local_point(poses, c, to));
        by_legs += path.length_up(c, from, to);
      }
      const double bound = path.length_up(c, begin, end);
      EXPECT_LE(chords, Number(bound)) << apart;
      if (apart == 0.0) {
        EXPECT_LE(bound, 1.2 * by_legs);
      }
    }
  }
}

TEST(RigidPath, KnowsExactlyHowFarTranslationsMove) {
  const std::vector<Pose> poses{{{1.0, 2.0, 3.0}, {2.0, 0.0, 0.0, 0.0}}, {{4.0, 6.0, 3.0}, {3.0, 0.0, 0.0, 0.0}}};
  const double length = RigidPath(poses).length_up({10.0, -20.0, 30.0}, 0.25, 0.75);
  EXPECT_GE(length, 2.5);
  EXPECT_LE(length, 2.5 * (1.0 + 1e-13));
}

TEST(RigidPath, KnowsThatPointsOnTheAxisRest) {
  // A third of a turn about the diagonal through (1, 2, 3), which moves the origin.
  const std::vector<Pose> poses{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}, {0.5, 0.5, 0.5, 0.5}}};
  const RigidPath path(poses);
  const double third = 2.0 * std::acos(-1.0) / 3.0;
  // Rounding: units in the last place of the sums of the absolute coordinates of the spin and the point.
  EXPECT_LE(path.length_up({2.0, 2.0, 2.0}, 0.0, 1.0), 0x1p-46 * (std::sqrt(3.0) * third) * 6.0);
  EXPECT_NEAR(path.length_up({1.0, -1.0, 0.0}, 0.0, 1.0), third * std::sqrt(2.0), 1e-12);
}

TEST(RigidPath, TurnsTheShorterWay) {
  const std::vector<Pose> poses{{{}, {1.0, 0.0, 0.0, 0.0}}, {{}, {-0.96, 0.0, 0.0, -0.28}}};  // about 32.5 degrees
  const double length = RigidPath(poses).length_up({1.0, 0.0, 0.0}, 0.0, 1.0);
  EXPECT_NEAR(length, 2.0 * std::asin(0.28), 1e-12);
}

TEST(RigidPath, TurnsHalfATurnEitherWay) {
  const std::vector<Pose> poses{{{}, {1.0, 0.0, 0.0, 0.0}}, {{}, {0.0, 0.0, 0.0, 1.0}}};
  const RigidPath path(poses);
  EXPECT_NEAR(path.length_up({1.0, 0.0, 0.0}, 0.0, 1.0), std::acos(-1.0), 1e-12);
  const Point half_way = RigidPath::local_point(path.nearest_pose(0.5), {1.0, 0.0, 0.0}).centre;
  EXPECT_NEAR(std::abs(half_way[1]), 1.0, 1e-15);
}

TEST(RigidPath, RestsWhereNothingMoves) {
  // Parallel quaternions of different lengths, not exactly so.
  const Pose first{{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3, 0.4}};
  Pose second = first;
  for (double& element : second.quaternion) element *= 3.7;
  EXPECT_LE(RigidPath(std::vector{first, second}).length_up({5.0, 5.0, 5.0}, 0.0, 1.0), 1e-13);
  EXPECT_LE(RigidPath(std::vector{first, first}).length_up({5.0, 5.0, 5.0}, 0.0, 1.0), 1e-13);
}

}  // namespace
}  // namespace verisq::verify
