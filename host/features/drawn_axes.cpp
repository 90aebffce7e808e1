/// Cylinders between landmarks, drawn longer at both ends so that they stick out of the bone.
#include "host/features/drawn_axes.hpp"

#include <Eigen/Geometry>
#include <array>

#include "host/mesh/eigen_points.hpp"

namespace verisq::features {
namespace {

using Eigen::Vector3d;

constexpr double rod_radius = 1.0;  // mm

struct Line {
  const char* name;
  std::optional<Point> FemurLandmarks::*from;
  std::optional<Point> FemurLandmarks::*to;
  double beyond;  // mm at both ends
};

constexpr std::array lines{
    Line{"neck axis", &FemurLandmarks::neck_centre, &FemurLandmarks::head_centre, 45.0},
    Line{"shaft axis", &FemurLandmarks::shaft_distal, &FemurLandmarks::shaft_proximal, 60.0},
    Line{"posterior condylar line", &FemurLandmarks::lateral_posterior_condyle,
         &FemurLandmarks::medial_posterior_condyle, 25.0},
    Line{"transepicondylar line", &FemurLandmarks::lateral_epicondyle, &FemurLandmarks::medial_epicondyle, 15.0},
};

Primitive rod(const char* name, const Vector3d& from, const Vector3d& to, double beyond) {
  const Vector3d middle = 0.5 * (from + to);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to - from);
  return {name,
          {{rod_radius, rod_radius, 0.5 * (to - from).norm() + beyond}, {0.1, 1.0}},
          {point_of(middle), {turn.w(), turn.x(), turn.y(), turn.z()}}};
}

}  // namespace

Model drawn_axes(const FemurLandmarks& landmarks) {
  Model model{"mm", {}, {}};
  if (landmarks.head_centre && landmarks.head_radius) {
    const double r = *landmarks.head_radius;
    model.primitives.push_back({drawn_head, {{r, r, r}, {1.0, 1.0}}, {*landmarks.head_centre}});
  }
  for (const auto& [name, from, to, beyond] : lines) {
    const std::optional<Point>& start = landmarks.*from;
    const std::optional<Point>& end = landmarks.*to;
    if (start && end && *start != *end)
      model.primitives.push_back(rod(name, vector_of(*start), vector_of(*end), beyond));
  }
  return model;
}

}  // namespace verisq::features
