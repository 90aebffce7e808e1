/// Reduces a point inside to the octant (or the profile of a solid of revolution) and encloses its depth there.
#include "verify/interior.hpp"

#include <algorithm>
#include <cmath>

#include "verify/inscribed_polyhedron.hpp"

namespace verisq::verify {

namespace {

/// Enough for a continuum of nearest boundary points (beyond those of revolution, which are reduced) at 1e-6.
constexpr int kBudget = 50'000;

/// The proofs of surface points in binary64 lose some 4e-15 of the largest semi-axis.
constexpr double kFinestTolerance = 1e-14;

/// Radius of a ball about the centre inside the solid, rounded down. Mixed norms with p >= 1 are at most the 1-norm, so
/// the octahedron of the semi-axes lies inside; with p >= 2 at most the 2-norm, so the ellipsoid does.
PreciseInterval inner_radius(const Superquadric& solid) {
  if (std::max(solid.exponents[0], solid.exponents[1]) <= 1.0) return Real(std::ranges::min(solid.semi_axes));
  PreciseInterval sum(0);
  for (const double a : solid.semi_axes) sum += PreciseInterval(1) / square(PreciseInterval(Real(a)));
  return PreciseInterval(1) / sqrt(sum);
}

/// g(q + y) <= g(q) + g(y) <= g(q) + |y| / radius, so the ball of radius (1 - g(q)) * radius about q lies inside.
double central_depth(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q) {
  const PreciseInterval depth = (PreciseInterval(1) - bounds.gauge(q)) * inner_radius(solid);
  return std::max(0.0, depth.lower().to_double(Direction::down));
}

/// The same problem in the octant of nonnegative coordinates, the largest semi-axis in [1, 2).
struct Reduced {
  Superquadric solid;
  std::array<double, 3> q;  ///< at least the exact coordinates: by monotony, balls about it that lie inside prove more
  bool planar = false;      ///< revolved about z into the plane y = 0
  std::array<std::size_t, 3> order{0, 1, 2};  ///< reduced coordinate k is coordinate order[k] of the original
  int scale = 0;                              ///< binary exponent of the original's unit
};

/// Brings the axis of an ellipsoid of revolution to z; an ellipsoid's coordinates may be exchanged freely.
std::array<std::size_t, 3> revolution_order(const Superquadric& solid) {
  const auto& a = solid.semi_axes;
  if (solid.exponents != std::array<double, 2>{1.0, 1.0} || a[0] == a[1]) return {0, 1, 2};
  if (a[1] == a[2]) return {1, 2, 0};
  if (a[0] == a[2]) return {2, 0, 1};
  return {0, 1, 2};
}

/// value * 2^exponent of a nonnegative value, rounded down: it is inexact where it underflows.
double scaled_down(double value, int exponent) {
  const double result = std::ldexp(value, exponent);
  return std::ldexp(result, -exponent) > value ? std::nextafter(result, 0.0) : result;
}

double scaled_up(double value, int exponent) {
  const double result = std::ldexp(value, exponent);
  return std::ldexp(result, -exponent) < value ? std::nextafter(result, 4.0) : result;
}

Reduced reduce(const Superquadric& solid, const PreciseVector& q) {
  Reduced reduced{solid, {}};
  reduced.order = revolution_order(solid);
  reduced.scale = std::ilogb(std::ranges::max(solid.semi_axes));
  PreciseVector position;
  for (std::size_t k = 0; k < 3; ++k) {
    reduced.solid.semi_axes[k] = std::ldexp(solid.semi_axes[reduced.order[k]], -reduced.scale);  // see searchable()
    position[static_cast<Eigen::Index>(k)] = abs(q[static_cast<Eigen::Index>(reduced.order[k])]);
  }
  // A solid of revolution: the distance depends on (x, y) through its length alone, in the half-plane of q.
  reduced.planar = reduced.solid.semi_axes[0] == reduced.solid.semi_axes[1] && solid.exponents[1] == 1.0;
  if (reduced.planar) {
    position[0] = sqrt(square(position[0]) + square(position[1]));
    position[1] = 0;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double coordinate = position[static_cast<Eigen::Index>(k)].upper().to_double(Direction::up);
    reduced.q[k] = scaled_up(coordinate, -reduced.scale);
  }
  return reduced;
}

/// Undoes the reduction for a direction; not proven, as a certificate's direction need not be.
Proposal restored(const Reduced& reduced, const std::array<double, 3>& normal, const PreciseVector& q) {
  std::array<long double, 3> original{};
  for (std::size_t k = 0; k < 3; ++k) {
    original[k] = q[static_cast<Eigen::Index>(reduced.order[k])].upper().to_long_double();
  }
  std::array<long double, 3> v{normal[0], normal[1], normal[2]};
  if (reduced.planar) {
    const long double radius = std::hypot(original[0], original[1]);
    const long double radial = v[0];
    v[0] = radius > 0.0L ? radial * std::fabs(original[0]) / radius : radial;
    v[1] = radius > 0.0L ? radial * std::fabs(original[1]) / radius : 0.0L;
  }
  Proposal result{};
  for (std::size_t k = 0; k < 3; ++k) result[reduced.order[k]] = std::copysign(v[k], original[k]);
  return result;
}

/// Whether scaling kept the semi-axes exact and the proofs in binary64 still see q inside.
bool searchable(const Reduced& reduced) {
  return std::ranges::min(reduced.solid.semi_axes) >= 1e-200 &&
         SuperquadricBounds<double>(reduced.solid).gauge(reduced.q, Direction::up) <= 1.0;
}

/// The shortest semi-axis: a usable direction where nothing better is known.
std::array<double, 3> shortest_axis(const Superquadric& solid) {
  std::array<double, 3> axis{};
  axis[static_cast<std::size_t>(std::ranges::min_element(solid.semi_axes) - solid.semi_axes.begin())] = 1.0;
  return axis;
}

}  // namespace

CertifiedDistance interior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                    const PreciseVector& q, double tolerance) {
  double depth = central_depth(solid, bounds, q);
  const Reduced reduced = reduce(solid, q);
  std::array<double, 3> normal = shortest_axis(reduced.solid);
  if (searchable(reduced)) {
    const double finest = std::max(std::ldexp(tolerance, -reduced.scale), kFinestTolerance);
    const Depth found =
        enclose_depth(reduced.solid, reduced.q, reduced.planar, {finest, scaled_down(depth, -reduced.scale), kBudget});
    depth = std::max(depth, scaled_down(found.lower, reduced.scale));
    normal = found.normal;
  }
  const Proposal direction = restored(reduced, normal, q);
  return {{lower_bound(bounds, q, direction), -depth}, direction};
}

}  // namespace verisq::verify
