/// Halves the patches of each octant until all are near enough, or no part of the model's boundary.
#include "host/deviation/certified_surface.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "host/deviation/allowed_width.hpp"
#include "host/deviation/sample_size.hpp"
#include "host/threads/parallel_steps.hpp"
#include "verify/deviation/patch_distance.hpp"
#include "verify/deviation/proven_surface.hpp"
#include "verify/deviation/surface_patch.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

constexpr std::size_t octants = 8;
/// Of how far patches may lie from the mesh: what other checkers, which round otherwise, may need more.
constexpr double room = 0x1p-30;
/// Of a patch's radius: how well the distance of its middle from the boundary has to be known.
constexpr double share_of_radius = 0.25;

struct OctantProof {
  std::vector<PatchProof> patches;
  std::vector<CertifiedPoint> off;
};

class SurfaceProver {
 public:
  /// `interrupted` must outlive this.
  SurfaceProver(const Model& model, const Mesh& mesh, double enough, double tolerance, std::size_t bytes,
                const SeenInterruption& interrupted)
      : primitives_(model.primitives),
        tree_(verify::triangles_of(mesh)),
        distance_(model),
        checker_(model),
        enough_(enough),
        tolerance_(tolerance),
        bytes_(bytes),
        interrupted_(interrupted) {
    if (!verify::is_union(model)) return;
    for (const Primitive& primitive : model.primitives) each_.emplace_back(Model{model.units, {primitive}, {}});
  }

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

  /// Of a point near the boundary.
  [[nodiscard]] CertifiedPoint near_boundary(const Point& x) const {
    CertifiedPoint point{x, distance_.certified(x, tolerance_, [this] { return interrupted_(); })};
    const Enclosure& distance = point.signed_distance.distance;
    if (!std::isfinite(distance.lo) || !std::isfinite(distance.hi)) point.signed_distance = between_both_sides(x);
    return point;
  }

 private:
  /// By a point inside and one outside, both at a distance of about the tolerance. Set operations have no other
  /// certificate of points as near to the boundary as rounding is.
  [[nodiscard]] CertifiedEnclosure between_both_sides(const Point& x) const {
    CertifiedEnclosure result{{-infinity, infinity}, {}};
    constexpr std::size_t directions = 27;  // -1, 0 and 1 along each axis
    for (std::size_t n = 0; n < directions; ++n) {
      const std::array steps{n % 3, n / 3 % 3, n / 9};
      Point p = x;
      for (std::size_t i = 0; i < 3; ++i) p[i] += tolerance_ * (static_cast<double>(steps[i]) - 1.0) / std::sqrt(3.0);
      Certificate by_point;
      by_point.escape = p;
      by_point.witness = p;
      const auto [lo, hi] = checker_(x, {-2.0 * tolerance_, 2.0 * tolerance_}, by_point);
      if (lo > result.distance.lo) std::tie(result.distance.lo, result.certificate.escape) = std::tie(lo, p);
      if (hi < result.distance.hi) std::tie(result.distance.hi, result.certificate.witness) = std::tie(hi, p);
    }
    return result;
  }

