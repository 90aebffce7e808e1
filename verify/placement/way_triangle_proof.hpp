/// What is proven of all of a triangle along the way by dividing it, and the way.
#pragma once

#include <array>
#include <map>
#include <span>

#include "verify/placement/rigid_path.hpp"
#include "verify/placement/way_prism.hpp"
#include "verisq/mesh.hpp"
#include "verisq/way_surface_certificate.hpp"

namespace verisq::verify {

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
                              const std::array<double, 3>& at_vertices, const WayTriangle& proof);

}  // namespace verisq::verify
