/// Ways in as paths of poses.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <verisq/insertion.hpp>

#include "host/errors/refusal.hpp"
#include "host/mesh/eigen_points.hpp"
#include "verify/sets/bounding_box.hpp"

namespace verisq {
namespace {

constexpr double degree_of_turn = std::numbers::pi / 180.0;
/// Between two poses translations are linear: a point off the axis by r then leaves its circle by r a²/8, at most
/// 4e-5 r for turns a of so many degrees.
constexpr double degrees_of_a_step = 1.0;
constexpr double most_degrees = 360.0;

void check_way(const WayIn& way, const Point& centre) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(way.direction, finite) || way.direction == Point{})
    refuse("way in: its direction is not finite, or zero");
  if (!(std::isfinite(way.length) && way.length > 0.0))
    refuse(fmt::format("way in: length {} is not a number above 0", way.length));
  if (!(std::abs(way.turn_degrees) <= most_degrees))
    refuse(fmt::format("way in: a turn by {} degrees is beyond {}", way.turn_degrees, most_degrees));
  if (!std::ranges::all_of(centre, finite)) refuse("way in: the centre of its turn is not finite");
}

}  // namespace

Point turning_centre(const Model& implant) {
  const verify::Box box = verify::bounding_box(implant);
  return point_of((vector_of(box.lower) + vector_of(box.upper)) / 2.0);
}

std::vector<Pose> path_of(const WayIn& way, const Point& centre) {
  check_way(way, centre);
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(std::abs(way.turn_degrees) / degrees_of_a_step)));
  std::vector<Pose> path = straight_path({}, way.direction, way.length, steps);
  if (way.turn_degrees == 0.0) return path;
  const Eigen::Vector3d axis = vector_of(way.direction).stableNormalized();
  for (std::size_t k = 0; k < steps; ++k) {  // the last one is as the implant's file has it
    const double left = static_cast<double>(steps - k) / static_cast<double>(steps);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(-left * way.turn_degrees * degree_of_turn, axis));
    const Eigen::Vector3d moved = vector_of(path[k].translation) + vector_of(centre) - turn * vector_of(centre);
    path[k] = {point_of(moved), {turn.w(), turn.x(), turn.y(), turn.z()}};
  }
  return path;
}

}  // namespace verisq
