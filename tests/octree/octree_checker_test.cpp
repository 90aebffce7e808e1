/// Octrees proved again: all of their cubes, none with another colour, and no file that differs by a byte.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/model_file.hpp>
#include <verisq/octree.hpp>
#include <verisq/octree_checker.hpp>
#include <verisq/octree_file.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/solid_reference.hpp"

namespace verisq::testing {
namespace {

struct Grown {
  OctreeSummary summary;
  std::vector<OctreeCube> cubes;
};

Grown grow(const Model& model, int depth) {
  OctreeOptions options;
  options.depth = depth;
  options.device = "host";
  Grown grown;
  OctreeBuilder builder(model, options);
  grown.summary = builder.build(
      [&](std::span<const OctreeCube> cubes) { grown.cubes.insert(grown.cubes.end(), cubes.begin(), cubes.end()); });
  return grown;
}

Model random_model(std::size_t k) {
  oracle::RandomSolids random(700 + k);
  return random.model(oracle::model_families[k % oracle::model_families.size()]);
}

/// A little more than that of the cubes, for what is beside the root.
void expect_upper_end(const OctreeChecker& checker, const OctreeSummary& summary) {
  const double edge = 2.0 * summary.root.half_width;
  EXPECT_GT(checker.volume().hi, summary.volume.hi);
  EXPECT_LT(checker.volume().hi, summary.volume.hi + 3e-12 * edge * edge * edge);
}

TEST(OctreeChecker, ProvesOctreesOfExamples) {
  for (const char* name : {"stem.json", "bent_stem.json", "gem.json"}) {
    const Model model = read_model(std::string(places::example("")) + name);
    const auto [summary, cubes] = grow(model, 5);
    const OctreeChecker checker(model, summary.root, cubes);
    EXPECT_EQ(checker.volume().lo, summary.volume.lo) << name;
    expect_upper_end(checker, summary);
    EXPECT_TRUE(std::ranges::all_of(checker.cubes(), [&](const ColouredCube& cube) { return checker.proves(cube); }));
  }
}

/// With the white cubes left out as well as with them.
TEST(OctreeChecker, ProvesOctreesOfRandomModels) {
  for (std::size_t k = 0; k < oracle::model_families.size(); ++k) {
    const Model model = random_model(k);
    auto [summary, cubes] = grow(model, 4);
    const std::size_t with_white = OctreeChecker(model, summary.root, cubes).cubes().size();
    std::erase_if(cubes, [](const OctreeCube& cube) { return cube.colour == CubeColour::white; });
    const OctreeChecker checker(model, summary.root, cubes);
    EXPECT_EQ(checker.cubes().size(), with_white);
    for (const ColouredCube& cube : checker.cubes()) {
      EXPECT_TRUE(checker.proves(cube)) << fmt::format("model {}, ({}, {}, {}) {} colour {}", k, cube.centre[0],
                                                       cube.centre[1], cube.centre[2], cube.half_width,
                                                       static_cast<int>(cube.colour));
    }
  }
}

/// A cube has one colour at most, and one that an independent reference finds points of both kinds in has none.
/// VERISQ_FORGED_OCTREES says of how many models.
TEST(OctreeChecker, NeverProvesAForgery) {
  std::size_t forged = 0;
  for (std::size_t k = 0; k < oracle::requested_count("VERISQ_FORGED_OCTREES", 7); ++k) {
    const Model model = random_model(k);
    const auto [summary, cubes] = grow(model, 3);
    const OctreeChecker checker(model, summary.root, cubes);
    const oracle::SolidReference reference(model);
    const auto expect_not = [&](ColouredCube cube, CubeColour colour) {
      cube.colour = colour;
      EXPECT_FALSE(checker.proves(cube)) << fmt::format("model {}, ({}, {}, {}) {} colour {}", k, cube.centre[0],
                                                        cube.centre[1], cube.centre[2], cube.half_width,
                                                        static_cast<int>(colour));
      ++forged;
    };
    for (const ColouredCube& cube : checker.cubes()) {
      expect_not(cube, cube.colour == CubeColour::black ? CubeColour::white : CubeColour::black);
    }
    for (const OctreeCube& cube : cubes) {
      if (cube.colour != CubeColour::gray) continue;
      const double half_width = std::ldexp(1.0, -cube.level);
      ColouredCube open{{}, half_width, CubeColour::gray};
      Point centre = summary.root.centre;
      for (std::size_t i = 0; i < 3; ++i) {
        open.centre[i] = (2.0 * cube.position[i] + 1.0) * half_width - 1.0;
        centre[i] += summary.root.half_width * open.centre[i];
      }
      const oracle::Membership side = reference.facts(centre, 0).side;
      if (side == oracle::Membership::inside) expect_not(open, CubeColour::white);
      if (side == oracle::Membership::outside) expect_not(open, CubeColour::black);
    }
  }
  fmt::print("{} forgeries, none proved\n", forged);
  EXPECT_GT(forged, 300U);
}

TEST(OctreeChecker, RefusesWhatIsNoOctree) {
  const Model ball{"", {{"ball", {{1, 1, 1}, {1, 1}}, {}}}};
  const OctreeRoot root{{0, 0, 0}, 2.0};
  const auto refused = [&](std::vector<OctreeCube> cubes, const OctreeRoot& at) {
    EXPECT_THROW(OctreeChecker(ball, at, cubes), Error);
  };
  refused({{{0, 0, 0}, 1, CubeColour::black}, {{0, 0, 0}, 1, CubeColour::gray}}, root);
  refused({{{0, 0, 0}, 0, CubeColour::gray}, {{5, 3, 1}, 3, CubeColour::black}}, root);
  refused({{{2, 0, 0}, 1, CubeColour::black}}, root);
  refused({{{0, 0, 0}, 21, CubeColour::black}}, root);
  refused({{{0, 0, 0}, 0, CubeColour::gray}}, {{0, 0, 0}, -2.0});
  refused({{{0, 0, 0}, 0, CubeColour::gray}}, {{1e30, 0, 0}, 1.0});
  refused({{{0, 0, 0}, 0, CubeColour::gray}}, {{0, 0, 0}, 1.5});  // its halves would not be exact everywhere
}

/// A root that the model reaches out of, near or far: cubes beside it are not proven to be white.
TEST(OctreeChecker, LooksBeyondTheRoot) {
  const Model ball{"", {{"ball", {{1, 1, 1}, {1, 1}}, {}}}};
  const std::vector<OctreeCube> whole{{{0, 0, 0}, 0, CubeColour::gray}};
  for (const OctreeRoot& root : {OctreeRoot{{0, 0, 0}, 0.5}, OctreeRoot{{0, 0, 0}, 0.125}, OctreeRoot{{40, 0, 0}, 1}}) {
    const OctreeChecker checker(ball, root, whole);
    EXPECT_EQ(checker.cubes().size() % 26, 0U);
    const auto proved = [&](const ColouredCube& cube) { return checker.proves(cube); };
    EXPECT_FALSE(std::ranges::all_of(checker.cubes(), proved));
  }
  const OctreeChecker checker(ball, {{0, 0, 0}, 1.0}, whole);
  EXPECT_EQ(checker.cubes().size(), 26U);  // touched by the ball, not met
  EXPECT_TRUE(std::ranges::all_of(checker.cubes(), [&](const ColouredCube& cube) { return checker.proves(cube); }));
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const std::filesystem::path& path, const OctreeContents& octree) {
  OctreeWriter writer(path, WhiteCubes::written);
  writer.append(octree.cubes);
  writer.finish(octree.root);
}

/// A file is what its cubes say, to the byte, or it is refused.
TEST(OctreeReader, ReadsWhatTheWriterWritesAndNothingElse) {
  const TemporaryFolder folder;
  const auto [summary, cubes] = grow(random_model(1), 3);
  write(folder / "octree.vtu", {summary.root, cubes});
  const OctreeContents read = read_octree(folder / "octree.vtu");
  write(folder / "again.vtu", read);
  const std::string bytes = bytes_of(folder / "octree.vtu");
  EXPECT_TRUE(bytes_of(folder / "again.vtu") == bytes);
  expect_upper_end(OctreeChecker(random_model(1), read.root, read.cubes), summary);
  oracle::RandomCases random(5);
  std::size_t refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string changed = bytes;
    changed[random.choice(changed.size())] ^= static_cast<char>(1U << random.choice(8));
    if (i == 0) changed.pop_back();
    if (i == 1) changed += "\n";
    if (i == 2) changed.resize(100);
    if (i == 3) changed.clear();
    const auto file = folder.file("changed.vtu", changed);
    try {
      write(folder / "again.vtu", read_octree(file));
      EXPECT_TRUE(bytes_of(folder / "again.vtu") == changed);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), ::testing::HasSubstr("changed.vtu"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 350U);
}

}  // namespace
}  // namespace verisq::testing
