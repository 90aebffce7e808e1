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

/// The lower ends of the enclosures at a triangle's vertices. Precondition: below the number of triangles; an enclosure
/// for each vertex.
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

// Parts of a way of insertion, and the bounds proven for points and triangles along each part.

// The time at which a part of a path is halved.

/// A path is halved at poses; between two poses it is halved in time. Such times have few digits.
[[nodiscard]] inline double middle_of_way(double begin, double end) {
  const double half = begin + (end - begin) / 2;
  return end - begin > 1.0 ? std::floor(half) : half;
}

}  // namespace verisq::verify

namespace verisq {

// Requirements on every path of poses.

/// Throws Error(input) for a path without poses, and for poses that are not finite or have a zero quaternion.
void check_path(std::span<const Pose> path);

/// Throws Error(input) for half a turn from one pose to the next: it has two ways of the same angle, and rounding would
/// choose one. Precondition: `check_path` has passed.
void check_turns(std::span<const Pose> path);

/// The approximate cosine of half the angle between two rotations, the smaller angle: in [0, 1], whatever the
/// quaternions' lengths. Precondition: finite, not zero.
[[nodiscard]] double cosine_of_half_turn(const Pose& from, const Pose& to);

}  // namespace verisq

namespace verisq::verify {

// The bounds of a point's distance to the implant, by a part of the point's way through the implant's frame.

/// About the place of the implant at the end of its path; the relevant points of the bone lie near it. For paths of
/// many legs the bounds are tightest for points near this one. Proves nothing.
[[nodiscard]] Point seat_of(const Model& implant, std::span<const Pose> path);

/// The place of a point of the bone at a time, as the resting implant sees it.
struct Moment {
  double time;
  PointBall place;
};

/// Precondition: 0 <= time <= path.last_time().
[[nodiscard]] Moment moment_of(const RigidPath& path, const Point& c, double time);

/// True unless numbers overflowed; then nothing is known.
[[nodiscard]] bool is_finite(const PointBall& ball);

/// A straight chord between two moments of a point's way, and a bound of the way's distance from it.
struct Chord {
  Moment begin, end;
  double bulge;  ///< rounded up; infinite if nothing is known
};

/// Precondition: moments of this point and path, the first no later than the second.
[[nodiscard]] Chord chord_of(const RigidPath& path, const Point& c, const Moment& begin, const Moment& end);

/// No point of the way is farther than this from the segment's point that divides it alike; infinite for non-finite
/// numbers.
[[nodiscard]] double offset_of(const Chord& chord, const std::array<Point, 2>& segment);

/// A lower bound of all distances on the part of the way. If the certificate proves nothing, the result is -infinity.
/// `asked` is the bound to be proven.
[[nodiscard]] double lower_end(const Checker& implant, const Chord& chord, const WayPart& part, double asked);

/// An upper bound of the signed distances of all points of the ball, by a certificate of its centre. If the certificate
/// proves nothing, the result is infinite. `asked` is the bound to be proven.
[[nodiscard]] double upper_end(const Checker& implant, const PointBall& place, double asked,
                               const Certificate& certificate, const Hook& interrupted = {});

// Bounds of all distances of a piece of a triangle on a part of the way, seen by the resting implant.

/// The primitives of a model. Precondition: a union of convex primitives.
[[nodiscard]] std::vector<PosedSuperquadric> solids_of(const Model& model);

/// The ways of the piece's corners, all between the same times.
struct WayPrism {
  std::array<Chord, 3> corners;
  double off;  ///< upper bound of the distance between the exact corners of the piece and the corners whose ways these
               ///< are
};

/// The corners at the beginning and at the end, each moved by the step, rounded to nearest.
struct MovedPrism {
  Triangle begin, end;
};
[[nodiscard]] MovedPrism moved(const WayPrism& prism, const Point& step);

/// At any time of the part no point of the piece is farther than this from the convex hull of the moved corners;
/// infinite for non-finite numbers.
[[nodiscard]] double offset_of(const WayPrism& prism, const MovedPrism& hull);

/// The vector from the middle of a solid to the middle of the hull, in the solid's own frame: a normal that may
/// separate the two.
[[nodiscard]] Proposal outward_normal(const PosedSuperquadric& solid, const MovedPrism& hull);

/// A lower bound of the signed distances to the union of the solids in the cell; minus infinity if the certificate
/// proves nothing.
[[nodiscard]] double lower_end(std::span<const PosedSuperquadric> solids, const WayPrism& prism, const MovedCell& cell);

// Bounds for a whole triangle along the way, by dividing both.

/// A piece of a triangle on a part of the way.
struct WayPiece {
  Triangle corners;
  double begin, end;
  int quarterings = 0;
};

/// The places of one triangle's pieces; each time's pose is computed once. For one thread only.
class PiecesOnWay {
 public:
  /// `path` has to outlive this. Precondition: finite.
  PiecesOnWay(const RigidPath& path, const Triangle& whole);

  [[nodiscard]] WayPiece whole() const { return {whole_, 0.0, path_.last_time()}; }
  /// Upper bound of the error of the pieces' corners.
  [[nodiscard]] double off() const { return off_; }
  /// Precondition: a piece of this triangle, times of the path.
  [[nodiscard]] WayPrism prism_of(const WayPiece& piece);
  /// The lower bound that the vertices' bounds give for the piece.
  [[nodiscard]] double least_on(const WayPiece& piece, const std::array<double, 3>& at_vertices) const;

 private:
  [[nodiscard]] Moment moment(const Point& corner, double time);

  const RigidPath& path_;
  Triangle whole_;
  double off_;
  std::map<double, RigidPath::NearestPose> poses_;
};

/// A lower bound of the signed distances of all points of the triangle at all times, if the signed distances of its
/// vertices are at least `at_vertices`. Minus infinity if the proof does not cover the whole triangle.
[[nodiscard]] double least_on(const RigidPath& path, std::span<const PosedSuperquadric> solids, const Triangle& whole,
                              const std::array<double, 3>& at_vertices, const WayTriangle& proof,
                              const Hook& interrupted = {});

}  // namespace verisq::verify
