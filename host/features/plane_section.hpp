/// Plane sections of a mesh: the closed curves in which a plane cuts it, their perimeter, area and centroid.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::features {

/// Points x with normal.x = offset; the normal has length 1.
struct Plane {
  Eigen::Vector3d normal;
  double offset;
};

/// A closed curve in a plane. About solid parts the area is positive, about holes negative.
struct SectionCurve {
  double perimeter;
  double area;
  Eigen::Vector3d centroid;  ///< of the area
  std::vector<Eigen::Vector3d> points;
};

/// Of a closed, oriented mesh whose normals point outward; curves that do not close are left out.
[[nodiscard]] std::vector<SectionCurve> plane_section(const Mesh& mesh, const Plane& plane);

/// Of the curve that runs around the point, a point of the plane, whether it is in its area.
[[nodiscard]] bool encloses(const SectionCurve& curve, const Plane& plane, const Eigen::Vector3d& point);

}  // namespace verisq::features
