/// First contacts along motions beside closed forms: copies of one superquadric by its gauge, superquadrics and turning
/// ellipsoids above a flat face by their support functions.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>
#include <verisq/path.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq {
namespace {

using oracle::RandomCases;
using Number = long double;

const PathDistanceOptions tight{.tolerance = 1e-9, .time_tolerance = 1e-6};

/// Of long double, of poses rounded to binary64 and of bisection.
constexpr Number of_closed_form = 1e-10L;

/// `usually`, or VERISQ_PATH_CASES, for long runs.
std::size_t motions(std::size_t usually) {
  return oracle::requested_count("VERISQ_PATH_CASES", usually);
}

Model solid(const Point& centre, const Superquadric& superquadric) {
  Primitive primitive;
  primitive.superquadric = superquadric;
  primitive.pose.translation = centre;
  Model model;
  model.primitives = {primitive};
  return model;
}

/// An octahedron |x| + |y| + |z| <= edge: a half-space to whatever is near the middle of its face.
constexpr double edge = 48.0;
const Superquadric octahedron{.semi_axes = {edge, edge, edge}, .exponents = {2.0, 2.0}};

/// A miss is a contact that is denied or said to be later than it is, a false alarm one that is said to be earlier.
void expect_first_contact(const PathDistance& found, Number contact) {
  ASSERT_EQ(found.proximity, PathProximity::meeting);
  EXPECT_LE(found.apart_before, contact + of_closed_form);
  EXPECT_GE(*found.meet_at, contact - of_closed_form);
}

/// The time is open by the tolerance, or by what the solids take at `speed` to overlap by what single moments show.
bool is_narrow(const PathDistance& found, Number speed) {
  constexpr Number shown = 1e-6L * edge;
  return found.meet_at && *found.meet_at - found.apart_before <= std::max(Number(tight.time_tolerance), shown / speed);
}

/// Of a hundred meetings at least: near the end of a path, or where the speed falls, more of the time is open.
constexpr int usually_narrow = 99;

void expect_apart(const PathDistance& found, Number smallest) {
  EXPECT_EQ(found.proximity, PathProximity::apart);
  EXPECT_LE(found.smallest.lo, smallest + of_closed_form);
  EXPECT_GE(found.smallest.hi, smallest - of_closed_form);
}

/// (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/2) is a norm in the section, and so is the whole.
Number gauge(const Superquadric& solid, const std::array<Number, 3>& x) {
  std::array<Number, 3> u{};
  for (std::size_t i = 0; i < 3; ++i) u[i] = std::abs(x[i] / Number(solid.semi_axes[i]));
  const auto norm = [](Number p, Number q, Number exponent) {
    const Number power = 2 / exponent;
    return std::pow(std::pow(p, power) + std::pow(q, power), 1 / power);
  };
  return norm(norm(u[0], u[1], solid.exponents[1]), u[2], solid.exponents[0]);
}

/// The dual norm: 1/p + 1/q = 1 with p = 2/e.
Number support(const Superquadric& solid, const std::array<Number, 3>& direction) {
  std::array<Number, 3> u{};
  for (std::size_t i = 0; i < 3; ++i) u[i] = std::abs(direction[i] * Number(solid.semi_axes[i]));
  const auto norm = [](Number p, Number q, Number exponent) {
    const Number power = 2 / (2 - exponent);
    return std::pow(std::pow(p, power) + std::pow(q, power), 1 / power);
  };
  return norm(norm(u[0], u[1], solid.exponents[1]), u[2], solid.exponents[0]);
}

Superquadric random_superquadric(RandomCases& random) {
  return {.semi_axes = {random.uniform(0.3, 1.5), random.uniform(0.3, 1.5), random.uniform(0.3, 1.5)},
          .exponents = {random.uniform(0.2, 1.8), random.uniform(0.2, 1.8)}};
}

Superquadric scaled(const Superquadric& superquadric, double factor) {
  Superquadric copy = superquadric;
  for (double& a : copy.semi_axes) a *= factor;
  return copy;
}

/// A solid at rest meets a copy of itself when the gauge of the way between their centres is the sum of both sizes:
/// r K + s K = (r + s) K for a convex K, and K = -K. False where they meet at once, or may pass: nothing is asked of
/// those.
bool expect_contact_of_copies(RandomCases& random, const Superquadric& superquadric) {
  const double r = std::ldexp(1.0, static_cast<int>(random.choice(3)) - 1);  // scaled() is exact
  const double s = std::ldexp(1.0, static_cast<int>(random.choice(3)) - 1);
  Point start;
  Point end;
  const Point way = random.direction();
  for (std::size_t i = 0; i < 3; ++i) {
    start[i] = 8.0 * way[i];
    end[i] = random.uniform(-1.0, 1.0);
  }
  const auto size = [&](Number time) {
    std::array<Number, 3> x{};
    for (std::size_t i = 0; i < 3; ++i) x[i] = start[i] + time * (Number(end[i]) - start[i]);
    return gauge(superquadric, x);
  };
  const Number reach = Number(r) + s;
  if (size(0) <= reach || size(1) >= reach) return false;
  Number before = 0;
  Number after = 1;  // convex in time: one root
  for (int halvings = 0; halvings < 70; ++halvings) {
    const Number middle = (before + after) / 2;
    (size(middle) > reach ? before : after) = middle;
  }
  const std::vector<Pose> path{{.translation = start}, {.translation = end}};
  const PathDistance found =
      distance_along(path, solid({}, scaled(superquadric, r)), solid({}, scaled(superquadric, s)), tight);
  expect_first_contact(found, after);
  EXPECT_TRUE(found.reached);
  return true;
}

TEST(FirstContact, OfCopiesOfAnEllipsoidIsThatOfTheirGauge) {
  RandomCases random(51);
  int meeting = 0;
  for (std::size_t k = 0; k < motions(50); ++k) {
    SCOPED_TRACE(k);
    Superquadric ellipsoid = random_superquadric(random);
    ellipsoid.exponents = {1.0, 1.0};
    meeting += expect_contact_of_copies(random, ellipsoid) ? 1 : 0;
  }
  EXPECT_GT(meeting, 0);
}

TEST(FirstContact, OfCopiesOfASuperquadricIsThatOfTheirGauge) {
  RandomCases random(52);
  int meeting = 0;
  for (std::size_t k = 0; k < motions(50); ++k) {
    SCOPED_TRACE(k);
    meeting += expect_contact_of_copies(random, random_superquadric(random)) ? 1 : 0;
  }
  EXPECT_GT(meeting, 0);
}

/// Of the face in the first octant.
const Number component = 1 / std::numbers::sqrt3_v<Number>;
const Number face_offset = edge * component;

/// Above the middle of the face, at a height over its plane.
Point above_face(double height, double aside = 0.0) {
  const double middle = edge / 3.0 + height / std::numbers::sqrt3;
  return {middle + aside, middle - aside, middle};
}

Number height_over_face(const Point& x) {
  return (Number(x[0]) + x[1] + x[2]) * component - face_offset;
}

TEST(FirstContact, WithAFlatFaceIsThatOfTheSupportFunction) {
  RandomCases random(53);
  int apart = 0;
  int meeting = 0;
  int narrow = 0;
  for (std::size_t k = 0; k < motions(50); ++k) {
    SCOPED_TRACE(k);
    const Superquadric superquadric = random_superquadric(random);
    const Number reach = support(superquadric, {component, component, component});
    const Point start = above_face(random.uniform(4.0, 8.0), random.uniform(-2.0, 2.0));
    const Point end = above_face(random.uniform(0.2, 3.5), random.uniform(-2.0, 2.0));
    const Number from = height_over_face(start) - reach;
    const Number to = height_over_face(end) - reach;
    const std::vector<Pose> path{{.translation = start}, {.translation = end}};
    const PathDistance found = distance_along(path, solid({}, octahedron), solid({}, superquadric), tight);
    if (to > 1e-6L) {
      expect_apart(found, to);
      ++apart;
    } else if (to < -1e-6L) {
      expect_first_contact(found, from / (from - to));
      narrow += is_narrow(found, from - to) ? 1 : 0;
      ++meeting;
    }
  }
  EXPECT_GT(apart, 0);
  EXPECT_GT(meeting, 0);
  EXPECT_GE(100 * narrow, usually_narrow * meeting);
}

/// An ellipsoid turns about (1, -1, 0), which lies in the face: with n in its own frame, |A n| = its support, and n
/// runs through the plane of (1, 1, 0) and z, so that the squares of both are a sum of cosines of the doubled angle.
TEST(FirstContact, OfAnEllipsoidThatTurnsAboveAFaceIsThatOfItsSupportFunction) {
  RandomCases random(54);
  const Number across = 1 / std::numbers::sqrt2_v<Number>;
  int meeting = 0;
  int narrow = 0;
  for (std::size_t k = 0; k < motions(50); ++k) {
    SCOPED_TRACE(k);
    const double a = random.uniform(0.3, 2.0);
    const double c = random.uniform(0.3, 2.0);
    const Superquadric ellipsoid{.semi_axes = {a, a, c}, .exponents = {1.0, 1.0}};
    // n = sin(angle) (1, 1, 0)/√2 + cos(angle) z; the pose turns by t about (1, -1, 0)/√2, n by -t in the own frame.
    const Number face_angle = std::atan2(std::numbers::sqrt2_v<Number>, Number(1));
    const double half_turn = random.uniform(0.2, 1.3);
    const auto sine = static_cast<double>(std::sin(Number(half_turn)) * across);
    const std::array<double, 4> last{std::cos(half_turn), sine, -sine, 0.0};
    const Number turn = 2 * std::atan2(std::numbers::sqrt2_v<Number> * sine, Number(last[0]));
    const auto squared_support = [&](Number angle) {
      return (Number(a) * a + Number(c) * c) / 2 + (Number(c) * c - Number(a) * a) / 2 * std::cos(2 * angle);
    };
    const double height = random.uniform(std::min(a, c), std::max(a, c));
    const Point centre = above_face(height, random.uniform(-2.0, 2.0));
    const Number reached = height_over_face(centre);
    if (std::sqrt(squared_support(face_angle)) > reached - 1e-6L) continue;  // they meet at once
    // The pose's turn about (1, -1, 0) takes z to -(1, 1, 0)/√2, so that n in the own frame goes on from its angle.
    const Number cosine =
        (reached * reached - (Number(a) * a + Number(c) * c) / 2) / ((Number(c) * c - Number(a) * a) / 2);
    const Number root = std::acos(std::clamp(cosine, Number(-1), Number(1))) / 2;  // in [0, π/2]
    Number contact = 10;
    for (const Number angle : {root, std::numbers::pi_v<Number> - root, std::numbers::pi_v<Number> + root,
                               2 * std::numbers::pi_v<Number> - root}) {
      if (angle > face_angle) contact = std::min(contact, (angle - face_angle) / turn);
    }
    const std::vector<Pose> path{{.translation = centre}, {.translation = centre, .quaternion = last}};
    const PathDistance found = distance_along(path, solid({}, octahedron), solid({}, ellipsoid), tight);
    if (contact < 1 - 1e-6L) {
      expect_first_contact(found, contact);
      const Number half_slope = (Number(c) * c - Number(a) * a) * std::sin(2 * (face_angle + turn * contact)) / 2;
      narrow += is_narrow(found, std::abs(half_slope) * turn / reached) ? 1 : 0;
      ++meeting;
    } else if (contact > 1 + 1e-6L) {
      EXPECT_NE(found.proximity, PathProximity::meeting);
    }
  }
  EXPECT_GT(meeting, 0);
  EXPECT_GE(100 * narrow, usually_narrow * meeting);
}

}  // namespace
}  // namespace verisq
