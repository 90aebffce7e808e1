/// Octrees proved again: all of their cubes, none with another colour, and no file that differs by a byte.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/octree.hpp>

#include "tests/fixtures/grown_octree.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/solid_reference.hpp"
#include "verify/proof/empty_neighbourhood.hpp"
#include "verify/proof/exact_checker.hpp"

namespace verisq::testing {
namespace {

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

Point middle_of(const ColouredCube& cube, const OctreeRoot& root) {
  Point middle = root.centre;
  for (std::size_t i = 0; i < 3; ++i) middle[i] += root.half_width * cube.centre[i];
  return middle;
}

/// Counts false claims of the octrees of a model, none of which may be proved.
class ForgedOctrees {
 public:
  ForgedOctrees(const Model& model, std::string name)
      : model_(model), name_(std::move(name)), grown_(grow(model, 3)), reference_(model) {}

  [[nodiscard]] std::size_t tried() const { return tried_; }

  /// A cube has one colour at most.
  void exchange_colours() {
    const OctreeChecker checker(model_, grown_.summary.root, grown_.cubes);
    for (const ColouredCube& cube : checker.cubes()) {
      expect_not(checker, cube, cube.colour == CubeColour::black ? CubeColour::white : CubeColour::black);
    }
  }

  /// A cube that an independent reference finds points of both kinds in has none.
  void colour_gray_cubes() {
    const OctreeRoot& root = grown_.summary.root;
    const OctreeChecker checker(model_, root, grown_.cubes);
    for (const OctreeCube& cube : grown_.cubes) {
      if (cube.colour != CubeColour::gray) continue;
      const double half_width = std::ldexp(1.0, -cube.level);
      ColouredCube open{{}, half_width, CubeColour::gray};
      for (std::size_t i = 0; i < 3; ++i) open.centre[i] = (2.0 * cube.position[i] + 1.0) * half_width - 1.0;
      const oracle::Membership side = side_of(open, root);
      if (side == oracle::Membership::inside) expect_not(checker, open, CubeColour::white);
      if (side == oracle::Membership::outside) expect_not(checker, open, CubeColour::black);
    }
  }

  /// Roots elsewhere, by a unit in the last place or by a cube, and smaller and larger ones: the octree is refused, or
  /// those of its cubes are not proved that the reference finds a point of the other kind in.
  void change_root() {
    const OctreeRoot& root = grown_.summary.root;
    for (std::size_t i = 0; i < 3; ++i) {
      for (const double way : {-1.0, 1.0}) {
        OctreeRoot moved = root;
        moved.centre[i] = std::nextafter(root.centre[i], way * infinity);
        expect_no_forged_cube(moved);
        moved.centre[i] = root.centre[i] + way * 0.25 * root.half_width;
        expect_no_forged_cube(moved);
      }
    }
    for (const double half_width : {std::nextafter(root.half_width, 0.0), std::nextafter(root.half_width, infinity),
                                    0.5 * root.half_width, 2.0 * root.half_width})
      expect_no_forged_cube({root.centre, half_width});
  }

 private:
  [[nodiscard]] oracle::Membership side_of(const ColouredCube& cube, const OctreeRoot& root) const {
    return reference_.facts(middle_of(cube, root), 0).side;
  }

  void expect_not(const OctreeChecker& checker, ColouredCube cube, CubeColour colour) {
    cube.colour = colour;
    EXPECT_FALSE(checker.proves(cube)) << fmt::format("{}, ({}, {}, {}) {} colour {}", name_, cube.centre[0],
                                                      cube.centre[1], cube.centre[2], cube.half_width,
                                                      static_cast<int>(colour));
    ++tried_;
  }

  void expect_no_forged_cube(const OctreeRoot& root) {
    try {
      const OctreeChecker checker(model_, root, grown_.cubes);
      for (const ColouredCube& cube : checker.cubes()) {
        const bool black = cube.colour == CubeColour::black;
        const auto other = black ? oracle::Membership::outside : oracle::Membership::inside;
        if (side_of(cube, root) == other) expect_not(checker, cube, cube.colour);
      }
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      ++tried_;
    }
  }

