/// Random cases of the lemmas of kernels/bent_depth.clh, with what is true of them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>
#include <verisq/model.hpp>

namespace verisq::mutation {

/// Kernels take so many cases of one solid at a time, and then as many of the next.
inline constexpr std::size_t cases_at_a_time = 4;

/// Bent solids with exponents of at most 1, for which lemmas hold, and then others. No semi-axis is above 2: the frame
/// of the device is the model's.
struct DepthSolids {
  std::vector<Primitive> all;
  std::size_t of_lemmas;  ///< the first of them
};
enum class Tapers : bool { none, some };
[[nodiscard]] DepthSolids depth_solids(Tapers tapers);

inline constexpr double metric_curvature = 0.5;

/// A ball in the plane of a bend of this curvature about q with c on its border, and points of it.
struct MetricCase {
  std::array<double, 5> given;  ///< c and q, each R and Z, and the radius
  struct Point {
    double excess;         ///< of f over its tangent plane at c
    double across, along;  ///< squares of the steps in r and z from c
  };
  std::vector<Point> points;
  double apart;             ///< z of c less that of q, the short way
  double reach_r, reach_z;  ///< how far points of the ball lie from q
};

/// Points of a box, where the second derivative of a function is known. Here and below coordinates of tapered solids
/// are about the focus.
struct SecondCase {
  std::array<double, 7> given;  ///< lower and upper ends of x, y, z, and the stretch
  double largest;
};

/// A way from c to a point within reach of q.
struct WayCase {
  std::array<double, 10> given;  ///< c, q, the reach along each axis, the stretch
  double weighted;
};

/// The gradient and twice the value at points of a box.
struct GradientCase {
  std::array<double, 6> given;  ///< lower and upper ends of |x|, |y| and, without a taper, of |z|
  std::array<double, 3> least, largest;
  double twice;
};

/// Of one of the functions of gauge_square.hpp.
struct FunctionCases {
  std::vector<SecondCase> seconds;
  std::vector<WayCase> ways;
  std::vector<GradientCase> gradients;
};

/// The ball about q with p on its border.
struct BallCase {
  std::array<double, 6> given;  ///< q and p in the frame of the bend
  bool outside;                 ///< whether a point of it is known outside of the solid
};

/// A point of the model's frame inside, whose depth is between two numbers.
struct DepthCase {
  Point point;
  double least, most;
};

/// In the order of the solids of lemmas, `cases_at_a_time` of each; metrics are of no solid.
struct DepthCases {
  explicit DepthCases(const DepthSolids& solids);

  std::vector<MetricCase> metrics;
  FunctionCases of_gauge, of_profile;  ///< what is said of gauges holds without tapers
  std::vector<BallCase> balls;
  std::vector<std::vector<DepthCase>> depths;  ///< of each of all solids
};

}  // namespace verisq::mutation
