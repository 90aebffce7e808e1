/// The choice of solids and queries.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "tests/mutation/solid_judge.hpp"
#include "tests/oracle/random_solids.hpp"

namespace verisq::mutation {
namespace {

std::vector<Point> queries(const Model& model, std::uint64_t seed) {
  oracle::RandomSolids solids(seed);
  const oracle::PlacedModel placed(model);
  std::vector<Point> points;
  for (int i = 0; i < 3; ++i)
    for (const oracle::SolidPointFamily family : oracle::solid_point_families)
      points.push_back(solids.point(placed, family));
  return points;
}

SolidScene scene(std::string name, const Superquadric& solid, const Pose& pose, const Bend& bend,
                 const Superquadric& hole, const Pose& hole_pose, std::uint64_t seed) {
  SetExpression difference{{}, SetOperation::subtract, 0};
  for (const std::uint32_t i : {0U, 1U}) difference.operands.push_back({{}, SetOperation::unite, i});
  SolidScene made{std::move(name), {"", {{"solid", solid, pose, bend}, {"hole", hole, hole_pose, {}}}, difference}, {}};
  made.points = queries(made.model, seed);
  return made;
}

SolidScene tapered(SolidScene made, double solid, double hole, bool loose, std::uint64_t seed) {
  made.name = fmt::format("tapered{}, {}", loose ? " off" : "", made.name);
  made.model.primitives[0].superquadric.taper = solid;
  made.model.primitives[1].superquadric.taper = hole;
  made.points = queries(made.model, seed);
  made.loose_constants = loose;
  return made;
}

}  // namespace

std::vector<SolidScene> solid_scenes() {
  const Pose turned{{1.0, -2.0, 0.5}, {1.0, 2.0, -0.5, 0.3}};
  const Pose nearby{{1.3, -1.6, 0.9}, {0.4, -0.3, 1.0, 0.2}};
  const Pose far{{300.0, 500.0, -400.0}, {1.0, 2.0, -0.5, 0.3}};
  const Pose far_nearby{{300.3, 500.4, -399.6}, {0.4, -0.3, 1.0, 0.2}};
  const Pose quarter{{0.0, 0.0, 0.0}, {1.0, 1.0, 0.0, 0.0}};
  return {
      scene("gently bent", {{0.5, 0.4, 1.6}, {0.2, 0.3}}, turned, {0.15, 30.0}, {{0.5, 0.6, 0.5}, {1.0, 1.0}}, nearby,
            1),
      scene("half a circle", {{0.3, 0.25, 1.9}, {0.3, 1.0}}, {}, {1.63, 0.0}, {{0.4, 0.5, 0.6}, {0.5, 1.5}}, quarter,
            2),
      scene("bent the other way", {{0.6, 0.7, 1.2}, {1.0, 0.4}}, nearby, {-0.9, 75.0}, {{0.7, 0.3, 0.5}, {1.6, 0.7}},
            turned, 3),
      scene("hardly bent", {{1.5, 1.0, 0.8}, {0.7, 1.8}}, turned, {1e-300, 110.0}, {{0.4, 0.6, 0.9}, {0.1, 0.3}},
            nearby, 4),
      scene("far from the origin", {{0.5, 0.6, 1.7}, {1.0, 1.0}}, far, {0.5, -20.0}, {{0.5, 0.4, 0.7}, {0.9, 1.1}},
            far_nearby, 5),
      scene("to the centre of its bend", {{0.9, 0.8, 1.5}, {0.1, 0.1}}, turned, {1.0, 0.0},
            {{0.8, 0.4, 0.3}, {1.2, 0.2}}, nearby, 6),
      scene("plane faces", {{0.7, 0.9, 1.1}, {0.05, 0.05}}, nearby, {1e-200, 45.0}, {{0.7, 0.9, 0.8}, {2.0, 2.0}},
            turned, 7),
      scene("wide and short", {{1.0, 0.05, 0.3}, {0.3, 0.3}}, turned, {0.85, 0.0}, {{0.5, 0.5, 0.5}, {1.0, 1.0}},
            nearby, 8),
  };
}

// As strong as the curvature allows: sections are wider by 1 + |k|, and keep off the centre of the bend.
std::vector<SolidScene> tapered_solid_scenes() {
  const double solids[] = {19.0, 9.0, 1.0 / 3.0, 0.06, 4.0, 1.2, 1.0 / 17.0, 1.3};
  const double holes[] = {2.0, 0.5, 1.01, 15.0, 0.2, 0.1, 3.0, 0.9};
  std::vector<SolidScene> scenes;
  for (const SolidScene& untapered : solid_scenes()) {
    const std::size_t i = scenes.size();
    scenes.push_back(tapered(untapered, solids[i], holes[i], i % 2 == 1, 10 + i));
  }
  return scenes;
}

}  // namespace verisq::mutation