  const Model& model_;
  std::string name_;
  Grown grown_;
  oracle::SolidReference reference_;
  std::size_t tried_ = 0;
};

/// VERISQ_FORGED_OCTREES says of how many models.
TEST(OctreeChecker, NeverProvesAForgery) {
  std::size_t forged = 0;
  const std::size_t models = oracle::requested_count("VERISQ_FORGED_OCTREES", 4);
  for (std::size_t k = 0; k < models; ++k) {
    const Model model = random_model(k);
    ForgedOctrees octrees(model, fmt::format("model {}", k));
    octrees.exchange_colours();
    octrees.colour_gray_cubes();
    octrees.change_root();
    forged += octrees.tried();
    fmt::print("{} of {} models: {} forgeries, none may be proved\n", k + 1, models, forged);
    static_cast<void>(std::fflush(stdout));  // a long run shows how far it is
  }
  EXPECT_GT(forged, 300U);
}

/// One gray cube leaves seven white ones at each of 20 levels. Those that are false are seen to be so soon: each took
/// all looks that the checker has, 11 s for a file of two kilobytes.
TEST(OctreeChecker, SeesSoonThatACubeIsFalse) {
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  const verify::ExactChecker exact(ball);
  for (const verify::Place wanted : {verify::Place::outside, verify::Place::inside}) {
    const bool white = wanted == verify::Place::outside;
    const double x = white ? 0.0 : 2.0;
    const verify::EmptyNeighbourhood cube(exact.set(), exact.primitives(), verify::precise(Point{x, 0.0, 0.0}),
                                          verify::Real(0.5), wanted);
    EXPECT_FALSE(cube.is_empty(cube.whole()));
    EXPECT_TRUE(cube.is_refuted_at_middle(cube.whole()));
    const verify::EmptyNeighbourhood other(exact.set(), exact.primitives(), verify::precise(Point{2.0 - x, 0.0, 0.0}),
                                           verify::Real(0.5), wanted);
    EXPECT_FALSE(other.is_refuted_at_middle(other.whole()));
  }
}

/// A cube of many parts: none is looked at after that.
TEST(OctreeChecker, EndsWithinACubeOnceInterrupted) {
  const Model ball{"", {{"ball", {{1, 1, 1}, {1, 1}}, {}}}};
  const OctreeChecker checker(ball, {{0, 0, 0}, 2.0}, {});
  const ColouredCube beside{{0.375, 0.375, 0.375}, 0.0625, CubeColour::white};
  int asked = 0;
  ASSERT_TRUE(checker.proves(beside, [&] {
    ++asked;
    return false;
  }));
  ASSERT_GE(asked, 1);
  const int all = std::exchange(asked, 0);
  EXPECT_FALSE(checker.proves(beside, [&] { return ++asked == all; }));
  EXPECT_EQ(asked, all);
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

/// A root about a place whose corners round: what a viewer draws is another cube than the one that is proven.
TEST(OctreeChecker, RefusesCornersThatAreNoBinary64Numbers) {
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  const OctreeCube octant{{0, 0, 0}, 1, CubeColour::white};
  const auto refusal = [](const Model& model, const OctreeRoot& at, const OctreeCube& cube) -> std::string {
    try {
      static_cast<void>(OctreeChecker(model, at, std::span(&cube, 1)));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string sentence = "octree: a corner is no binary64 number: what is drawn is not what is proven";
  EXPECT_EQ(refusal(ball, {{0.0, 0.0, 0.0}, 4.0}, octant), "");
  EXPECT_EQ(refusal(ball, {{0x1p-52, 0.0, 0.0}, 4.0}, octant), sentence);
  EXPECT_EQ(refusal(ball, {{0.0, 0x1p53 + 2, 0.0}, 1.0}, octant), sentence);
  // Corners of the root are exact, those of a cube a quarter as large are not.
  const Model far{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {{0x1p53, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}}}};
  const OctreeRoot root{{0x1p53, 0.0, 0.0}, 2.0};
  EXPECT_EQ(refusal(far, root, {{0, 0, 0}, 0, CubeColour::gray}), "");
  EXPECT_EQ(refusal(far, root, {{2, 1, 0}, 2, CubeColour::gray}), sentence);
}

}  // namespace
}  // namespace verisq::testing
