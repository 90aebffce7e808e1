/// Octrees: volumes that contain the closed form, colours that random points confirm, files that read back.
#include "host/maps/octree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <pugixml.hpp>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <verisq/device.hpp>
#include <verisq/octree.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/large_models.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "verify/search/octree_cube.hpp"

namespace verisq::testing {
namespace {

using Extended = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<50>>;

constexpr const char* unlike_the_origin = "octree: the model is too far from the origin for its size";

Model plain(std::array<double, 3> axes, std::array<double, 2> exponents) {
  return {"", {{"solid", {axes, exponents}, {}}}};
}

/// 2 a1 a2 a3 e1 e2 B(e1/2 + 1, e1) B(e2/2, e2/2), the volume of a plain superquadric.
Extended closed_form(const Superquadric& solid) {
  const auto beta = [](const Extended& x, const Extended& y) {
    return Extended(tgamma(x) * tgamma(y) / tgamma(x + y));
  };
  const auto& [a1, a2, a3] = solid.semi_axes;
  const Extended e1(solid.exponents[0]);
  const Extended e2(solid.exponents[1]);
  return 2 * Extended(a1) * a2 * a3 * e1 * e2 * beta(e1 / 2 + 1, e1) * beta(e2 / 2, e2 / 2);
}

struct Grown {
  OctreeSummary summary;
  std::vector<OctreeCube> cubes;
};

bool before(const OctreeCube& a, const OctreeCube& b) {
  return std::tie(a.level, a.position, a.colour) < std::tie(b.level, b.position, b.colour);
}

/// Cubes in a fixed order.
Grown grow(const Model& model, const OctreeOptions& options) {
  Grown grown;
  OctreeBuilder builder(model, options);
  grown.summary = builder.build(
      [&](std::span<const OctreeCube> cubes) { grown.cubes.insert(grown.cubes.end(), cubes.begin(), cubes.end()); });
  std::ranges::sort(grown.cubes, before);
  return grown;
}

OctreeOptions to_depth(int depth, const std::string& device = "auto") {
  OctreeOptions options;
  options.depth = depth;
  options.device = device;
  return options;
}

Extended volume_of(const OctreeRoot& root, const OctreeCube& cube) {
  return pow(Extended(edge(root, cube.level)), 3);
}

/// The cubes are the root, each part of it once, and the summary says of them what is true.
void expect_consistent(const Grown& grown) {
  const auto& [summary, cubes] = grown;
  std::vector<OctreeLevel> levels(summary.levels.size());
  Extended all = 0;
  Extended black = 0;
  Extended gray = 0;
  for (const OctreeCube& cube : cubes) {
    ASSERT_LT(cube.level, levels.size());
    for (const std::uint32_t i : cube.position) ASSERT_LT(i, 1U << cube.level);
    const Extended volume = volume_of(summary.root, cube);
    all += volume;
    if (cube.colour == CubeColour::black) black += volume;
    if (cube.colour == CubeColour::gray) gray += volume;
    auto& level = levels[cube.level];
    ++(cube.colour == CubeColour::black ? level.black : cube.colour == CubeColour::white ? level.white : level.gray);
  }
  EXPECT_EQ(all, pow(Extended(2 * summary.root.half_width), 3));
  EXPECT_LE(Extended(summary.volume.lo), black);
  EXPECT_GE(Extended(summary.volume.hi), black + gray);
  EXPECT_LE(summary.volume.hi - summary.volume.lo, (gray * (1 + 1e-12)).convert_to<double>() + 1e-300);
  for (std::size_t level = 0; level < levels.size(); ++level) {
    EXPECT_EQ(levels[level].black, summary.levels[level].black) << level;
    EXPECT_EQ(levels[level].white, summary.levels[level].white) << level;
    EXPECT_EQ(levels[level].gray, summary.levels[level].gray) << level;
  }
}

/// The local coordinates of a point of a bent, posed primitive by the paper's Eq. (2) inverted, and its gauge: an
/// evaluation of its own, at 50 digits.
Extended gauge(const Primitive& primitive, const std::array<Extended, 3>& point) {
  const auto& [w, x, y, z] = primitive.pose.quaternion;
  const Extended n = Extended(w) * w + Extended(x) * x + Extended(y) * y + Extended(z) * z;
  const Extended qw(w);
  const Extended qx(x);
  const Extended qy(y);
  const Extended qz(z);
  const Extended rotation[3][3] = {
      {1 - 2 * (qy * qy + qz * qz) / n, 2 * (qx * qy - qw * qz) / n, 2 * (qx * qz + qw * qy) / n},
      {2 * (qx * qy + qw * qz) / n, 1 - 2 * (qx * qx + qz * qz) / n, 2 * (qy * qz - qw * qx) / n},
      {2 * (qx * qz - qw * qy) / n, 2 * (qy * qz + qw * qx) / n, 1 - 2 * (qx * qx + qy * qy) / n}};
  std::array<Extended, 3> local;
  for (std::size_t i = 0; i < 3; ++i) {
    local[i] = 0;
    for (std::size_t j = 0; j < 3; ++j) local[i] += rotation[j][i] * (point[j] - primitive.pose.translation[j]);
  }
  if (primitive.bend && primitive.bend->curvature != 0.0) {
    const Extended k(primitive.bend->curvature);
    const Extended a = Extended(primitive.bend->angle_degrees) * boost::math::constants::pi<Extended>() / 180;
    const Extended bent_r = local[0] * cos(a) + local[1] * sin(a);
    const Extended s = local[1] * cos(a) - local[0] * sin(a);
    const Extended sign = k < 0 ? -1 : 1;
    const Extended along = sign * (1 / k - bent_r);
    const Extended r = 1 / k - sign * sqrt(local[2] * local[2] + along * along);
    const Extended angle = atan2(sign * local[2], along);
    local = {r * cos(a) - s * sin(a), r * sin(a) + s * cos(a), angle / k};
  }
  const auto& [a1, a2, a3] = primitive.superquadric.semi_axes;
  const Extended p1 = 2 / Extended(primitive.superquadric.exponents[0]);
  const Extended p2 = 2 / Extended(primitive.superquadric.exponents[1]);
  const Extended section = pow(pow(abs(local[0]) / a1, p2) + pow(abs(local[1]) / a2, p2), 1 / p2);
  return pow(pow(section, p1) + pow(abs(local[2]) / a3, p1), 1 / p1);
}

/// Less than 0 inside, by min and max over the tree of set operations.
Extended outside_by(const Model& model, const SetExpression& expression, const std::array<Extended, 3>& point) {
  if (expression.operands.empty()) return gauge(model.primitives[expression.primitive], point) - 1;
  Extended result = outside_by(model, expression.operands.front(), point);
  for (std::size_t i = 1; i < expression.operands.size(); ++i) {
    const Extended other = outside_by(model, expression.operands[i], point);
    if (expression.operation == SetOperation::unite) result = std::min(result, other);
    if (expression.operation == SetOperation::intersect) result = std::max(result, other);
    if (expression.operation == SetOperation::subtract) result = std::max(result, Extended(-other));
  }
  return result;
}

Extended outside_by(const Model& model, const std::array<Extended, 3>& point) {
  if (model.csg) return outside_by(model, *model.csg, point);
  Extended result = gauge(model.primitives.front(), point) - 1;
  for (const Primitive& primitive : model.primitives) result = std::min(result, Extended(gauge(primitive, point) - 1));
  return result;
}

/// Random points of the decided cubes and of their faces. Returns how many cubes were looked at.
std::size_t expect_right_colours(const Model& model, const Grown& grown, std::size_t points) {
  std::vector<OctreeCube> decided;
  std::ranges::copy_if(grown.cubes, std::back_inserter(decided),
                       [](const OctreeCube& cube) { return cube.colour != CubeColour::gray; });
  if (decided.empty()) return 0;
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (std::size_t n = 0; n < points; ++n) {
    const OctreeCube& cube = decided[random() % decided.size()];
    const Point corner = lower_corner(grown.summary.root, cube);
    const double size = edge(grown.summary.root, cube.level);
    std::array<Extended, 3> point;
    for (std::size_t i = 0; i < 3; ++i) {
      const double where = unit(random);
      const double part = where < 0.25 ? 0.0 : where > 0.75 ? 1.0 : unit(random);
      point[i] = Extended(corner[i]) + Extended(size) * part;
    }
    const Extended outside = outside_by(model, point);
    EXPECT_TRUE(cube.colour == CubeColour::black ? outside < 0 : outside > 0) << n << ": " << outside;
  }
  return decided.size();
}

Primitive stem() {
  return {"stem", {{6.0, 9.0, 60.0}, {0.4, 0.9}}, {{1.0, -2.0, 3.0}, {0.9, 0.1, -0.2, 0.3}}, Bend{0.01, 70.0}};
}

/// A bent stem and a bored head, as an implant has them; the bore belongs to two operands.
Model implant() {
  const Primitive head{"head", {{14.0, 14.0, 14.0}, {1.0, 1.0}}, {{5.0, 3.0, 66.0}, {1.0, 0.0, 0.0, 0.0}}};
  const Primitive bore{"bore", {{5.0, 5.0, 9.0}, {0.2, 1.0}}, {{5.0, 3.0, 58.0}, {0.8, 0.3, 0.0, 0.1}}};
  const SetExpression difference{{{{}, SetOperation::unite, 1}, {{}, SetOperation::unite, 2}}, SetOperation::subtract};
  const SetExpression common{{{{}, SetOperation::unite, 0}, {{}, SetOperation::unite, 2}}, SetOperation::subtract};
  return {"mm", {stem(), head, bore}, SetExpression{{common, difference}, SetOperation::unite}};
}

std::vector<std::string> devices() {
  std::vector<std::string> names{"host"};
  for (const DeviceReport& report : test_devices())
    if (report.passed) names.push_back(std::to_string(report.index));
  return names;
}

TEST(OctreeVolume, ContainsTheClosedForm) {
  const std::vector<Model> solids{plain({1.0, 1.0, 1.0}, {1.0, 1.0}),  plain({0.75, 0.75, 1.0}, {1.0, 0.8}),
                                  plain({0.43, 0.6, 1.9}, {1.5, 0.4}), plain({3.4, 4.3, 1.7}, {0.1, 0.1}),
                                  plain({2.0, 3.0, 5.0}, {2.0, 2.0}),  plain({1e-3, 2e-3, 5e-4}, {0.05, 1.9}),
                                  plain({1e150, 2e150, 1e150}, {1, 1})};
  for (const std::string& device : devices()) {
    for (const Model& model : solids) {
      const Superquadric& solid = model.primitives.front().superquadric;
      const Grown grown = grow(model, to_depth(device == "host" ? 3 : 6, device));
      const Extended exact = closed_form(solid);
      SCOPED_TRACE(device + ", e1 " + std::to_string(solid.exponents[0]) + ", e2 " +
                   std::to_string(solid.exponents[1]));
      EXPECT_LE(Extended(grown.summary.volume.lo), exact);
      EXPECT_GE(Extended(grown.summary.volume.hi), exact);
      if (std::isfinite(grown.summary.volume.hi)) expect_consistent(grown);
    }
  }
}

TEST(OctreeVolume, UndecidedPartHalvesWithEachLevel) {
  for (const auto& [axes, exponents] :
       {std::pair(std::array{0.75, 0.75, 1.0}, std::array{1.0, 0.8}), {{0.43, 0.6, 1.9}, {1.5, 0.4}}}) {
    double last = 0.0;
    for (int depth = 4; depth <= 8; ++depth) {
      const double width = grow(plain(axes, exponents), to_depth(depth)).summary.volume.width();
      if (depth > 4) {
        EXPECT_GE(last / width, 1.9) << "level " << depth;
      }
      last = width;
    }
  }
}

TEST(OctreeVolume, OfDisjointDifferenceIsThatOfTheFirst) {
  Model model = plain({1.0, 1.0, 1.0}, {1.0, 1.0});
  model.primitives.push_back({"far", {{0.5, 0.5, 0.5}, {1.0, 1.0}}, {{3.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}});
  model.csg = SetExpression{{{{}, SetOperation::unite, 0}, {{}, SetOperation::unite, 1}}, SetOperation::subtract};
  const Grown difference = grow(model, to_depth(6));
  const Grown alone = grow(plain({1.0, 1.0, 1.0}, {1.0, 1.0}), to_depth(6));
  EXPECT_EQ(difference.summary.volume, alone.summary.volume);
  EXPECT_LE(difference.summary.volume.lo, 4.0 / 3.0 * std::numbers::pi);
  EXPECT_GE(difference.summary.volume.hi, 4.0 / 3.0 * std::numbers::pi);
}

// Boxes across the cut of a bend have no ends along z: 0 times that is 0 for a solid without a taper beside one with.
TEST(OctreeVolume, OfABentSolidBesideATaperedOneIsAsTight) {
  const Primitive tube{"tube", {{0.2, 0.2, 1.0}, {0.5, 1.0}}, {}, Bend{1.0, 0.0}};
  const auto undecided = [&](double taper) {
    const Primitive egg{"egg", {{0.3, 0.3, 0.3}, {1.0, 1.0}, taper}, {{3.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}};
    return grow({"", {tube, egg}}, to_depth(6)).summary.volume.width();
  };
  EXPECT_LE(undecided(1.5), 1.2 * undecided(1.0));
}

// A bend keeps the volume where the solid is symmetric in r: the Jacobian 1 - k r has mean 1.
TEST(OctreeVolume, OfBentSolidContainsTheUnbentOnes) {
  for (const double curvature : {0.012, -0.012, 1e-5, 1e-300}) {
    Primitive primitive = stem();
    primitive.bend = Bend{curvature, 70.0};
    const Model model{"", {primitive}};
    const Grown grown = grow(model, to_depth(7));
    const Extended exact = closed_form(primitive.superquadric);
    EXPECT_LE(Extended(grown.summary.volume.lo), exact) << curvature;
    EXPECT_GE(Extended(grown.summary.volume.hi), exact) << curvature;
    EXPECT_GT(grown.summary.volume.lo, 0.5 * grown.summary.volume.hi) << curvature;
  }
}

TEST(OctreeColours, AreThoseOfRandomPoints) {
  Model turned = plain({0.43, 0.6, 1.9}, {1.5, 0.4});
  turned.primitives.front().pose = {{0.1, -3.0, 0.2}, {0.3, 0.4, -0.5, 0.6}};
  Model moved = plain({3.4, 4.3, 1.7}, {0.1, 0.1});
  moved.primitives.front().pose.translation = {0.1, 1e3, -0.3};
  for (const std::string& device : devices()) {
    for (const Model& model : {plain({0.75, 0.75, 1.0}, {1.0, 0.8}), plain({2.0, 3.0, 5.0}, {2.0, 2.0}),
                               plain({1.0, 2.0, 0.5}, {0.05, 1.3}), moved, turned, Model{"", {stem()}}, implant()}) {
      const Grown grown = grow(model, to_depth(device == "host" ? 3 : 6, device));
      expect_consistent(grown);
      EXPECT_GT(expect_right_colours(model, grown, 2000), 0U);
    }
  }
}

// The gauge over a cube lies between those of the corners nearest to and farthest from the axes: black, white and gray
// are then decided but for rounding.
TEST(OctreeColours, OfUnturnedSolidsAreThoseOfTheirExtremeCorners) {
  std::mt19937_64 random(7);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  for (int solid = 0; solid < 12; ++solid) {
    Model model =
        plain({between(0.2, 3.0), between(0.2, 3.0), between(0.2, 3.0)}, {between(0.05, 2.0), between(0.05, 2.0)});
    Primitive& primitive = model.primitives.front();
    if (solid % 2 == 1) primitive.pose.translation = {between(-9.0, 9.0), between(-9.0, 9.0), between(-9.0, 9.0)};
    const Grown grown = grow(model, to_depth(5));
    for (int n = 0; n < 400; ++n) {
      const OctreeCube& cube = grown.cubes[random() % grown.cubes.size()];
      const Point corner = lower_corner(grown.summary.root, cube);
      const double size = edge(grown.summary.root, cube.level);
      std::array<Extended, 3> nearest;
      std::array<Extended, 3> farthest;
      for (std::size_t i = 0; i < 3; ++i) {
        const Extended centre(primitive.pose.translation[i]);
        const Extended lower(corner[i]);
        const Extended upper = lower + size;
        nearest[i] = std::clamp(centre, lower, upper);
        farthest[i] = centre - lower > upper - centre ? lower : upper;
      }
      const Extended least = gauge(primitive, nearest);
      const Extended largest = gauge(primitive, farthest);
      switch (cube.colour) {
        case CubeColour::black: EXPECT_LT(largest, 1); break;
        case CubeColour::white: EXPECT_GT(least, 1); break;
        case CubeColour::gray:
          EXPECT_LT(least, 1 + 1e-12);
          EXPECT_GT(largest, 1 - 1e-12);
          break;
      }
    }
  }
}

// Both prove what they say: where their trees differ, one has decided what the other leaves open.
TEST(OctreeColours, OfDevicesDoNotContradictTheHost) {
  for (const Model& model : {plain({0.43, 0.6, 1.9}, {1.5, 0.4}), Model{"", {stem()}}, implant()}) {
    const int depth = 3;
    const Grown host = grow(model, to_depth(depth, "host"));
    for (const std::string& device : devices()) {
      const Grown other = grow(model, to_depth(depth, device));
      EXPECT_LE(other.summary.volume.lo, host.summary.volume.hi);
      EXPECT_GE(other.summary.volume.hi, host.summary.volume.lo);
      // The colour of each cube of the finest grid.
      const auto painted = [&](const Grown& grown) {
        std::map<std::array<std::uint32_t, 3>, CubeColour> colours;
        for (const OctreeCube& cube : grown.cubes) {
          const std::uint32_t side = 1U << (depth - cube.level);
          for (std::uint32_t n = 0; n < side * side * side; ++n)
            colours[{cube.position[0] * side + n % side, cube.position[1] * side + n / side % side,
                     cube.position[2] * side + n / side / side}] = cube.colour;
        }
        return colours;
      };
      const auto by_host = painted(host);
      std::size_t differences = 0;
      for (const auto& [position, colour] : painted(other)) {
        const CubeColour expected = by_host.at(position);
        if (colour == expected) continue;
        ++differences;
        EXPECT_TRUE(colour == CubeColour::gray || expected == CubeColour::gray);
      }
      EXPECT_LT(differences, by_host.size() / 10) << device;
    }
  }
}

TEST(OctreeColours, DoNotDependOnTheDevicesOrder) {
  const Grown once = grow(implant(), to_depth(5));
  const Grown again = grow(implant(), to_depth(5));
  ASSERT_EQ(once.cubes.size(), again.cubes.size());
  for (std::size_t n = 0; n < once.cubes.size(); ++n) {
    EXPECT_EQ(once.cubes[n].position, again.cubes[n].position);
    EXPECT_EQ(once.cubes[n].colour, again.cubes[n].colour);
  }
}

/// All cubes by a program of this vector width, with these compiler options.
std::vector<OctreeCube> cubes_by(const device::Device& device, int vector_width, const Model& model,
                                 const std::string& compiler_options, int depth) {
  device::Device narrow = device;
  narrow.vector_width = vector_width;
  const auto front = device::octree_front(narrow, model, verify::octree_root(model), compiler_options);
  std::vector<OctreeCube> cubes;
  const OctreeSink sink = [&](std::span<const OctreeCube> more) {
    cubes.insert(cubes.end(), more.begin(), more.end());
  };
  for (int level = 0; level < depth; ++level) front->split(level, {}, sink);
  front->deliver_undecided(depth, sink);
  std::ranges::sort(cubes, before);
  return cubes;
}

bool same(const OctreeCube& a, const OctreeCube& b) {
  return !before(a, b) && !before(b, a);
}

// Lanes know nothing of each other: processors with short vectors and other devices compute the same.
TEST(OctreeColours, DoNotDependOnTheVectorWidth) {
  const auto selection = device::select_device("auto");
  if (!selection.device) GTEST_SKIP() << selection.notice;
  const auto eight = cubes_by(*selection.device, 8, implant(), "-DNO_SIBLINGS", 5);
  for (const int width : {4, 1})
    EXPECT_TRUE(std::ranges::equal(eight, cubes_by(*selection.device, width, implant(), "-DNO_SIBLINGS", 5), same))
        << width;
}

// Eight siblings share powers where the cubes lie along a primitive's axes: by vectors and number by number the same.
TEST(OctreeColours, OfSiblingsDoNotDependOnTheVectorWidth) {
  const auto selection = device::select_device("auto");
  if (!selection.device) GTEST_SKIP() << selection.notice;
  const auto leaf = [](std::uint32_t n) { return SetExpression{{}, SetOperation::unite, n}; };
  Model model;
  model.primitives = {{"block", {{2.0, 1.5, 1.0}, {0.2, 0.3}}, {{0.1, -0.2, 0.05}, {1.0, 0.0, 0.0, 0.0}}},
                      {"bore", {{0.4, 0.3, 2.0}, {0.6, 1.3}}, {{0.5, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}},
                      {"stud", {{0.3, 0.6, 0.5}, {1.7, 0.9}}, {{-0.6, 0.7, 0.8}, {1.0, 0.1, 0.2, 0.0}}}};
  model.csg = SetExpression{{SetExpression{{leaf(0), leaf(2)}, SetOperation::unite}, leaf(1)}, SetOperation::subtract};
  const auto eight = cubes_by(*selection.device, 8, model, "", 6);
  EXPECT_TRUE(std::ranges::equal(eight, cubes_by(*selection.device, 1, model, "", 6), same));
}

// What the parent knows of a primitive is true of its children: without it there is no more decided.
TEST(OctreeColours, AreAsManyWithoutSimplification) {
  const auto selection = device::select_device("auto");
  if (!selection.device) GTEST_SKIP() << selection.notice;
  const int width = selection.device->vector_width;
  const auto count_gray = [](const std::vector<OctreeCube>& cubes) {
    return std::ranges::count(cubes, CubeColour::gray, &OctreeCube::colour);
  };
  const auto with = count_gray(cubes_by(*selection.device, width, implant(), "", 6));
  const auto without = count_gray(cubes_by(*selection.device, width, implant(), "-DNO_SIMPLIFICATION", 6));
  EXPECT_GT(with, 0);
  EXPECT_LE(with, without);
  EXPECT_GE(with, without - without / 100);
}

// A primitive that no longer matters on one branch of the tree may matter on another.
TEST(OctreeColours, OfSharedPrimitivesAreRight) {
  Model model;
  const std::array<double, 2> ball{1.0, 1.0};
  model.primitives = {{"a", {{1.0, 1.0, 1.0}, ball}, {}},
                      {"b", {{0.6, 0.6, 0.6}, ball}, {{-0.9, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}},
                      {"c", {{0.6, 0.6, 0.6}, ball}, {{0.9, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}}};
  const auto leaf = [](std::uint32_t n) { return SetExpression{{}, SetOperation::unite, n}; };
  const SetExpression left{{leaf(0), leaf(1)}, SetOperation::intersect};
  const SetExpression right{{leaf(0), leaf(2)}, SetOperation::intersect};
  model.csg = SetExpression{{left, right}, SetOperation::unite};
  for (const std::string& device : devices()) {
    const Grown grown = grow(model, to_depth(device == "host" ? 3 : 5, device));
    expect_consistent(grown);
    EXPECT_GT(grown.summary.volume.hi, 0.0);
    expect_right_colours(model, grown, 2000);
  }
}

TEST(OctreeColours, OfMoreThan32PrimitivesAreRight) {
  Model model;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.7 * i - 14.0;
    model.primitives.push_back(
        {std::to_string(i), {{0.5, 0.6, 0.7}, {0.5, 1.2}}, {{x, std::sin(x), 0.0}, {1.0, 0.1 * i, 0.0, 0.2}}});
  }
  const Grown grown = grow(model, to_depth(6));
  expect_consistent(grown);
  EXPECT_GT(expect_right_colours(model, grown, 500), 0U);
}

// Compilers nest some 250 operands; far sooner the host, which simplifies whole trees, is faster.
TEST(OctreeColours, OfModelsThatAreNotCompiledAreTheHosts) {
  constexpr std::uint32_t count = 343;
  Model model{"", grid_of_balls(count, 0.6)};
  const Grown wide = grow(model, to_depth(5));
  EXPECT_EQ(wide.summary.device, "host");
  EXPECT_EQ(wide.summary.notice,
            "the model's tree has 343 leaves, of which the device's kernels take 100: the host does all");
  expect_consistent(wide);
  for (const SetExpression& tree : {deep_tree(count, always_union), balanced_tree(0, count, always_union)}) {
    model.csg = tree;
    EXPECT_EQ(grow(model, to_depth(5)).summary.volume, wide.summary.volume);
  }
  model.csg = balanced_tree(0, count, in_turn);
  const Grown mixed = grow(model, to_depth(5));
  expect_consistent(mixed);
  EXPECT_GT(expect_right_colours(model, mixed, 100), 0U);
}

TEST(Octree, OfLargeModels) {
  const auto volume = [](std::uint32_t count, const SetExpression& tree) {
    return grow({"", grid_of_balls(count, 0.6), tree}, to_depth(4)).summary.volume;
  };
  const Enclosure thousand = volume(1000, wide_tree(1000, SetOperation::unite));
  EXPECT_GT(thousand.hi, 0.0);
  EXPECT_EQ(volume(1000, deep_tree(1000, always_union)), thousand);
  EXPECT_EQ(volume(1000, deep_tree_of_last_operands(1000, always_union)), thousand);
  const Enclosure ten_thousand = volume(10000, wide_tree(10000, SetOperation::unite));
  EXPECT_EQ(volume(10000, balanced_tree(0, 10000, always_union)), ten_thousand);
  const Enclosure less = volume(10000, balanced_tree(0, 10000, in_turn));
  EXPECT_LE(less.hi, ten_thousand.hi);
}

TEST(Octree, OfTouchingRootIsExact) {
  const OctreeSummary summary = grow(plain({1.0, 1.0, 1.0}, {1.0, 1.0}), to_depth(2)).summary;
  EXPECT_EQ(summary.root.half_width, 1.0);
  EXPECT_EQ(summary.root.centre, (Point{0.0, 0.0, 0.0}));
  EXPECT_EQ(summary.levels.size(), 3U);
}

TEST(Octree, DepthZeroIsTheRoot) {
  for (const std::string& device : devices()) {
    const Grown grown = grow(implant(), to_depth(0, device));
    ASSERT_EQ(grown.cubes.size(), 1U);
    EXPECT_EQ(grown.cubes.front().colour, CubeColour::gray);
    EXPECT_EQ(grown.summary.volume.lo, 0.0);
    expect_consistent(grown);
  }
}

TEST(Octree, StopsAtTheTolerance) {
  OctreeOptions options = to_depth(deepest_octree_level);
  options.tolerance = 0.25;
  const Grown grown = grow(plain({1.0, 1.0, 1.0}, {1.0, 1.0}), options);
  EXPECT_LE(grown.summary.volume.width(), 0.25);
  EXPECT_FALSE(grown.summary.budget_hit);
  options.tolerance = 0.0;
  options.depth = static_cast<int>(grown.summary.levels.size()) - 2;
  EXPECT_GT(grow(plain({1.0, 1.0, 1.0}, {1.0, 1.0}), options).summary.volume.width(), 0.25);
}

TEST(Octree, StaysValidWhenTheBudgetIsHit) {
  const Model model = implant();
  for (const std::string& device : devices()) {
    for (const std::size_t budget : {1U, 8U, 100U, 333U}) {
      OctreeOptions options = to_depth(10, device);
      options.budget = budget;
      const Grown grown = grow(model, options);
      EXPECT_TRUE(grown.summary.budget_hit);
      EXPECT_FALSE(grown.summary.interrupted);
      for (const OctreeLevel& level : grown.summary.levels) EXPECT_LE(level.gray, budget);
      expect_consistent(grown);
      expect_right_colours(model, grown, 200);
    }
  }
}

TEST(Octree, StaysValidWhenInterrupted) {
  for (const std::string& device : devices()) {
    OctreeOptions options = to_depth(10, device);
    int polled = 0;
    options.interrupted = [&] { return ++polled > 3; };
    const Grown grown = grow(implant(), options);
    EXPECT_TRUE(grown.summary.interrupted);
    EXPECT_FALSE(grown.summary.budget_hit);
    expect_consistent(grown);
  }
}

TEST(Octree, MayBeGrownAgain) {
  for (const std::string& device : devices()) {
    OctreeBuilder builder(implant(), to_depth(3, device));
    const OctreeSummary first = builder.build();
    EXPECT_EQ(first.volume, builder.build().volume);
    EXPECT_EQ(first.coloured, builder.build().coloured);
  }
}

TEST(Octree, RefusesWhatHasNoExactCubes) {
  Model far = plain({1.0, 1.0, 1.0}, {1.0, 1.0});
  far.primitives.front().pose.translation = {1e12, 0.0, 0.0};
  expect_error([&] { OctreeBuilder(far, to_depth(1)); }, ErrorKind::input, "", unlike_the_origin);
  far.primitives.front().pose.translation = {1e8, 0.1, 0.0};
  expect_consistent(grow(far, to_depth(4)));
  const Model large = plain({1e308, 1e308, 1e308}, {1.0, 1.0});
  expect_error([&] { OctreeBuilder(large, to_depth(1)); }, ErrorKind::input, "",
               "octree: the size of the model overflows");
  expect_consistent(grow(plain({1e-90, 1e-90, 1e-90}, {1.0, 1.0}), to_depth(3)));
}

TEST(Octree, RefusesOptionsOutOfRange) {
  const Model model = plain({1.0, 1.0, 1.0}, {1.0, 1.0});
  OctreeOptions options;
  options.depth = 21;
  expect_error([&] { OctreeBuilder(model, options); }, ErrorKind::input, "", "octree: depth 21 is not in 0 to 20");
  options.depth = 3;
  options.tolerance = -1.0;
  expect_error([&] { OctreeBuilder(model, options); }, ErrorKind::input, "",
               "octree: tolerance -1 is not a number of at least 0");
  options.tolerance = 0.0;
  options.budget = 0;
  expect_error([&] { OctreeBuilder(model, options); }, ErrorKind::input, "",
               "octree: a budget of 0 cubes has no room for the root");
}

/// The arrays of the appended part, by name.
std::map<std::string, std::string> arrays_of(const std::string& file, pugi::xml_document& xml) {
  const std::size_t underscore = file.find('_', file.find("<AppendedData"));
  const std::string closed = file.substr(0, underscore) + "</AppendedData></VTKFile>";
  if (!xml.load_string(closed.c_str())) throw std::runtime_error("not XML");
  std::map<std::string, std::string> arrays;
  for (const auto& found : xml.select_nodes("//DataArray")) {
    const std::size_t begin = underscore + 1 + found.node().attribute("offset").as_ullong();
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, file.data() + begin, sizeof bytes);
    arrays[found.node().attribute("Name").value()] = file.substr(begin + sizeof bytes, bytes);
  }
  return arrays;
}

template <class Number>
std::vector<Number> numbers_of(const std::string& bytes) {
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

/// A file of hexahedra as its readers see it.
struct Hexahedra {
  std::vector<Point> points;
  std::vector<std::array<std::int32_t, 8>> cells;
  std::vector<std::uint8_t> colours;
  std::vector<std::uint8_t> levels;
};

Hexahedra read_hexahedra(const std::string& file) {
  pugi::xml_document xml;
  const auto arrays = arrays_of(file, xml);
  Hexahedra result;
  const auto coordinates = numbers_of<double>(arrays.at("Points"));
  for (std::size_t n = 0; n + 2 < coordinates.size(); n += 3)
    result.points.push_back({coordinates[n], coordinates[n + 1], coordinates[n + 2]});
  const auto connectivity = numbers_of<std::int32_t>(arrays.at("connectivity"));
  const auto offsets = numbers_of<std::int32_t>(arrays.at("offsets"));
  for (std::size_t n = 0; n < offsets.size(); ++n) {
    EXPECT_EQ(offsets[n], static_cast<std::int32_t>(8 * (n + 1)));
    auto& cell = result.cells.emplace_back();
    std::copy_n(connectivity.begin() + static_cast<std::ptrdiff_t>(8 * n), 8, cell.begin());
  }
  result.colours = numbers_of<std::uint8_t>(arrays.at("colour"));
  result.levels = numbers_of<std::uint8_t>(arrays.at("level"));
  EXPECT_EQ(arrays.at("types"), std::string(result.cells.size(), '\x0c')) << "VTK_HEXAHEDRON";
  EXPECT_EQ(connectivity.size(), 8 * result.cells.size());
  const pugi::xml_node piece = xml.child("VTKFile").child("UnstructuredGrid").child("Piece");
  EXPECT_EQ(piece.attribute("NumberOfCells").as_ullong(), result.cells.size());
  EXPECT_EQ(piece.attribute("NumberOfPoints").as_ullong(), result.points.size());
  EXPECT_EQ(xml.select_node("//DataArray[@Name='connectivity']").node().attribute("type").value(),
            std::string("Int32"));
  return result;
}

/// By the triple product of the edges from corner 0 to 1, 3 and 4: positive where the corners are in the order of a
/// hexahedron. The other corners are checked to be those of a cube.
double volume_of(const Hexahedra& file, std::size_t n) {
  const auto corner = [&](std::size_t i) { return file.points.at(static_cast<std::size_t>(file.cells[n][i])); };
  const auto from_first = [&](std::size_t i) {
    return Point{corner(i)[0] - corner(0)[0], corner(i)[1] - corner(0)[1], corner(i)[2] - corner(0)[2]};
  };
  const Point a = from_first(1);
  const Point b = from_first(3);
  const Point c = from_first(4);
  const auto sum = [](const Point& p, const Point& q) { return Point{p[0] + q[0], p[1] + q[1], p[2] + q[2]}; };
  EXPECT_EQ(from_first(2), sum(a, b));
  EXPECT_EQ(from_first(5), sum(a, c));
  EXPECT_EQ(from_first(6), sum(sum(a, b), c));
  EXPECT_EQ(from_first(7), sum(b, c));
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

TEST(OctreeFile, ReadsBackAsHexahedra) {
  const TemporaryFolder folder;
  const Grown grown = grow(implant(), to_depth(5));
  std::array<double, 3> volumes{};
  for (const OctreeCube& cube : grown.cubes)
    volumes[static_cast<std::size_t>(cube.colour)] += std::pow(edge(grown.summary.root, cube.level), 3);
  for (const WhiteCubes white : {WhiteCubes::left_out, WhiteCubes::written}) {
    OctreeWriter writer(folder / "cubes.vtu", white);
    writer.append(grown.cubes);
    const std::uint64_t bytes = writer.bytes();
    writer.finish(grown.summary.root);
    EXPECT_EQ(std::filesystem::file_size(folder / "cubes.vtu"), bytes);
    const Hexahedra file = read_hexahedra(folder.contents("cubes.vtu"));
    EXPECT_LT(file.points.size(), 3 * file.cells.size()) << "corners are shared";
    EXPECT_EQ(std::set(file.points.begin(), file.points.end()).size(), file.points.size());
    std::array<double, 3> found{};
    for (std::size_t n = 0; n < file.cells.size(); ++n) {
      const double volume = volume_of(file, n);
      EXPECT_EQ(volume, std::pow(edge(grown.summary.root, file.levels[n]), 3));
      found.at(file.colours[n]) += volume;
    }
    EXPECT_EQ(found[2], volumes[2]);
    EXPECT_EQ(found[2], grown.summary.volume.lo);
    EXPECT_EQ(found[1], volumes[1]);
    EXPECT_EQ(found[0], white == WhiteCubes::written ? volumes[0] : 0.0);
  }
}

/// Equal siblings become their parent, as often as there are some; others stay.
TEST(OctreeFile, MergesEqualSiblings) {
  const TemporaryFolder folder;
  std::vector<OctreeCube> cubes;
  // Level 2 under one corner of the root black, under the opposite one black but for a gray cube.
  for (std::uint32_t n = 0; n < 8; ++n) {
    const std::array<std::uint32_t, 3> at{n & 1U, n >> 1U & 1U, n >> 2U};
    cubes.push_back({at, 2, CubeColour::black});
    cubes.push_back({{2 + at[0], 2 + at[1], 2 + at[2]}, 2, n == 3 ? CubeColour::gray : CubeColour::black});
    if (n != 0 && n != 7) cubes.push_back({at, 1, CubeColour::black});
  }
  const OctreeRoot root{{0.0, 0.0, 0.0}, 1.0};
  const auto cells = [&] {
    OctreeWriter writer(folder / "cubes.vtu", WhiteCubes::left_out);
    writer.append(cubes);
    writer.finish(root);
    return read_hexahedra(folder.contents("cubes.vtu"));
  };
  const Hexahedra mixed = cells();
  EXPECT_EQ(mixed.cells.size(), 15U) << "7 of level 1, 8 of level 2";
  EXPECT_EQ(std::ranges::count(mixed.levels, 1), 7);
  for (OctreeCube& cube : cubes) cube.colour = CubeColour::black;
  const Hexahedra all = cells();
  ASSERT_EQ(all.cells.size(), 1U) << "twice";
  EXPECT_EQ(all.levels.front(), 0);
  EXPECT_EQ(all.points.size(), 8U);
  EXPECT_EQ(volume_of(all, 0), 8.0);
}

TEST(OctreeFile, TakesAThirdOfSeparateVoxels) {
  const TemporaryFolder folder;
  const Grown grown = grow(implant(), to_depth(7));
  OctreeWriter writer(folder / "cubes.vtu", WhiteCubes::left_out);
  writer.append(grown.cubes);
  const auto cells =
      std::ranges::count_if(grown.cubes, [](const OctreeCube& cube) { return cube.colour != CubeColour::white; });
  // Eight corners of 24 bytes, eight indices and an offset of eight, type, colour and level.
  EXPECT_LT(3 * writer.bytes(), 267 * static_cast<std::uint64_t>(cells));
}

TEST(OctreeFile, AppearsOnlyWhenComplete) {
  const TemporaryFolder folder;
  {
    OctreeWriter writer(folder / "cubes.vtu", WhiteCubes::left_out);
    writer.append(std::array{OctreeCube{{0, 0, 0}, 0, CubeColour::gray}});
    EXPECT_FALSE(std::filesystem::exists(folder / "cubes.vtu"));
  }
  EXPECT_TRUE(folder.names().empty());
  expect_input_error([&] { OctreeWriter(folder / "cubes.vtp", WhiteCubes::left_out); }, folder / "cubes.vtp",
                     ": octrees are written as .vtu");
}

}  // namespace
}  // namespace verisq::testing
