/// Proves distances along ways again: parts of ways, and the checker of whole ones.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>
#include <verisq/model.hpp>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

// Checks of a way of insertion.

/// Precondition: below the number of triangles.
[[nodiscard]] inline Triangle triangle_of(const Mesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

/// Likewise, with an enclosure for each vertex.
[[nodiscard]] inline std::array<double, 3> lower_ends(const Mesh& mesh, std::size_t triangle,
                                                      std::span<const Enclosure> of_vertices) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {of_vertices[a].lo, of_vertices[b].lo, of_vertices[c].lo};
}

/// Vertices of no triangle are no part of the surface.
[[nodiscard]] inline double least_upper_end(const Mesh& mesh, std::span<const Enclosure> of_vertices) {
  double least = infinity;
  for (const auto& corners : mesh.triangles)
    for (const std::uint32_t vertex : corners) least = std::min(least, of_vertices[vertex].hi);
  return least;
}

// Parts of a way of insertion, and what is proven of points and triangles along each.

// Where a part of a path is halved.

/// Poses are the natural places to halve a path; between two of them, time. Such times have few digits.
[[nodiscard]] inline double middle_of_way(double begin, double end) {
  const double half = begin + (end - begin) / 2;
  return end - begin > 1.0 ? std::floor(half) : half;
}

}  // namespace verisq::verify

namespace verisq {

// What is asked of every path of poses.

/// Throws Error(input) for a path without poses, and for poses that are not finite or have a zero quaternion.
void check_path(std::span<const Pose> path);

/// Throws Error(input) for half a turn from one pose to the next: it has two ways of the same angle, and rounding would
/// choose one. Precondition: `check_path` has passed.
void check_turns(std::span<const Pose> path);

/// Of half the angle between two rotations, the smaller one: in [0, 1], about, whatever the quaternions' lengths.
/// Precondition: finite, not zero.
[[nodiscard]] double cosine_of_half_turn(const Pose& from, const Pose& to);

}  // namespace verisq

namespace verisq::verify {

// What a part of the way of a point through the implant's frame says of its distance to the implant.

/// About where the implant is at the end of its path, and so are the points of the bone that matter: paths of many legs
/// are proven tightest of points nearby. Proves nothing.
[[nodiscard]] Point seat_of(const Model& implant, std::span<const Pose> path);

/// Where a point of the bone is at a time, as the resting implant sees it.
struct Moment {
  double time;
  PointBall place;
};

/// Precondition: 0 <= time <= path.last_time().
[[nodiscard]] Moment moment_of(const RigidPath& path, const Point& c, double time);

/// Where numbers overflow nothing is known.
[[nodiscard]] bool is_finite(const PointBall& ball);

/// How far the point may be, between two moments, from the straight way.
struct Chord {
  Moment begin, end;
  double bulge;  ///< rounded up; infinite where nothing is known
};

/// Precondition: moments of this point and path, the first no later than the second.
[[nodiscard]] Chord chord_of(const RigidPath& path, const Point& c, const Moment& begin, const Moment& end);

/// No point of the way is farther from the segment's point that divides it alike; infinite for what is not finite.
[[nodiscard]] double offset_of(const Chord& chord, const std::array<Point, 2>& segment);

/// No distance on the part of the way is less than what is returned, which is no more than -infinity where its
/// certificate proves nothing; `asked` is what is to be proven.
[[nodiscard]] double lower_end(const Checker& implant, const Chord& chord, const WayPart& part, double asked);

/// No signed distance of a point of the ball is more than what is returned, by a certificate of its centre; infinite
/// where that proves nothing. `asked` is what is to be proven.
[[nodiscard]] double upper_end(const Checker& implant, const PointBall& place, double asked,
                               const Certificate& certificate, const Hook& interrupted = {});

// What a piece of a triangle on a part of the way, seen by the resting implant, says of all of its distances.

/// A model's primitives. Precondition: a union of convex ones.
[[nodiscard]] std::vector<PosedSuperquadric> solids_of(const Model& model);

/// The ways of the piece's corners, all between the same times.
struct WayPrism {
  std::array<Chord, 3> corners;
  double off;  ///< how far the exact corners of the piece are from those whose ways these are, at most
};

/// Where the corners begin and where they end, each moved by the step, to nearest.
struct MovedPrism {
  Triangle begin, end;
};
[[nodiscard]] MovedPrism moved(const WayPrism& prism, const Point& step);

/// No point of the piece is farther, at any time of the part, from the convex hull of the moved corners; infinite for
/// what is not finite.
[[nodiscard]] double offset_of(const WayPrism& prism, const MovedPrism& hull);

/// From the middle of a solid to that of the hull, in the solid's own frame: a normal that may separate the two.
[[nodiscard]] Proposal outward_normal(const PosedSuperquadric& solid, const MovedPrism& hull);

/// No signed distance to the union of the solids in the cell is less; minus infinity where the certificate proves
/// nothing.
[[nodiscard]] double lower_end(std::span<const PosedSuperquadric> solids, const WayPrism& prism, const MovedCell& cell);

// What is proven of all of a triangle along the way by dividing it, and the way.

/// A piece of a triangle on a part of the way.
struct WayPiece {
  Triangle corners;
  double begin, end;
  int quarterings = 0;
};

/// Where one triangle's pieces are; poses are computed once for each time. Of one thread.
class PiecesOnWay {
 public:
  /// `path` has to outlive this. Precondition: finite.
  PiecesOnWay(const RigidPath& path, const Triangle& whole);

  [[nodiscard]] WayPiece whole() const { return {whole_, 0.0, path_.last_time()}; }
  /// How far corners of pieces are off.
  [[nodiscard]] double off() const { return off_; }
  /// Precondition: a piece of this triangle, times of the path.
  [[nodiscard]] WayPrism prism_of(const WayPiece& piece);
  /// What the vertices say of it.
  [[nodiscard]] double least_on(const WayPiece& piece, const std::array<double, 3>& at_vertices) const;

 private:
  [[nodiscard]] Moment moment(const Point& corner, double time);

  const RigidPath& path_;
  Triangle whole_;
  double off_;
  std::map<double, RigidPath::NearestPose> poses_;
};

/// No signed distance of a point of the triangle is less at any time, if none of its vertices is less than
/// `at_vertices`; minus infinity where the proof is not of all of it.
[[nodiscard]] double least_on(const RigidPath& path, std::span<const PosedSuperquadric> solids, const Triangle& whole,
                              const std::array<double, 3>& at_vertices, const WayTriangle& proof,
                              const Hook& interrupted = {});

}  // namespace verisq::verify
