/// Pair by pair, those with the nearest spheres first.
#include "verify/sweep/convex_moments.hpp"

#include <algorithm>

#include "verify/search/candidates.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/pair_contact.hpp"

namespace verisq::verify {

Moment ConvexMoments::examine(const Stretch& stretch, double enough) const {
  const double time = stretch.middle();
  const MovingPairs moving(a_, b_, {path_->enclosed_pose(time), path_->motion_of(stretch.leg), stretch.reach()});
  const PosedPairs& pairs = moving.pairs();
  Moment moment{time, infinity, infinity};
  const auto by_spheres = [&](std::size_t k) {
    return moving.lower_by_spheres(k / pairs.size_b(), k % pairs.size_b());
  };
  for (const auto& [bound, k] : nearest_spheres_first(pairs.size_a() * pairs.size_b(), by_spheres)) {
    if (bound > enough || bound > moment.upper) {
      moment.lower = std::min(moment.lower, bound);
      break;
    }
    const std::size_t i = k / pairs.size_b();
    const std::size_t j = k % pairs.size_b();
    const PairBounds at_moment = pairs(i, j);
    const PairContact contact =
        fast_pair_contact(at_moment.a().superquadric(), at_moment.b().superquadric(), at_moment.relative());
    if (contact.common) {
      if (pairs.share(rounded(midpoint(pairs.motion_a(i)(precise(*contact.common)))))) return {time, 0.0, 0.0};
      moment.lower = std::min(moment.lower, bound);
      continue;
    }
    const Separation separation{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), rounded(contact.vector),
                                rounded(contact.on_a), rounded(contact.on_b)};
    moment.upper = std::min(moment.upper, at_moment.distance(separation).hi);
    moment.lower = std::min(moment.lower, std::max(bound, moving.lower_by_vector(i, j, separation.vector)));
  }
  return moment;
}

}  // namespace verisq::verify
