/// Implants and their ways in, straight, turning and none.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>
#include <verisq/insertion.hpp>
#include <verisq/model.hpp>

namespace verisq::oracle {

inline const Model shaft{
    "mm", {{"shaft", {{1.0, 1.4, 6.0}, {0.7, 0.9}}, {{0.0, 0.0, -3.0}, {1.0, 0.1, 0.0, 0.0}}}}, {}};

/// Of two solids that overlap, and one of them tapered.
inline const Model shaft_with_neck{
    "mm",
    {shaft.primitives.front(), {"neck", {{0.8, 0.8, 3.0}, {0.4, 1.0}, 1.5}, {{1.0, 0.5, 3.0}, {0.9, 0.3, -0.2, 0.1}}}},
    {}};

struct WayScene {
  const char* name;
  Model implant;
  std::vector<Pose> path;
};

[[nodiscard]] inline std::vector<Pose> turning_path() {
  std::vector<Pose> path;
  for (std::size_t k = 0; k <= 12; ++k) {
    const double s = static_cast<double>(k) / 12.0;
    path.push_back({{6.0 * (1.0 - s), 2.0 * std::sin(2.0 * s), 9.0 * (1.0 - s)},
                    {1.0, 0.3 * (1.0 - s), -0.2 * s * s, 0.4 - 0.4 * s}});
  }
  return path;
}

[[nodiscard]] inline std::vector<WayScene> way_scenes() {
  const Pose turned{{0.5, -0.3, 0.2}, {0.8, 0.1, -0.3, 0.2}};
  return {{"straight", shaft_with_neck, straight_path({}, {0.2, 0.1, -1.0}, 20.0, 1)},
          {"straight, of one solid", shaft, straight_path(turned, {0.0, 0.0, -1.0}, 12.0, 1)},
          {"turning", shaft_with_neck, turning_path()},
          {"at rest", shaft_with_neck, {turned}}};
}

}  // namespace verisq::oracle
