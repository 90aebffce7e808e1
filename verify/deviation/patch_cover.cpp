/// Follows the halvings of the patches; what a point proves of a patch holds of its halves, too.
#include "verify/deviation/patch_cover.hpp"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>

#include "verify/analysis/finite_point.hpp"
#include "verify/deviation/triangle_piece.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t by_nothing = static_cast<std::size_t>(-1);

/// A patch, and by which of the points it is said to lie on the boundary, or off it.
struct ToldPatch {
  PatchCell cell;
  std::size_t on = by_nothing;
  std::size_t off = by_nothing;
};

/// Makes the patches that a cover names: the octants cover the surface, and halves what is halved.
class Walk {
 public:
  Walk(const Model& model, const SurfaceCover& cover) : cover_(cover) {
    for (std::uint32_t k = 0; k < model.primitives.size(); ++k) surfaces_.emplace_back(model.primitives[k], k);
  }

  /// False where the patches are not proven to cover the surfaces, or points are missing.
  [[nodiscard]] bool follow(const std::vector<bool>& counted) {
    if (cover_.patches.size() != surfaces_.size() || (!counted.empty() && counted.size() != surfaces_.size()))
      return false;
    std::size_t letters = 0;
    for (const std::vector<PatchProof>& patches : cover_.patches) letters += patches.size();
    if (letters >= most_patches) return false;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      const bool is_counted = counted.empty() || counted[k];
      if (is_counted ? !follow(surfaces_[k], cover_.patches[k]) : !cover_.patches[k].empty()) return false;
    }
    return true;
  }

  [[nodiscard]] const std::vector<PatchedSurface>& surfaces() const { return surfaces_; }
  [[nodiscard]] std::vector<PatchedSurface> take_surfaces() { return std::move(surfaces_); }
  [[nodiscard]] std::span<const ToldPatch> leaves() const { return leaves_; }
  /// Of each point that is said to prove a patch on the boundary.
  [[nodiscard]] std::span<const PatchCell> on() const { return on_; }

 private:
  [[nodiscard]] bool follow(PatchedSurface& surface, std::span<const PatchProof> steps) {
    std::vector<ToldPatch> open;
    for (const PatchCell& octant : surface.octants()) open.push_back({octant});
    std::ranges::reverse(open);
    for (const PatchProof step : steps) {
      if (open.empty()) return false;
      ToldPatch patch = open.back();
      surface.prepare(patch.cell);
      if (step == PatchProof::on) {
        if (on_.size() == cover_.on.size()) return false;
        open.back().on = on_.size();
        on_.push_back(patch.cell);
        continue;
      }
      open.pop_back();
      if (step == PatchProof::near || step == PatchProof::off) {
        if (!add_leaf(patch, step)) return false;
        continue;
      }
      if (patch.cell.halvings == most_halvings_of_patch) return false;
      const bool is_along = step == PatchProof::halved_along;
      const auto halves = surface.halves(patch.cell, is_along ? PatchHalving::along : PatchHalving::around);
      open.insert(open.end(), {{halves[1], patch.on}, {halves[0], patch.on}});
    }
    return open.empty();
  }

  [[nodiscard]] bool add_leaf(ToldPatch patch, PatchProof step) {
    if (step == PatchProof::off) {
      if (used_ == cover_.off.size()) return false;
      patch.off = used_++;
    }
    leaves_.push_back(patch);
    return true;
  }

  const SurfaceCover& cover_;
  std::vector<PatchedSurface> surfaces_;
  std::vector<ToldPatch> leaves_;
  std::vector<PatchCell> on_;
  std::size_t used_ = 0;  // of the points off the boundary
};

/// Where numbers leave binary64 nothing is proven.
template <class Proof>
bool is_proven(const Proof& proof) try {
  return proof();
} catch (const std::domain_error&) {  // of an interval without numbers, where its ends overflow
  return false;
}

}  // namespace

/// |sd(x)| is the distance of x from the boundary: in the ball of this radius about x there is none of it, and the
/// patch lies in a smaller one.
bool is_off_boundary(const Patch& patch, const Point& x, const Enclosure& signed_distance) {
  return magnitude(signed_distance).lo > patch.radius_about(x);
}

/// In a ball about x that holds the patch, and no point of other primitives' surfaces, the solid is this primitive, its
/// complement, all or nothing. In a union where the others are outside of the ball it is the primitive; elsewhere a
/// point of the boundary in the ball leaves the primitive and its complement, whose boundary is the same.
bool is_on_boundary(const Patch& patch, std::size_t primitive, const CertifiedPoint& by, const ProvenSamples& samples,
                    const ProvenSignedDistance& distance) {
  if (!is_finite(by.point)) return false;
  const double radius = patch.radius_about(by.point);
  if (!samples.are_others_away(by.point, radius, primitive, by.signed_distance.certificate)) return false;
  return samples.is_union() || magnitude(distance(by.point, by.signed_distance)).hi < radius;
}

std::optional<CoveredSurface> covered_surface(const SurfaceCover& cover, const std::vector<bool>& counted,
                                              const ProvenSamples& samples, const ProvenSignedDistance& distance,
                                              CheckSteps& steps) {
  Walk walk(samples.model(), cover);
  if (!walk.follow(counted)) return std::nullopt;
  const auto patch_of = [&](const PatchCell& cell) { return walk.surfaces()[cell.primitive].patch(cell); };
  std::vector<std::uint8_t> is_on(walk.on().size(), 0);
  steps.each(is_on.size(), [&](std::size_t i) {
    const PatchCell& cell = walk.on()[i];
    is_on[i] = static_cast<std::uint8_t>(
        is_proven([&] { return is_on_boundary(patch_of(cell), cell.primitive, cover.on[i], samples, distance); }));
  });
  const bool is_all_on = samples.is_union() && walk.surfaces().size() == 1;
  std::vector<PlacedPatch> patches(walk.leaves().size());
  steps.each(patches.size(), [&](std::size_t i) {
    const ToldPatch& leaf = walk.leaves()[i];
    const bool is_proven_on = is_all_on || (leaf.on != by_nothing && is_on[leaf.on] != 0);
    patches[i] = {leaf.cell, is_proven_on ? PatchPlace::on : PatchPlace::open};
    if (leaf.off == by_nothing || is_proven_on || !is_finite(cover.off[leaf.off].point)) return;
    const CertifiedPoint& by = cover.off[leaf.off];
    if (is_proven(
            [&] { return is_off_boundary(patch_of(leaf.cell), by.point, distance(by.point, by.signed_distance)); }))
      patches[i].place = PatchPlace::off;
  });
  return CoveredSurface{walk.take_surfaces(), std::move(patches)};
}

std::size_t parts_of(const SurfaceCover& cover) {
  std::size_t parts = cover.on.size();
  for (const std::vector<PatchProof>& patches : cover.patches) parts += patches.size();
  return parts;
}

}  // namespace verisq::verify
