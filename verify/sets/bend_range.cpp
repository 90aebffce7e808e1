/// Extents of the solid along and across the bend by its support function, and the image of their box in closed form.
#include "verify/sets/bend_range.hpp"

#include "verify/analysis/trigonometry.hpp"
#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

namespace {

PreciseInterval curvature_magnitude(const Bend& bend) {
  return abs(PreciseInterval(Real(bend.curvature)));
}

/// By which the end of the bent axis is turned.
PreciseInterval angle(const Bend& bend, const Superquadric& superquadric) {
  return curvature_magnitude(bend) * PreciseInterval(Real(superquadric.semi_axes[2]));
}

/// The largest of the coordinate `axis` of the bend's frame: 0 for |r|, 1 for |s|.
PreciseInterval extent_of(const Bend& bend, const Superquadric& superquadric, std::size_t axis) {
  return SuperquadricBounds<Real>(superquadric).support(turn(bend).column(axis));
}

PreciseInterval symmetric(const PreciseInterval& half) {
  return {-half.upper(), half.upper()};
}

}  // namespace

PreciseMatrix turn(const Bend& bend) {
  const PreciseInterval c = cos_of_degrees<Real>(bend.angle_degrees);
  const PreciseInterval s = sin_of_degrees<Real>(bend.angle_degrees);
  return {{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
}

PreciseInterval extent(const Bend& bend, const Superquadric& superquadric) {
  return extent_of(bend, superquadric, 0);
}

bool keeps_off_its_centre(const Bend& bend, const Superquadric& superquadric) {
  return (curvature_magnitude(bend) * extent(bend, superquadric)).upper() < Real(1);
}

bool is_less_than_a_full_turn(const Bend& bend, const Superquadric& superquadric) {
  return angle(bend, superquadric).upper() < pi<Real>().lower();
}

bool is_connected_below(double depth, const Bend& bend, const Superquadric& superquadric) {
  const PreciseInterval k = curvature_magnitude(bend);
  const PreciseInterval nearest = PreciseInterval(1) - k * extent(bend, superquadric);  // W, of all points
  return (PreciseInterval(10) * k * PreciseInterval(Real(depth))).upper() <= (PreciseInterval(9) * nearest).lower();
}

/// The solid lies in |r| <= e, |s| <= f, |z| <= a3. With k > 0 (k < 0 mirrors R) and γ = kz:
/// R = 1/k - (1/k - r) cos γ is least, -e, at γ = 0; it is largest at the end of the axis, where with h = k a3 / 2 it
/// is at most |cos 2h| e + (2/k) sin² h. |Z| = (1/k - r) |sin γ| <= (1/k + e) max |sin γ|. Nothing cancels as k -> 0.
PreciseVector bent_box(const Bend& bend, const Superquadric& superquadric) {
  const PreciseInterval e = extent(bend, superquadric);
  const PreciseInterval f = extent_of(bend, superquadric, 1);
  const PreciseInterval a3 = Real(superquadric.semi_axes[2]);
  if (bend.curvature == 0.0) return {symmetric(e), symmetric(f), symmetric(a3)};
  const PreciseInterval k = curvature_magnitude(bend);
  const PreciseInterval sine_of_half = sin(angle(bend, superquadric) / PreciseInterval(2));
  const PreciseInterval cosine_of_whole = PreciseInterval(1) - PreciseInterval(2) * square(sine_of_half);
  const PreciseInterval sagitta = PreciseInterval(2) * square(sine_of_half) / k;
  const PreciseInterval cosine_of_half = sqrt(PreciseInterval(1) - square(sine_of_half));
  // Beyond a quarter of a turn the largest sine is 1, not that of the end.
  const PreciseInterval largest_sine =
      cosine_of_whole.lower() >= Real(0) ? PreciseInterval(2) * sine_of_half * cosine_of_half : PreciseInterval(1);
  const PreciseInterval along = hull(-e, abs(cosine_of_whole) * e + sagitta);
  return {bend.curvature > 0.0 ? along : -along, symmetric(f),
          symmetric((PreciseInterval(1) + k * e) * largest_sine / k)};
}

}  // namespace verisq::verify
