/// Halves the patches of each octant until all are near enough, or no part of the model's boundary.
#include "host/deviation/certified_surface.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "host/deviation/allowed_width.hpp"
#include "host/deviation/certified_cover.hpp"
#include "host/deviation/certified_place.hpp"
#include "host/deviation/sample_size.hpp"
#include "host/threads/parallel_steps.hpp"
#include "verify/deviation/chosen_cells.hpp"
#include "verify/deviation/patch_distance.hpp"
#include "verify/deviation/surface_patch.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/deviation/weighted_cells.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

constexpr std::size_t octants = 8;
/// Of how far patches may lie from the mesh: what other checkers, which round otherwise, may need more.
constexpr double room = 0x1p-30;

struct OctantProof {
  std::vector<PatchProof> patches;
  std::vector<CertifiedPoint> off;
};

class SurfaceProver {
 public:
  /// All must outlive this.
  SurfaceProver(const Model& model, const verify::TriangleTree& tree, const PatchPlacer& placer, double enough,
                std::size_t bytes, const SeenInterruption& interrupted)
      : primitives_(model.primitives),
        tree_(tree),
        placer_(placer),
        enough_(enough),
        bytes_(bytes),
        interrupted_(interrupted) {}

  /// Of one octant of a primitive. Cut short where it is interrupted, or takes more than so many bytes with the others.
  [[nodiscard]] OctantProof operator()(std::size_t primitive, std::size_t octant) {
    verify::PatchedSurface surface(primitives_[primitive], static_cast<std::uint32_t>(primitive));
    OctantProof proof;
    std::vector<verify::PatchCell> open{surface.octants()[octant]};
    while (!open.empty() && !interrupted_() && !is_too_large()) {
      const verify::PatchCell cell = open.back();
      open.pop_back();
      surface.prepare(cell);
      ++used_;
      ++patches_;
      const auto halving = prove(surface, cell, proof);
      if (!halving) continue;
      const bool is_along = *halving == verify::PatchHalving::along;
      proof.patches.push_back(is_along ? PatchProof::halved_along : PatchProof::halved_around);
      const auto halves = surface.halves(cell, *halving);
      open.insert(open.end(), {halves[1], halves[0]});
    }
    return proof;
  }

  [[nodiscard]] bool is_too_large() const { return used_ > bytes_ || patches_ >= most_patches; }

 private:
  /// Adds what becomes of the patch, or says how it is halved.
  [[nodiscard]] std::optional<verify::PatchHalving> prove(const verify::PatchedSurface& surface,
                                                          const verify::PatchCell& cell, OctantProof& proof) {
    const verify::Patch patch = surface.patch(cell);
    const bool is_near = verify::distance_from(patch, tree_, enough_).farthest <= enough_;
    std::optional<CertifiedPoint> off = is_near ? std::nullopt : placer_.off_boundary(patch, cell.primitive);
    if (off) {
      used_ += size_of(*off);
      proof.patches.push_back(PatchProof::off);
      proof.off.push_back(*std::move(off));
      return std::nullopt;
    }
    const auto halving = is_near ? std::nullopt : surface.halving(cell);
    if (!halving) proof.patches.push_back(PatchProof::near);
    return halving;
  }

  std::span<const Primitive> primitives_;
  const verify::TriangleTree& tree_;
  const PatchPlacer& placer_;
  double enough_;
  std::size_t bytes_;
  std::atomic<std::size_t> used_{0};  ///< bytes
  std::atomic<std::size_t> patches_{0};
  const SeenInterruption& interrupted_;
};

/// Of each primitive its octants, one after the other.
SurfaceCover joined(std::vector<OctantProof> proofs) {
  SurfaceCover cover;
  cover.patches.resize(proofs.size() / octants);
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    std::vector<PatchProof>& patches = cover.patches[i / octants];
    patches.insert(patches.end(), proofs[i].patches.begin(), proofs[i].patches.end());
    std::ranges::move(proofs[i].off, std::back_inserter(cover.off));
  }
  return cover;
}

/// Mean and percentiles no wider than they were found, or than they had to be.
CoverGoal goal_of(const DistanceStatistics& found, const DeviationOptions& options, double radius) {
  return [&found, &options, radius](std::span<const verify::WeightedCell> cells, std::vector<bool>& chosen) {
    const auto allowed = [&](const Enclosure& of) {
      return std::max(of.hi - of.lo, allowed_width(of.lo, options, radius));
    };
    verify::choose_for_mean(cells, verify::mean_of(cells), allowed(*found.mean), chosen);
    const verify::Distribution distribution(cells);
    for (std::size_t i = 0; i < options.percentiles.size(); ++i) {
      const double percent = options.percentiles[i];
      verify::choose_for_percentile(cells, distribution.percentile(percent), percent / 100.0,
                                    allowed(found.percentiles[i]), chosen);
    }
  };
}

}  // namespace

CertifiedSurface certified_surface(const Model& model, const Mesh& mesh, const Deviation& found,
                                   const DeviationOptions& options, std::size_t bytes,
                                   const SeenInterruption& interrupted, const std::function<void(double)>& progress) {
  const DistanceStatistics& statistics = *found.from_model;
  const double allowed = allowed_width(statistics.largest.lo, options, bounding_radius(model));
  const double enough = std::max(statistics.largest.hi, statistics.largest.lo + 0.25 * allowed);
  if (!std::isfinite(enough)) return {std::nullopt, "nothing was found from above"};
  const verify::TriangleTree tree(verify::triangles_of(mesh));
  const PatchPlacer placer(model, interrupted);
  SurfaceProver prover(model, tree, placer, enough, bytes, interrupted);
  std::vector<OctantProof> proofs(octants * model.primitives.size());
  in_parallel_steps(proofs.size(), octants, interrupted, progress,
                    [&](std::size_t i) { proofs[i] = prover(i / octants, i % octants); });
  if (interrupted()) return {};
  if (prover.is_too_large()) {
    return {std::nullopt, fmt::format("it takes more than {} patches, or than the {} bytes that there are for them",
                                      most_patches, bytes)};
  }
  SurfaceProof proof{.within = enough * (1.0 + room), .cover = joined(std::move(proofs)), .farthest = {}};
  proof.farthest = placer.near_boundary(statistics.farthest, share_of_samples * allowed);
  if (!statistics.mean) return {std::move(proof), {}};
  proof.cover = certified_cover({.model = model,
                                 .triangles = tree,
                                 .placer = placer,
                                 .counted = {},
                                 .largest = enough,
                                 .choose = goal_of(statistics, options, bounding_radius(model)),
                                 .bytes = bytes,
                                 .interrupted = interrupted},
                                std::move(proof.cover));
  return {std::move(proof), {}};
}

}  // namespace verisq
