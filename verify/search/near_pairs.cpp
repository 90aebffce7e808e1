/// Spheres in binary64, with one bound for all rounding errors.
#include "verify/search/near_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/length.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

struct Sphere {
  Point centre;
  double radius;
  double size;   ///< of the numbers at hand
  double width;  ///< of the enclosure of the centre: more than rounding where large numbers cancel in it
};

Sphere sphere_of(const PreciseVector& centre, const PreciseInterval& radius) {
  Sphere sphere{{}, radius.upper().to_double(Direction::up), 0.0, 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval& c = centre[i];
    sphere.centre[i] = c.upper().to_double(Direction::up);
    sphere.size += std::fabs(sphere.centre[i]);
    sphere.width += (PreciseInterval(c.upper()) - PreciseInterval(c.lower())).upper().to_double(Direction::up);
  }
  sphere.size += sphere.radius;
  return sphere;
}

double between_centres(const Sphere& a, const Sphere& b) {
  return length(a.centre[0] - b.centre[0], a.centre[1] - b.centre[1], a.centre[2] - b.centre[2]);
}

/// Of lengths computed from two spheres. With u = 2^-53 and s the sum of both sizes: beyond the widths of the
/// enclosures, centres and radii are rounded by 2 u s in all, differences by u s, the length of three of them by 8 u s
/// (length.hpp), the sum with the radii by 2 u s, and this sum by less than what it adds: less than 2^5 u s. Subnormal
/// numbers round by less than the last term.
double rounding_error(const Sphere& a, const Sphere& b) {
  return 0x1p-46 * (a.size + b.size) + 2.0 * (a.width + b.width) + 0x1p-1000;
}

}  // namespace

NearPairs near_pairs(const PosedPairs& pairs) {
  std::vector<Sphere> of_a;
  std::vector<Sphere> of_b;
  for (std::size_t i = 0; i < pairs.size_a(); ++i)
    of_a.push_back(sphere_of(pairs.motion_a(i).translation, pairs.radius_a(i)));
  for (std::size_t j = 0; j < pairs.size_b(); ++j)
    of_b.push_back(sphere_of(pairs.motion_b(j).translation, pairs.radius_b(j)));
  double nearest_centres = infinity;
  for (const Sphere& a : of_a) {
    for (const Sphere& b : of_b)
      nearest_centres = std::min(nearest_centres, between_centres(a, b) + rounding_error(a, b));
  }
  NearPairs result{{}, infinity};
  for (std::uint32_t i = 0; i < of_a.size(); ++i) {
    for (std::uint32_t j = 0; j < of_b.size(); ++j) {
      const Sphere& a = of_a[i];
      const Sphere& b = of_b[j];
      const double lower = between_centres(a, b) - a.radius - b.radius - rounding_error(a, b);
      // Also where overflow leaves no number.
      if (!(lower > nearest_centres)) {
        result.pairs.push_back({i, j});
      } else {
        result.others = std::min(result.others, lower);
      }
    }
  }
  return result;
}

}  // namespace verisq::verify
