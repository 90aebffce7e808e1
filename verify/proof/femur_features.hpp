/// A femur's features, enclosed, and their check.
#pragma once

#include <array>
#include <optional>
#include <verisq/model.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"
#include "verisq/features.hpp"

namespace verisq::verify {

// Features of a femur in 127-bit intervals, for comparison with claims.

/// The same values as the functions of verisq/features.hpp, each end rounded outward to binary64.
[[nodiscard]] FemurFeatures precise_femur_features(const FemurLandmarks& landmarks, std::optional<Side> side,
                                                   double landmark_radius);
[[nodiscard]] FemurFeatures precise_implant_changes(const FemurLandmarks& bone, std::optional<Side> side,
                                                    double landmark_radius, const FemurLandmarks& implant);

/// For each of the frame's axes x, y, z: the largest angle in degrees by which the axis tilts from a direction. Nothing
/// if the landmarks determine no frame. Precondition: finite, not 0.
[[nodiscard]] std::optional<std::array<double, 3>> precise_tilts(const FemurLandmarks& landmarks,
                                                                 std::optional<Side> side, double landmark_radius,
                                                                 const std::array<Point, 3>& directions);

// Balls in which landmarks lie, and the cones of the directions between them.

// T is the type of the ends: double or Real.

/// The exact point. Precondition: finite.
template <class T>
[[nodiscard]] Vector3<T> exact(const Point& x) {
  return {T(x[0]), T(x[1]), T(x[2])};
}

/// All points within `radius` of a centre.
template <class T>
struct LandmarkBall {
  Vector3<T> centre;
  BasicInterval<T> radius;
};

/// The middle of the segments between the points of two balls.
template <class T>
[[nodiscard]] LandmarkBall<T> middle_of(const LandmarkBall<T>& a, const LandmarkBall<T>& b);

/// All vectors within `reach` of a centre: the differences of the points of two balls.
template <class T>
struct VectorBall {
  Vector3<T> centre;
  BasicInterval<T> reach;
};
template <class T>
[[nodiscard]] VectorBall<T> difference(const LandmarkBall<T>& to, const LandmarkBall<T>& from);

/// In radians: no vector of the ball tilts farther from the direction of its centre, and some vectors tilt as far. If
/// the ball contains 0, nothing below pi is proven.
template <class T>
[[nodiscard]] BasicInterval<T> tilt(const VectorBall<T>& v);

/// asin of the part of x in [0, 1], pi / 2 beyond 1; the angle whose sine is at most x.
template <class T>
[[nodiscard]] BasicInterval<T> arcsine(const BasicInterval<T>& x);

/// The angle between two vectors, in [0, pi].
template <class T>
[[nodiscard]] BasicInterval<T> angle_between(const Vector3<T>& a, const Vector3<T>& b);

}  // namespace verisq::verify
