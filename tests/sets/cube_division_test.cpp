/// Root cubes cover, halves are exact, distances enclose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "verify/search/octree_cube.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

bool covers(const Cube& cube, const Box& box) {
  return contains(cube, box.lower) && contains(cube, box.upper);
}

TEST(CubeDivisionTest, TheRootCoversTheBox) {
  for (const double size : {1e-300, 1e-12, 0.7, 1.0, 3.0, 1e12, 1e300}) {
    const Box box{{-0.3 * size, 1.1 * size, -2.0 * size}, {0.1 * size, 3.0 * size, -1.9 * size}};
    const auto root = root_cube(box);
    ASSERT_TRUE(root);
    EXPECT_TRUE(covers(*root, box)) << size;
    EXPECT_LE(root->half_width, 4.0 * size);
    EXPECT_EQ(std::exp2(std::round(std::log2(root->half_width))), root->half_width);
  }
  EXPECT_FALSE(root_cube({{-infinity, 0.0, 0.0}, {0.0, 0.0, 0.0}}));
}

TEST(CubeDivisionTest, AFarRootCoversTheBox) {
  const Box box{{1e9, 1e9, 1e9}, {1e9 + 1e-3, 1e9, 1e9}};
  const auto root = root_cube(box);
  ASSERT_TRUE(root);
  EXPECT_TRUE(covers(*root, box));
  EXPECT_LE(root->half_width, 4e-3);
}

/// One cube for octrees, the host's searches and the devices': what a rule asks for beyond is kept as well.
TEST(CubeDivisionTest, TheRootKeepsToItsRule) {
  for (const double far : {0.0, 3.0, 1e3, 1e9}) {
    const Box box{{far - 1.0, far - 0.5, -1.0}, {far + 1.0, far + 0.25, 1.0}};
    EXPECT_EQ(root_cube(box)->half_width, 1.0) << far;
    const Cube cube = *root_cube(box, {.margin = 1.0 / 64.0, .farthest = 16.0});
    const double reach = cube.half_width * 63.0 / 64.0;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LE(std::fabs(cube.centre[i]), 16.0 * cube.half_width);
      EXPECT_LE(cube.centre[i] - reach, box.lower[i]);
      EXPECT_GE(cube.centre[i] + reach, box.upper[i]);
      EXPECT_EQ(std::remainder(cube.centre[i], cube.half_width / 1024.0), 0.0);
    }
    EXPECT_EQ(cube.half_width, std::max(2.0, std::exp2(std::ceil(std::log2((far + 1.0) / 16.0))))) << far;
  }
}

TEST(CubeDivisionTest, HalvesTileTheCubeDownToTheLastDigit) {
  Cube cube = *root_cube({{99.0, 100.0, -3.0}, {100.0, 100.3, 5.0}});
  int depth = 0;
  while (const auto parts = halves(cube)) {
    for (const Cube& part : *parts) {
      EXPECT_EQ(2 * part.half_width, cube.half_width);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(std::fabs(part.centre[i] - cube.centre[i]), part.half_width);
      }
      EXPECT_TRUE(contains(cube, part.centre));
    }
    EXPECT_NE(parts->front().centre, parts->back().centre);
    cube = parts->back();
    ++depth;
  }
  EXPECT_GE(depth, 40);
  EXPECT_LE(depth, 60);
}

TEST(CubeDivisionTest, ContainsIsExactAtTheFaces) {
  const Cube cube{{0.0, 0.0, 0.0}, 1.0};
  EXPECT_TRUE(contains(cube, {1.0, -1.0, 1.0}));
  EXPECT_FALSE(contains(cube, {std::nextafter(1.0, 2.0), 0.0, 0.0}));
  EXPECT_TRUE(contains({{0x1p-60, 0.0, 0.0}, 1.0}, {1.0, 0.0, 0.0}));
  EXPECT_FALSE(contains({{-0x1p-60, 0.0, 0.0}, 1.0}, {1.0, 0.0, 0.0}));
}

TEST(CubeDivisionTest, Distances) {
  const Cube cube{{1.0, 1.0, 1.0}, 1.0};
  EXPECT_EQ(distance({1.5, 0.5, 2.0}, cube), (Enclosure{0.0, 0.0}));
  EXPECT_EQ(distance({5.0, 1.0, 6.0}, cube), (Enclosure{5.0, 5.0}));
  const Enclosure diagonal = distance({3.0, 3.0, 3.0}, cube);
  EXPECT_TRUE(diagonal.contains(std::sqrt(3.0)));
  EXPECT_LE(diagonal.width(), 1e-15);
  EXPECT_EQ(distance({1e300, 1.0, 1.0}, {{0.0, 1.0, 1.0}, 0.0}), (Enclosure{1e300, 1e300}));
  EXPECT_EQ(distance_to_faces({1.25, 1.0, 1.5}, cube), (Enclosure{0.5, 0.5}));
  EXPECT_EQ(distance_to_faces({2.0, 1.0, 1.5}, cube), (Enclosure{0.0, 0.0}));
}

}  // namespace
}  // namespace verisq::verify
