/// The choice of models and poses.
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/mutation/pair_judge.hpp"
#include "tests/oracle/random_pairs.hpp"

namespace verisq::mutation {
namespace {

using oracle::PosedSolid;
using oracle::RandomCases;

using Quaternion = std::array<double, 4>;

/// Random superquadrics in the families of tests/oracle/random_pairs.hpp, the largest semi-axis in [1, 2). B's pose is
/// split: what its model has, a rotation and a translation, the query undoes.
PairScene random_pair(std::uint64_t seed) {
  RandomCases random(seed);
  std::array<Superquadric, 2> solids{random.solid().superquadric, random.solid().superquadric};
  for (Superquadric& solid : solids) {
    const int exponent = std::ilogb(std::ranges::max(solid.semi_axes));
    for (double& axis : solid.semi_axes) axis = std::ldexp(axis, -exponent);
  }
  PairScene scene{"random pair " + std::to_string(seed), {}, {}, {}};
  const oracle::RandomPair first = oracle::random_pair(random, solids[0], solids[1]);
  scene.a.primitives = {first.a};
  scene.b.primitives = {{"b", solids[1], {{0.3, -0.5, 0.7}, {0.5, -0.1, 0.2, 0.9}}}};
  const double reach = 4.0;
  for (int i = 0; i < 40; ++i) {
    Pose pose{first.a.pose.translation, {}};
    const Point away = random.direction();
    const double distance = reach * random.uniform(0.0, 1.0);
    for (std::size_t k = 0; k < 3; ++k) pose.translation[k] += distance * away[k];
    for (double& component : pose.quaternion) component = random.uniform(-1.0, 1.0);
    scene.poses.push_back(pose);
  }
  return scene;
}

Point turned(const Quaternion& quaternion, const Point& x) {
  return oracle::rounded(PosedSolid({}, {{}, quaternion}).from_own_frame(oracle::widened(x)));
}

/// Where x of B's own frame is in that of the model.
Point in_model(const Primitive& primitive, const Point& x) {
  return oracle::rounded(PosedSolid(primitive.superquadric, primitive.pose).from_own_frame(oracle::widened(x)));
}

/// The pose that turns model B by `rotation` and brings `foot` of B's own frame to `target`.
Pose bringing(const Primitive& b, const Point& foot, const Point& target, const Quaternion& rotation) {
  const Point at = turned(rotation, in_model(b, foot));
  return {{target[0] - at[0], target[1] - at[1], target[2] - at[2]}, rotation};
}

/// Two solids with tips on their first axes, tip against tip: the point of B nearest to A is as far from its centre as
/// any, and the line of the centres the common normal. `gaps` are between the tips.
PairScene tip_to_tip(std::string name, const Superquadric& a, const Superquadric& b, const Quaternion& of_b,
                     const std::vector<double>& gaps) {
  PairScene scene{std::move(name), {"", {{"a", a, {}}}}, {"", {{"b", b, {{}, of_b}}}}, {}};
  const Primitive& solid_a = scene.a.primitives[0];
  const Primitive& solid_b = scene.b.primitives[0];
  // B's own axes along A's but for the sign of the first two.
  for (const double gap : gaps) {
    const Point target = in_model(solid_a, {a.semi_axes[0] + gap, 0.0, 0.0});
    const Quaternion& q = solid_a.pose.quaternion;
    const auto& [w, x, y, z] = of_b;
    const Quaternion back{w, -x, -y, -z};
    const Quaternion rotation{q[0] * back[0] - q[1] * back[1] - q[2] * back[2] - q[3] * back[3],
                              q[0] * back[1] + q[1] * back[0] + q[2] * back[3] - q[3] * back[2],
                              q[0] * back[2] - q[1] * back[3] + q[2] * back[0] + q[3] * back[1],
                              q[0] * back[3] + q[1] * back[2] - q[2] * back[1] + q[3] * back[0]};
    scene.poses.push_back(bringing(solid_b, {-b.semi_axes[0], 0.0, 0.0}, target, rotation));
  }
  return scene;
}

std::vector<double> gaps(std::uint64_t seed, double least, double greatest, std::size_t count) {
  RandomCases random(seed);
  std::vector<double> all(count);
  for (double& gap : all) gap = random.log_uniform(least, greatest);
  return all;
}

constexpr Quaternion tilted{0.4, -0.7, 0.2, 0.5};
constexpr Superquadric ball{{1.0, 1.0, 1.0}, {1.0, 1.0}};
constexpr Superquadric small_ball{{0.25, 0.25, 0.25}, {1.0, 1.0}};
constexpr Superquadric long_needle{{1.5, 1e-4, 1e-4}, {1.0, 1.0}};
constexpr Superquadric egg{{1.2, 1.0, 0.9}, {0.8, 1.1}};

/// B's model far from its origin, or A: the terms of the centre's error differ in size.
PairScene off_centre(bool far_b) {
  PairScene scene =
      tip_to_tip(far_b ? "B far from its model's origin" : "A far from the origin", ball, small_ball, tilted, {});
  RandomCases random(9);
  Primitive& a = scene.a.primitives[0];
  Primitive& b = scene.b.primitives[0];
  (far_b ? b : a).pose.translation = {30.0, -20.0, 10.0};
  for (int i = 0; i < 80; ++i) {
    const Point away = random.direction();
    const double reach = 1.25 + random.log_uniform(1e-6, 1.0);
    Point target = a.pose.translation;
    for (std::size_t k = 0; k < 3; ++k) target[k] += reach * away[k];
    Quaternion rotation;
    for (double& component : rotation) component = random.uniform(-1.0, 1.0);
    scene.poses.push_back(bringing(b, {}, target, rotation));
  }
  return scene;
}

/// A ball and a needle against a ball and a needle, whose tips are `apart` and a bit nearer to each other than the
/// balls, by `more`: as far as their bounding spheres. An error in the spheres' bound passes over the nearest pair.
/// `beside` is between balls and needles, hence the needles' distance from the models' origins: theirs is the larger
/// error.
PairScene spheres_touched(double apart, double beside, double more, double length, int poses) {
  const Superquadric needle{{length, 1e-4, 1e-4}, {1.0, 1.0}};
  RandomCases random(4);
  const auto placed = [](const Superquadric& s, const Point& at) {
    return Primitive{"", s, {at, {1.0, 0.0, 0.0, 0.0}}};
  };
  PairScene scene{"tips " + std::to_string(apart) + " apart", {}, {}, {}};
  scene.a.primitives = {placed(small_ball, {-(apart + 0.5 + more), 0.0, 0.0}),
                        placed(needle, {-(apart + 0.25 + length), beside, 0.0})};
  scene.b.primitives = {placed(small_ball, {}), placed(needle, {length - 0.25, beside, 0.0})};
  for (int i = 0; i < poses; ++i) {
    const Pose pose{{apart * random.uniform(0.0, 0.1), 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
    for (int copy = 0; copy < 4; ++copy) scene.poses.push_back(pose);  // lanes that are passed over together
  }
  return scene;
}

/// B of three solids: any of the first two may be the nearest, the last is passed over.
PairScene three_solids() {
  RandomCases random(8);
  PairScene scene{"three solids", {"", {{"a", egg, {}}}}, {}, {}};
  scene.b.primitives = {
      {"one", egg, {}}, {"other", egg, {{3.0, 0.0, 0.0}, tilted}}, {"far", small_ball, {{0.0, 20.0, 0.0}, tilted}}};
  for (int i = 0; i < 40; ++i) {
    const Point away = random.direction();
    Pose pose{{3.0 * away[0], 3.0 * away[1], 3.0 * away[2]}, {}};
    for (double& component : pose.quaternion) component = random.uniform(-1.0, 1.0);
    scene.poses.push_back(pose);
  }
  return scene;
}

/// There the centres decide, and the solids hardly matter.
PairScene far_apart() {
  RandomCases random(7);
  PairScene scene{"far apart",
                  {"", {{"a", egg, {{0.5, -1.0, 2.0}, {1.0, 2.0, 3.0, 4.0}}}}},
                  {"", {{"b", egg, {{0.7, 0.4, -0.6}, tilted}}}},
                  {}};
  for (int i = 0; i < 200; ++i) {
    const double distance = random.log_uniform(10.0, 1e4);
    const Point away = random.direction();
    Pose pose{{distance * away[0], distance * away[1], distance * away[2]}, {}};
    for (double& component : pose.quaternion) component = random.uniform(-1.0, 1.0);
    scene.poses.push_back(pose);
  }
  return scene;
}

/// Where products overflow, or the coordinates themselves.
PairScene beyond_the_range() {
  PairScene scene = far_apart();
  scene.name = "beyond the range of binary64";
  scene.poses.clear();
  for (const double x : {1e150, 1e200, 1e300, 1.7e308}) {
    scene.poses.push_back({{x, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
    scene.poses.push_back({{x, -x, 0.5 * x}, {1.0, 2.0, 0.0, 3.0}});
  }
  return scene;
}

}  // namespace

std::vector<PairScene> pair_scenes() {
  std::vector<PairScene> all;
  for (std::uint64_t seed = 0; seed < 8; ++seed) all.push_back(random_pair(seed));
  all.push_back(tip_to_tip("a needle's tip", small_ball, long_needle, tilted, gaps(1, 1e-6, 1e-1, 80)));
  all.push_back(tip_to_tip("balls", ball, ball, tilted, gaps(2, 1e-9, 1e-3, 200)));
  all.push_back(tip_to_tip("eggs", egg, egg, tilted, gaps(3, 1e-9, 1e-3, 200)));
  all.push_back(off_centre(false));
  all.push_back(off_centre(true));
  all.push_back(spheres_touched(1e4, 8.0, 1e-5, 1.5, 60));
  all.push_back(spheres_touched(3.0, 100.0, 3e-4, 1.5, 60));
  for (int k = 0; k < 64; ++k) all.push_back(spheres_touched(0.01 + k * 0x1p-20, 8.0, 5e-8, 1.25 + k * 0x1p-8, 2));
  all.push_back(three_solids());
  all.push_back(far_apart());
  all.push_back(beyond_the_range());
  return all;
}

}  // namespace verisq::mutation
