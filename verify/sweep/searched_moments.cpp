/// Searches at poses that binary64 holds, beside the exact ones.
#include "verify/sweep/searched_moments.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "verify/search/certified_distance.hpp"
#include "verify/sets/bounding_box.hpp"

namespace verisq::verify {
namespace {

/// Of what the distance may change over a stretch a search leaves open at its middle: planes lose less than the change,
/// and a search that is finer costs more than it saves.
constexpr double share_of_change = 0x1p-4;

double up(const PreciseInterval& x) {
  return x.upper().to_double(Direction::up);
}

/// The smaller one, of numbers that both bound the same.
PreciseInterval less(const PreciseInterval& x, const PreciseInterval& y) {
  return x.upper() < y.upper() ? x : y;
}

/// It holds the model, in the model's own frame.
EnclosingSphere sphere_about(const Model& model) {
  const Box box = bounding_box(model);
  Point middle;
  for (std::size_t i = 0; i < 3; ++i) middle[i] = std::midpoint(box.lower[i], box.upper[i]);
  const PreciseVector centre = precise(middle);
  // As far as the farther corner: the middle is rounded.
  PreciseVector corner;
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval to_lower = abs(centre[i] - PreciseInterval(Real(box.lower[i])));
    const PreciseInterval to_upper = abs(PreciseInterval(Real(box.upper[i])) - centre[i]);
    corner[i] = to_lower.upper() > to_upper.upper() ? to_lower : to_upper;
  }
  return {centre, length<Real>(corner)};
}

}  // namespace

SearchedMoments::SearchedMoments(const PosedPath& path, const Model& a, const Model& b, double tolerance,
                                 std::function<bool()> interrupted)
    : path_(&path),
      search_(a, b),
      pair_(a, b),
      sphere_a_(sphere_about(a)),
      sphere_b_(sphere_about(b)),
      tolerance_(tolerance),
      interrupted_(std::move(interrupted)) {}

// The distance changes no faster than points of B move in A's frame, and no faster than points of A move in B's.
PreciseInterval SearchedMoments::change(const ShortMotion& motion) const {
  const EnclosingSphere moved{motion.pose()(sphere_b_.centre), sphere_b_.radius};
  return less(motion.way_seen_of(sphere_a_), motion.way_of(moved));
}

// |(R - R') x + (t - t')| <= |(R - R') c + (t - t')| + |R - R'| r, and |R - R'| is at most the sum of its columns'
// lengths.
double SearchedMoments::displacement(const RigidMotion& exact, const RigidMotion& nearby) const {
  const PreciseVector at_centre = exact(sphere_b_.centre) - nearby(sphere_b_.centre);
  PreciseInterval spread{Real(0.0)};
  for (std::size_t j = 0; j < 3; ++j)
    spread = spread + length<Real>(PreciseVector(exact.rotation.column(j) - nearby.rotation.column(j)));
  return up(length<Real>(at_centre) + spread * sphere_b_.radius);
}

bool SearchedMoments::is_in_b(const Point& x, const RigidMotion& exact) const {
  const PreciseVector place = exact.local_point(x);
  Cube cube{rounded(midpoint(place)), 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval off = abs(place[i] - PreciseInterval(Real(cube.centre[i])));
    cube.half_width = std::max(cube.half_width, up(off));
  }
  const SearchSolid& solid = search_.solid_b();
  return std::ranges::any_of(solid.parts,
                             [&](const SearchSolid::Part& part) { return strictly_inside(solid, part.set, cube); });
}

Moment SearchedMoments::examine(const Stretch& stretch, double enough) const {
  const double time = stretch.middle();
  const RigidMotion exact = path_->enclosed_pose(time);
  const Pose pose = path_->rounded_pose(time);
  const double off = displacement(exact, RigidMotion(pose));
  const ShortMotion motion(exact, path_->motion_of(stretch.leg), stretch.reach());
  const PreciseInterval lost = change(motion) + PreciseInterval(Real(off));
  const auto over_stretch = [&](const PreciseInterval& at_moment) {
    return (at_moment - lost).lower().to_double(Direction::down);
  };
  const PreciseInterval apart = length<Real>(PreciseVector(exact(sphere_b_.centre) - sphere_a_.centre));
  const double by_balls = over_stretch(apart - sphere_a_.radius - sphere_b_.radius);
  if (by_balls > enough) return {time, by_balls, infinity};

  bool far = false;
  // Where it is asked whether they are apart at all, as fine as the stretch is short.
  const double finest = enough > 0.0 ? tolerance_ : 0.0;
  SearchOptions options{.tolerance = std::max(0.25 * finest, share_of_change * up(lost))};
  options.progress = [&](const Enclosure& distance, std::uint64_t) {
    far = over_stretch(PreciseInterval(Real(distance.lo))) > enough;
  };
  options.interrupted = [&] { return far || (interrupted_ && interrupted_()); };
  const SearchedDistance found = search_(pose, options);
  if (found.common && is_in_b(*found.common, exact)) return {time, 0.0, 0.0};
  double lower = std::max(by_balls, over_stretch(PreciseInterval(Real(found.distance.lo))));
  if (lower < std::min(enough, found.distance.lo)) {
    options.progress = {};
    const PairCertificate planes = search_.planes(pose, found, options);
    lower = std::max(lower, pair_.lower(motion, planes));
  }
  return {time, lower, up(PreciseInterval(Real(found.distance.hi)) + PreciseInterval(Real(off)))};
}

}  // namespace verisq::verify
