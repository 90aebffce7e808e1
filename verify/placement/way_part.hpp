/// What a part of the way of a point through the implant's frame says of its distance to the implant.
#pragma once

#include "verify/placement/rigid_path.hpp"
#include "verisq/checker.hpp"
#include "verisq/insertion_certificate.hpp"

namespace verisq::verify {

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
                               const Certificate& certificate);

}  // namespace verisq::verify
