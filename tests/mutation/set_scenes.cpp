/// The choice of models with set operations.
#include <string>
#include <utility>

#include "tests/mutation/set_judge.hpp"

namespace verisq::mutation {
namespace {

using Solids = std::array<Superquadric, set_primitives>;
using Quaternion = std::array<double, 4>;

SetExpression node(SetOperation operation, std::uint32_t first, std::uint32_t second) {
  SetExpression made{{}, operation, 0};
  for (const std::uint32_t i : {first, second}) made.operands.push_back({{}, SetOperation::unite, i});
  return made;
}

// All overlap near `centre`.
SetScene scene(std::string name, const Solids& solids, const Point& centre,
               const std::array<Quaternion, set_primitives>& turns) {
  constexpr std::array<Point, set_primitives> places{
      {{-0.25, 0.125, 0.0}, {0.375, -0.25, 0.25}, {0.125, 0.625, -0.25}, {0.5, 0.75, 0.5}}};
  SetScene made{std::move(name), {"", {}, {}}};
  for (std::size_t i = 0; i < set_primitives; ++i) {
    Pose pose{{}, turns[i]};
    for (std::size_t k = 0; k < 3; ++k) pose.translation[k] = centre[k] + places[i][k];
    made.model.primitives.push_back({std::string(1, static_cast<char>('a' + i)), solids[i], pose, {}});
  }
  SetExpression tree{{}, SetOperation::unite, 0};
  tree.operands = {node(SetOperation::intersect, 0, 1), node(SetOperation::subtract, 2, 3)};
  made.model.csg = tree;
  return made;
}

}  // namespace

std::vector<SetScene> set_scenes() {
  const Quaternion unturned{1.0, 0.0, 0.0, 0.0};
  const std::array turned{Quaternion{1.0, 2.0, -0.5, 0.3}, Quaternion{0.4, -0.3, 1.0, 0.2},
                          Quaternion{1.0, 0.1, 0.2, -0.3}, Quaternion{0.2, 0.9, -0.1, 0.4}};
  const std::array still{unturned, unturned, unturned, unturned};
  const Superquadric flat{{1.0, 0.75, 0.875}, {0.05, 0.05}};
  const Superquadric flat_too{{0.75, 0.875, 1.125}, {0.05, 0.05}};
  return {
      scene("round",
            {{{{1.1, 0.8, 0.9}, {1.0, 0.6}},
              {{0.9, 1.2, 0.7}, {0.7, 1.0}},
              {{0.8, 1.0, 1.3}, {1.2, 0.9}},
              {{0.7, 0.9, 0.8}, {1.0, 1.0}}}},
            {0.0, 0.0, 0.0}, turned),
      scene("boxes", {{flat, flat_too, flat, flat_too}}, {0.5, -1.0, 0.25}, turned),
      scene("boxes that are not turned", {{flat_too, flat, flat_too, flat}}, {0.0, 0.0, 0.0}, still),
      scene("far from the origin", {{flat, {{0.9, 1.2, 0.7}, {0.7, 1.0}}, {{0.8, 1.0, 1.3}, {0.1, 0.9}}, flat_too}},
            {300.0, 500.0, -400.0}, turned),
      scene("spheres and pointed ones",
            {{{{1.0, 1.0, 1.0}, {1.0, 1.0}},
              {{1.2, 1.1, 0.9}, {2.0, 2.0}},
              {{1.3, 1.3, 1.3}, {1.0, 1.0}},
              {{0.9, 0.9, 0.9}, {1.0, 1.0}}}},
            {1.0, 2.0, 3.0}, turned),
  };
}

}  // namespace verisq::mutation