  /// Adds what becomes of the patch, or says how it is halved.
  [[nodiscard]] std::optional<verify::PatchHalving> prove(const verify::PatchedSurface& surface,
                                                          const verify::PatchCell& cell, OctantProof& proof) {
    const verify::Patch patch = surface.patch(cell);
    const bool is_near = verify::distance_from(patch, tree_, enough_).farthest <= enough_;
    std::optional<CertifiedPoint> off = is_near ? std::nullopt : off_boundary(patch, cell.primitive);
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

  /// What proves that no part of the patch is part of the boundary.
  [[nodiscard]] std::optional<CertifiedPoint> off_boundary(const verify::Patch& patch, std::size_t primitive) const {
    if (each_.empty()) return off_boundary_of_set(patch);
    for (std::size_t other = 0; other < each_.size(); ++other) {
      if (other == primitive) continue;
      if (auto point = inside(patch, other)) return point;
    }
    return std::nullopt;
  }

  /// In a union what lies within another primitive; a ball in that is proven sooner than one in all of them together.
  [[nodiscard]] std::optional<CertifiedPoint> inside(const verify::Patch& patch, std::size_t other) const {
    const Point& x = patch.sample;
    if (!std::visit([&](const auto& solid) { return solid.contains(x); }, checker_.primitives()[other])) {
      return std::nullopt;
    }
    CertifiedEnclosure within = each_[other].certified(x, share_of_radius * patch.radius);
    if (!(within.distance.hi < -patch.radius)) return std::nullopt;
    // A smaller ball than the largest takes less to be proven.
    const double depth =
        within.certificate.cover.empty() ? 0.5 * (patch.radius - within.distance.hi) : -within.distance.hi;
    within.distance = {-infinity, -depth};
    within.certificate.escape.reset();
    for (Normal& normal : within.certificate.normals) normal.primitive = static_cast<std::uint32_t>(other);
    return proven_off(patch, {x, std::move(within)});
  }

  [[nodiscard]] std::optional<CertifiedPoint> off_boundary_of_set(const verify::Patch& patch) const {
    const auto interrupted = [this] { return interrupted_(); };
    const double tolerance = share_of_radius * patch.radius;
    const Enclosure distance = distance_(patch.sample, tolerance, interrupted);
    if (!verify::is_off_boundary(patch, patch.sample, distance)) return std::nullopt;
    return proven_off(patch, {patch.sample, distance_.certified(patch.sample, tolerance, interrupted)});
  }

  [[nodiscard]] std::optional<CertifiedPoint> proven_off(const verify::Patch& patch, CertifiedPoint point) const {
    const auto& [claimed, certificate] = point.signed_distance;
    if (!verify::is_off_boundary(patch, point.point, checker_(point.point, claimed, certificate))) return std::nullopt;
    return point;
  }

  std::span<const Primitive> primitives_;
  verify::TriangleTree tree_;
  SignedDistance distance_;
  std::vector<SignedDistance> each_;  ///< of a union
  verify::ExactChecker checker_;
  double enough_;
  double tolerance_;
  std::size_t bytes_;
  std::atomic<std::size_t> used_{0};  ///< bytes
  std::atomic<std::size_t> patches_{0};
  const SeenInterruption& interrupted_;
};

/// Of each primitive its octants, one after the other.
SurfaceProof joined(std::vector<OctantProof> proofs) {
  SurfaceProof proof;
  proof.patches.resize(proofs.size() / octants);
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    std::vector<PatchProof>& patches = proof.patches[i / octants];
    patches.insert(patches.end(), proofs[i].patches.begin(), proofs[i].patches.end());
    std::ranges::move(proofs[i].off, std::back_inserter(proof.off));
  }
  return proof;
}

}  // namespace

CertifiedSurface certified_surface(const Model& model, const Mesh& mesh, const Deviation& found,
                                   const DeviationOptions& options, std::size_t bytes,
                                   const SeenInterruption& interrupted, const std::function<void(double)>& progress) {
  const DistanceStatistics& statistics = *found.from_model;
  const double allowed = allowed_width(statistics.largest.lo, options, bounding_radius(model));
  const double enough = std::max(statistics.largest.hi, statistics.largest.lo + 0.25 * allowed);
  if (!std::isfinite(enough)) return {std::nullopt, "nothing was found from above"};
  SurfaceProver prover(model, mesh, enough, share_of_samples * allowed, bytes, interrupted);
  std::vector<OctantProof> proofs(octants * model.primitives.size());
  in_parallel_steps(proofs.size(), octants, interrupted, progress,
                    [&](std::size_t i) { proofs[i] = prover(i / octants, i % octants); });
  if (interrupted()) return {};
  if (prover.is_too_large()) {
    return {std::nullopt, fmt::format("it takes more than {} patches, or than the {} bytes that there are for them",
                                      most_patches, bytes)};
  }
  SurfaceProof proof = joined(std::move(proofs));
  proof.within = enough * (1.0 + room);
  proof.farthest = prover.near_boundary(statistics.farthest);
  return {std::move(proof), {}};
}

}  // namespace verisq
