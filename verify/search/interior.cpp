/// Reduces a point inside to the octant (or the profile of a solid of revolution) and encloses its depth there.
#include "verify/search/interior.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/contained_ball.hpp"
#include "verify/proof/revolution.hpp"
#include "verify/search/inscribed_polyhedron.hpp"

namespace verisq::verify {

namespace {

/// Enough for a continuum of nearest boundary points (beyond those of revolution, which are reduced) at 1e-6.
constexpr int kBudget = 50'000;

/// The proofs of surface points in binary64 lose some 4e-15 of the largest semi-axis.
constexpr double kFinestTolerance = 1e-14;

/// The same problem in the octant of nonnegative coordinates, of a tapered solid also below it, the largest semi-axis
/// in [1, 2).
struct Reduced {
  Superquadric solid;
  std::array<double, 3> q;  ///< at least the exact coordinates: by monotony, balls about it that lie inside prove more
  PreciseInterval moved;    ///< how far q lies from the exact point where g is not monotone, in the original's unit
  bool planar;              ///< as in RevolvedPoint, like `order`
  std::array<std::size_t, 3> order;
  int scale;  ///< binary exponent of the original's unit
};

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
  const RevolvedPoint point = revolved(solid, q);
  Reduced reduced{point.solid,  {},          PreciseInterval(0),
                  point.planar, point.order, std::ilogb(std::ranges::max(solid.semi_axes))};
  for (double& axis : reduced.solid.semi_axes) axis = std::ldexp(axis, -reduced.scale);  // see searchable()
  for (std::size_t k = 0; k < 3; ++k) {
    const double coordinate = point.q[k].upper().to_double(Direction::up);
    reduced.q[k] = scaled_up(coordinate, -reduced.scale);
  }
  if (is_tapered(solid)) {
    reduced.moved = abs(point.q[2] - PreciseInterval(Real(std::ldexp(reduced.q[2], reduced.scale)))).upper();
  }
  return reduced;
}

/// Undoes the reduction for a direction; not proven, as a certificate's direction need not be.
Proposal restored(const Reduced& reduced, const std::array<double, 3>& normal, const PreciseVector& q) {
  std::array<long double, 3> original{};
  for (std::size_t k = 0; k < 3; ++k) {
    original[k] = q[reduced.order[k]].upper().to_long_double();
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
  if (is_tapered(reduced.solid)) result[2] = v[2];
  return result;
}

/// Whether scaling kept the semi-axes exact and the proofs in binary64 still see q inside.
bool searchable(const Reduced& reduced) {
  return std::ranges::min(reduced.solid.semi_axes) >= 1e-200 &&
         SuperquadricBounds<double>(reduced.solid).gauge_up({reduced.q[0], reduced.q[1], reduced.q[2]}) <= 1.0;
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
    const PreciseInterval about_q = PreciseInterval(Real(scaled_down(found.lower, reduced.scale))) - reduced.moved;
    depth = std::max(depth, about_q.lower().to_double(Direction::down));
    normal = found.normal;
  }
  const Proposal direction = restored(reduced, normal, q);
  return {{lower_bound(bounds, q, direction), -depth}, direction};
}

}  // namespace verisq::verify
