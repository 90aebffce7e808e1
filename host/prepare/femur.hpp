/// A femur's head, neck, shaft and condyles, found on a mesh of it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/mesh.hpp>

namespace verisq::features {

// A femur's head and neck, and tests that they belong to a femur.

// The head of a femur: the sphere that most of its surface covers.

struct HeadSphere {
  Eigen::Vector3d centre;
  double radius;
  double coverage;           ///< share of the sphere that is the mesh's surface; it may be above 1 for coarse meshes
  std::size_t vertices = 0;  ///< number of the mesh's vertices on it
};

inline constexpr double smallest_head = 12.0;  // mm: of a child
inline constexpr double largest_head = 35.0;
/// Condyles cover less than a half of their spheres, heads more.
inline constexpr double least_head_coverage = 0.42;

/// The same result for the same mesh. Precondition: triangles whose normals point outward.
[[nodiscard]] std::optional<HeadSphere> head_sphere(const Mesh& mesh);

// The neck of a femur: its narrowest section.

/// Sections are sought from there on, in head radii from the head's centre.
inline constexpr double nearest_neck_section = 0.75;

struct NeckSection {
  Eigen::Vector3d centre;  ///< centroid of the section of least perimeter
  double perimeter;
  double distance;  ///< from the head's centre
};

/// Searches the sections by planes that look at the head's centre. `towards_shaft` is roughly the direction of the
/// neck, from the head, of length 1. Nothing if no plane cuts the neck in one closed curve.
[[nodiscard]] std::optional<NeckSection> neck_section(const Mesh& mesh, const Eigen::Vector3d& head, double head_radius,
                                                      const Eigen::Vector3d& towards_shaft);

// The possible proportions of a femur: a result beyond them is an error of the search.

/// Throws Error(input) with the finding and the reason why no femur has it: a sphere of which more than the whole, or
/// only a few vertices, is covered; a neck that is narrowest where the head begins.
void check_head_and_neck(const HeadSphere& head, const NeckSection& neck);

/// The same, with the range, for angles and for proportions to the head's radius.
void check_proportions(const FemurLandmarks& landmarks, std::optional<Side> side);

// A femur's sections, its shaft's axis and its condyles.

// Plane sections of a mesh: the closed curves in which a plane cuts it, their perimeter, area and centroid.

/// Points x with normal.x = offset; the normal has length 1.
struct Plane {
  Eigen::Vector3d normal;
  double offset;
};

/// A closed curve in a plane. About solid parts the area is positive, about holes negative.
struct SectionCurve {
  double perimeter;
  double area;
  Eigen::Vector3d centroid;  ///< centroid of the area
  std::vector<Eigen::Vector3d> points;
};

/// The sections of a closed, oriented mesh whose normals point outward; curves that do not close are left out.
[[nodiscard]] std::vector<SectionCurve> plane_section(const Mesh& mesh, const Plane& plane);

/// Returns whether the curve runs around the point, a point of the plane.
[[nodiscard]] bool encloses(const SectionCurve& curve, const Plane& plane, const Eigen::Vector3d& point);

// The axis of a femur's shaft, and the ends of the shaft.

struct ShaftAxis {
  Eigen::Vector3d point;      ///< on the axis, in the middle of the shaft
  Eigen::Vector3d direction;  ///< of length 1, towards the head
  double distal;              ///< the shaft's end, along the direction from the point
  double proximal;
  double area;         ///< area of the narrowest section
  double distal_area;  ///< largest section between the shaft and the mesh's distal end
  double distal_end;   ///< the mesh's end, along the direction from the point
};

/// Found by the centroids of sections across the axis, from `head` downward where the shaft is narrow. `along` is
/// roughly the axis, towards the head. Nothing if there are too few sections.
[[nodiscard]] std::optional<ShaftAxis> shaft_axis(const Mesh& mesh, const Eigen::Vector3d& head, double head_radius,
                                                  const Eigen::Vector3d& along);

// The condyles of a femur: the points on which it lies, and its most prominent ones to both sides.

struct Condyles {
  Eigen::Vector3d medial_posterior;
  Eigen::Vector3d lateral_posterior;
  Eigen::Vector3d medial_epicondyle;
  Eigen::Vector3d lateral_epicondyle;
};

/// The vertices beyond the shaft's distal end; none where the bone ends with its shaft.
[[nodiscard]] std::vector<Eigen::Vector3d> distal_end(const Mesh& mesh, const ShaftAxis& shaft);

/// How much farther the distal end reaches from the shaft's axis in a direction than against it: backward, for a femur.
[[nodiscard]] double excess(std::span<const Eigen::Vector3d> distal, const ShaftAxis& shaft,
                            const Eigen::Vector3d& direction);

/// `medial` and `posterior`: roughly those directions, across the shaft. Precondition: at least 10 vertices.
[[nodiscard]] Condyles condyles(std::span<const Eigen::Vector3d> distal, const ShaftAxis& shaft,
                                const Eigen::Vector3d& medial, const Eigen::Vector3d& posterior);

}  // namespace verisq::features
