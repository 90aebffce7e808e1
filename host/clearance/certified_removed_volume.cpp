/// The cubes of the search are those of the certificate; the checker says what they prove.
#include "verisq/certified_removed_volume.hpp"

#include <algorithm>

#include "verify/numbers/rounding.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq {
namespace {

/// Of the width, at each end: times and directions that the checker tries come from elementary functions, which are not
/// the same everywhere.
constexpr double share_to_spare = 0x1p-10;

Enclosure with_a_little_to_spare(const Enclosure& proven) {
  const double spare = share_to_spare * proven.width();
  return {std::max(0.0, verify::subtract(proven.lo, spare, verify::Direction::down)),
          verify::add(proven.hi, spare, verify::Direction::up)};
}

}  // namespace

CertifiedRemovedVolume certified_removed_volume(std::span<const Pose> path, const Model& implant,
                                                const BoneRegion& bone, const RemovedVolume& found,
                                                const CheckOptions& options) {
  const ProvenRemovedVolume proven = RemovedVolumeChecker(implant, path, bone)(found.divided, options);
  (void)verify::intersection(found.volume, proven.volume, [] { return "the removed volume"; });
  return {with_a_little_to_spare(proven.volume), found.divided, proven.interrupted};
}

}  // namespace verisq
