/// Krawczyk's operator on systems with known zeros, and closest points of random pairs of the paper's solids.
#include "verify/search/krawczyk.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>
#include <verisq/distance.hpp>

#include "tests/fixtures/requested_count.hpp"

namespace verisq::verify {
namespace {

/// x^2 + y^2 = 4, x y = 1: a zero near (1.93, 0.52).
struct CircleAndHyperbola {
  SystemExpansion<2> operator()(const IntervalVector<2>& v) const {
    const PreciseInterval two(2);
    SystemExpansion<2> f;
    f.value << square(v[0]) + square(v[1]) - PreciseInterval(4), v[0] * v[1] - PreciseInterval(1);
    f.jacobian << two * v[0], two * v[1], v[1], v[0];
    return f;
  }
};

/// x^2 = a, y = 0: no zero, a double one or two.
struct Parabola {
  double a;

  SystemExpansion<2> operator()(const IntervalVector<2>& v) const {
    SystemExpansion<2> f;
    f.value << square(v[0]) - PreciseInterval(Real(a)), v[1];
    f.jacobian << PreciseInterval(2) * v[0], PreciseInterval(0), PreciseInterval(0), PreciseInterval(1);
    return f;
  }
};

/// sqrt(x) = 0 and y = 0: not differentiable at its zero.
struct Root {
  SystemExpansion<2> operator()(const IntervalVector<2>& v) const {
    SystemExpansion<2> f;
    f.value << sqrt(v[0]), v[1];
    f.jacobian << PreciseInterval(1) / (PreciseInterval(2) * sqrt(v[0])), PreciseInterval(0), PreciseInterval(0),
        PreciseInterval(1);
    return f;
  }
};

double middle(const PreciseInterval& x) {
  return static_cast<double>(x.lower().to_long_double());
}

IntervalVector<2> rectangle(double x0, double x1, double y0, double y1) {
  IntervalVector<2> result;
  result << PreciseInterval(Real(x0), Real(x1)), PreciseInterval(Real(y0), Real(y1));
  return result;
}

bool at_most_one(const auto& system, double x, const IntervalVector<2>& box) {
  return contains_at_most_one_zero<2>(system, rectangle(x, x, 0.5, 0.5), box);
}

TEST(KrawczykTest, TellsBoxesWithOneZeroFromThoseWithTwo) {
  EXPECT_TRUE(at_most_one(Parabola{1.0}, 1.0, rectangle(0.5, 1.4, -9.0, 9.0)));
  EXPECT_TRUE(at_most_one(Parabola{1.0}, 2.0, rectangle(1.5, 2.5, 0.5, 0.5)));  // none is at most one
  EXPECT_FALSE(at_most_one(Parabola{1.0}, 1.0, rectangle(-1.5, 1.5, -9.0, 9.0)));
  EXPECT_FALSE(at_most_one(Parabola{0.0}, 0.1, rectangle(-0.5, 0.5, -9.0, 9.0)));  // a double one
  EXPECT_FALSE(at_most_one(Root{}, 0.1, rectangle(0.0, 0.5, -9.0, 9.0)));
  EXPECT_TRUE(at_most_one(CircleAndHyperbola{}, 1.9, rectangle(1.7, 2.1, 0.4, 0.6)));
  EXPECT_FALSE(at_most_one(CircleAndHyperbola{}, 1.9, rectangle(0.4, 2.1, 0.4, 2.1)));  // and the mirror image
  EXPECT_TRUE(at_most_one(Parabola{1.0}, 1.0, rectangle(1.0, 1.0, 0.0, 0.0)));
}

TEST(KrawczykTest, EnclosesAKnownZero) {
  const auto zero = krawczyk<2>(CircleAndHyperbola{}, {Real(1.93), Real(0.52)});
  ASSERT_TRUE(zero);
  // x + y = sqrt(6), x - y = sqrt(2)
  const PreciseInterval x = (sqrt(PreciseInterval(6)) + sqrt(PreciseInterval(2))) / PreciseInterval(2);
  EXPECT_LE((*zero)[0].lower(), x.lower());
  EXPECT_GE((*zero)[0].upper(), x.upper());
  EXPECT_LT(subtract((*zero)[0].upper(), (*zero)[0].lower(), Direction::up), Real(1e-35));
  EXPECT_NEAR(middle((*zero)[1]), (std::sqrt(6.0) - std::sqrt(2.0)) / 2.0, 1e-15);
}

TEST(KrawczykTest, FindsEachOfTwoZerosFromItsOwnStart) {
  const auto left = krawczyk<2>(Parabola{2.0}, {Real(-1.4), Real(0)});
  const auto right = krawczyk<2>(Parabola{2.0}, {Real(1.4), Real(0)});
  ASSERT_TRUE(left && right);
  EXPECT_NEAR(middle((*left)[0]), -std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(middle((*right)[0]), std::sqrt(2.0), 1e-15);
}

TEST(KrawczykTest, DoesNotProveADoubleZero) {
  for (const double start : {1e-3, 1e-15, -1e-6}) {
    EXPECT_FALSE(krawczyk<2>(Parabola{0.0}, {Real(start), Real(0)})) << start;
  }
}

TEST(KrawczykTest, DoesNotProveAZeroThatIsNotThere) {
  for (const double start : {1e-3, 1.0, -0.7}) {
    EXPECT_FALSE(krawczyk<2>(Parabola{-1e-6}, {Real(start), Real(0)})) << start;
  }
}

TEST(KrawczykTest, DoesNotProveWhereTheDerivativeIsUnbounded) {
  EXPECT_FALSE(krawczyk<2>(Root{}, {Real(0), Real(0)}));
  EXPECT_FALSE(krawczyk<2>(Root{}, {Real(1e-30), Real(0)}));
}

// ---------------------------------------------------------------- closest points of random pairs

struct NamedSolid {
  const char* name;
  Superquadric solid;
};

const std::vector<NamedSolid> table5{{"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}},
                                     {"gem", {{0.43, 0.6, 1.9}, {1.5, 0.4}}},
                                     {"soap", {{3.4, 4.3, 1.7}, {0.1, 0.1}}}};

class RandomPoses {
 public:
  explicit RandomPoses(std::uint64_t seed) : engine_(seed) {}

  Pose operator()(double closest, double farthest) {
    Pose pose;
    for (double& q : pose.quaternion) q = normal_(engine_);
    Point direction{normal_(engine_), normal_(engine_), normal_(engine_)};
    const double length = std::hypot(direction[0], direction[1], direction[2]);
    const double radius = std::uniform_real_distribution<double>(closest, farthest)(engine_);
    for (std::size_t i = 0; i < 3; ++i) pose.translation[i] = direction[i] * radius / length;
    return pose;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

std::size_t requested_pairs() {
  return oracle::requested_count("VERISQ_PAIRS", 300);
}

double largest_side(const ClosestPoints& points) {
  double side = 0.0;
  for (std::size_t k = 0; k < 3; ++k) side = std::max({side, points.on_a[k].width(), points.on_b[k].width()});
  return side;
}

/// The distance of any two points of the boxes must be compatible with the enclosure of the distance.
bool compatible(const ClosestPoints& points, const Enclosure& distance) {
  double squared_low = 0.0;
  double squared_high = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = points.on_b[k].lo - points.on_a[k].hi;
    const double high = points.on_b[k].hi - points.on_a[k].lo;
    const double far = std::max(std::fabs(low), std::fabs(high));
    const double near = low > 0.0 ? low : high < 0.0 ? -high : 0.0;
    squared_low += near * near;
    squared_high += far * far;
  }
  return std::sqrt(squared_low) <= distance.hi * (1 + 1e-14) && std::sqrt(squared_high) >= distance.lo * (1 - 1e-14);
}

TEST(KrawczykTest, NearlyAllPairsOfThePapersSolidsHaveSmallUniqueBoxes) {
  fmt::print("{:<18}{:>8}{:>10}{:>16}{:>16}\n", "pair", "apart", "unique", "and <= 1e-12", "largest side");
  for (std::size_t i = 0; i < table5.size(); ++i) {
    for (std::size_t j = i; j < table5.size(); ++j) {
      const auto& [name_a, solid_a] = table5[i];
      const auto& [name_b, solid_b] = table5[j];
      const double size = std::max(std::ranges::max(solid_a.semi_axes), std::ranges::max(solid_b.semi_axes));
      const PairDistance pair(Model{"", {{"a", solid_a, {}}}}, Model{"", {{"b", solid_b, {}}}});
      RandomPoses random(1000 * i + j);
      std::size_t apart = 0;
      std::size_t unique = 0;
      std::size_t small = 0;
      double largest = 0.0;
      for (std::size_t k = 0; k < requested_pairs(); ++k) {
        const Pose pose = random(0.5 * size, 6.0 * size);
        const ModelDistance found = pair(pose);
        const auto points = pair.closest_points(found, pose);
        ASSERT_EQ(points.has_value(), found.proximity == Proximity::separated);
        if (!points) continue;
        const double side = largest_side(*points) / size;
        ++apart;
        unique += points->unique ? 1 : 0;
        small += points->unique && side <= 1e-12 ? 1 : 0;
        largest = std::max(largest, side);
        EXPECT_TRUE(compatible(*points, found.distance)) << name_a << " " << name_b << " " << k;
      }
      const auto pair_name = fmt::format("{} - {}", name_a, name_b);
      fmt::print("{:<18}{:>8}{:>10}{:>16}{:>16.2g}\n", pair_name, apart, unique, small, largest);
      EXPECT_GT(apart, requested_pairs() / 2);
      EXPECT_EQ(unique, apart) << pair_name;
      EXPECT_GE(static_cast<double>(small), 0.99 * static_cast<double>(apart)) << pair_name;
    }
  }
}

}  // namespace
}  // namespace verisq::verify
