/// Sums over the legs, in binary64.
#include "host/command_line/path_extent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/command_line/pose_option.hpp"

namespace verisq::command_line {

double length_of(std::span<const Pose> path) {
  double length = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Point& from = path[k - 1].translation;
    const Point& to = path[k].translation;
    length += std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  }
  return length;
}

double degrees_of(std::span<const Pose> path) {
  double degrees = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const auto& p = path[k - 1].quaternion;
    const auto& q = path[k].quaternion;
    const double product = std::abs(p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]);
    const double lengths = std::hypot(std::hypot(p[0], p[1]), std::hypot(p[2], p[3])) *
                           std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    degrees += 2.0 * std::acos(std::clamp(product / lengths, 0.0, 1.0)) * 180.0 / std::numbers::pi;
  }
  return degrees;
}

std::string path_in_words(std::span<const Pose> path, std::string_view way, std::string_view of_what,
                          std::string_view units) {
  const std::string begins = fmt::format("the {} begins at", way);
  std::string text = fmt::format("{:<21}{}: translation, quaternion\n", begins, option_text(path.front()));
  text += fmt::format("  and ends at        {}\n", option_text(path.back()));
  text += fmt::format("  poses              {}, and all between them\n", path.size());
  text += fmt::format("  length             {:.4g}{}, of {} origin\n", length_of(path), units, of_what);
  return text + fmt::format("  turning            {:.4g} degrees in all\n", degrees_of(path));
}

}  // namespace verisq::command_line
