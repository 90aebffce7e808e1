/// This file implements proven_surface.hpp.
#include "verify/proof/proven_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

PatchDistance distance_from(const Patch& patch, const TriangleTree& triangles, double enough) {
  const TriangleTree::Nearest nearest = triangles.nearest(patch.sample);
  // The distance is 1-Lipschitz. Rounded up: sums of nonnegative terms.
  const double by_ball = add(nearest.distance.hi, patch.radius, Direction::up);
  if (by_ball <= enough) return {by_ball, nearest.distance};
  const double inner = subtract(enough, patch.thickness, Direction::down);
  double farthest = 0.0;
  for (const Triangle& half : patch.halves()) {
    farthest = std::max(farthest, farthest_of_polygon(half, triangles, nearest.triangle, inner));
  }
  return {std::min(by_ball, add(farthest, patch.thickness, Direction::up)), nearest.distance};
}

namespace {

/// A single nearest triangle is used if it is nearer than so many radii of the piece; elsewhere distances alone are
/// enough.
constexpr double thin_in_radii = 4.0;

PieceDistances on_half(const Triangle& half, const std::array<Enclosure, 3>& at_corners,
                       const TriangleTree& triangles) {
  const double off = displacement(half);
  const PieceShape shape = shape_of(half, off);
  const Point middle = centre(half);
  const TriangleTree::Nearest nearest = triangles.nearest(middle);
  TrianglePiece piece{.corners = half, .triangle = 0, .at_corners = at_corners};
  piece.at_centre = widened(nearest.distance, off);
  // If one triangle alone is near, the distance is the distance to a convex set. Another triangle is no nearer to any
  // point of the piece than the first, if it is farther from the middle than the first by two radii.
  if (nearest.distance.hi < thin_in_radii * shape.radius) {
    const double reach =
        add(add(piece.at_centre.hi, off, Direction::up), multiply(2.0, shape.radius, Direction::up), Direction::up);
    piece.convex = triangles.alone(middle, reach, nearest.triangle);
  }
  return distances_on(piece, shape);
}

/// Distances that are off by no more.
Enclosure beyond(const Enclosure& distances, double off) {
  return {std::max(0.0, subtract(distances.lo, off, Direction::down)), add(distances.hi, off, Direction::up)};
}

}  // namespace

WeightedCell weighted_patch(const Patch& patch, const PatchArea& area, const TriangleTree& triangles,
                            const Enclosure& known) {
  std::array<Enclosure, 4> at_corners{};
  for (std::size_t i = 0; i < 4; ++i) at_corners[i] = triangles.nearest(patch.corners[i]).distance;
  const auto [first, second] = patch.halves();
  const PieceDistances one = on_half(first, {at_corners[0], at_corners[1], at_corners[3]}, triangles);
  const PieceDistances other = on_half(second, {at_corners[0], at_corners[2], at_corners[3]}, triangles);
  const Enclosure flat{std::min(one.range.lo, other.range.lo), std::max(one.range.hi, other.range.hi)};
  const auto what = [] { return "distances on a patch"; };
  // If sizes leave binary64, nothing is known: NaN would be taken for a contradiction.
  if (!(patch.thickness < infinity) || !(flat.hi < infinity)) return {area.area, known, known};
  WeightedCell cell{area.area, intersection(known, beyond(flat, patch.thickness), what), {}};
  cell.mean = cell.range;

  // With shares distributed evenly the mean is the mean of both halves. With the patch's density it is off by the
  // covariance, at most a quarter of the product of both ranges (Grüss).
  const double width = subtract(cell.range.hi, cell.range.lo, Direction::up);
  const double off = add(area.correspondence,
                         multiply(0.25, multiply(area.unevenness, width, Direction::up), Direction::up), Direction::up);
  if (!(off < width) || !(one.mean.hi < infinity) || !(other.mean.hi < infinity)) return cell;
  const Enclosure even{0.5 * add(one.mean.lo, other.mean.lo, Direction::down),
                       0.5 * add(one.mean.hi, other.mean.hi, Direction::up)};
  cell.mean = intersection(cell.range, beyond(even, off), what);
  return cell;
}

/// Without an area from below the patch may reach into others that count all of theirs (PatchedSurface::area).
WeightedCell on_boundary(WeightedCell patch, bool whole, double largest) {
  if (!whole) patch.weight.lo = 0.0;
  if (!(patch.weight.lo > 0.0)) patch.mean = patch.range;
  for (Enclosure* const e : {&patch.range, &patch.mean}) e->hi = std::min(e->hi, largest);
  return patch;
}

ProvenSamples::ProvenSamples(const Model& model)
    : model_(model),
      checker_(model),
      primitives_(has_mesh(model) ? std::nullopt : std::optional<ExactChecker>(model)),
      is_union_(verify::is_union(model)),
      convex_(is_one_convex_primitive(model)) {}

Enclosure ProvenSamples::distance(const Point& x, const CertifiedEnclosure& claimed, bool& proved,
                                  const Hook& interrupted) const {
  const Finding finding = checker_(x, claimed.distance, claimed.certificate, interrupted);
  proved = finding.verdict == Verdict::proved;
  return proved ? claimed.distance : finding.proven;
}

/// The others are farther, by spheres and normals.
bool ProvenSamples::is_one_convex(const Point& x, double reach, const Certificate& certificate) const {
  if (!is_union_ || !primitives_ || !std::isfinite(reach)) return false;
  std::size_t near = 0;
  bool convex_one = false;
  const std::span<const PosedPrimitive> all = primitives_->primitives();
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    double lower = std::visit([&](const auto& solid) { return solid.lower_by_sphere(x); }, all[i]);
    for (const auto& [primitive, v] : certificate.normals) {
      if (primitive == i) lower = std::max(lower, lower_by_normal(all[i], x, {v[0], v[1], v[2]}));
    }
    if (lower >= reach) continue;
    ++near;
    convex_one = std::holds_alternative<PosedSuperquadric>(all[i]);
  }
  return near == 1 && convex_one;
}

bool ProvenSamples::are_others_away(const Point& x, double reach, std::size_t primitive, const Certificate& certificate,
                                    const Hook& interrupted) const {
  if (!primitives_ || !std::isfinite(reach)) return false;
  const double beyond = std::nextafter(reach, infinity);  // the ball lies in the interior
  const std::span<const PosedPrimitive> all = primitives_->primitives();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == primitive || std::visit([&](const auto& solid) { return solid.lower_by_sphere(x); }, all[i]) > reach)
      continue;
    const bool is_away = std::ranges::any_of(certificate.normals, [&](const Normal& normal) {
      const Proposal v{normal.vector[0], normal.vector[1], normal.vector[2]};
      if (normal.primitive != i) return false;
      if (lower_by_normal(all[i], x, v) > reach) return true;
      return !is_union_ &&
             std::visit([&](const auto& solid) { return solid.contains_ball_about(x, beyond, v, interrupted); },
                        all[i]);
    });
    if (!is_away) return false;
  }
  return true;
}

Enclosure SampleTally::operator()(const Point& x, const CertifiedEnclosure& claimed) {
  bool proved = false;
  const Enclosure found = samples_.distance(x, claimed, proved, interrupted_);
  ++looked_at_;
  if (!proved) ++unproved_;
  return found;
}

SampleProofs SampleTally::proofs() {
  return {[this](const Point& x, const CertifiedEnclosure& claimed) { return (*this)(x, claimed); },
          [this](const Point& x, double reach, const Certificate& of) { return samples_.is_one_convex(x, reach, of); },
          samples_.convex()};
}

namespace {

constexpr std::size_t by_nothing = static_cast<std::size_t>(-1);

/// A patch, and the points that are said to prove it on the boundary, or off it.
struct ToldPatch {
  PatchCell cell;
  std::size_t on = by_nothing;
  std::size_t off = by_nothing;
};

/// Makes the patches that a cover names: the octants cover the surface, and the halves cover each halved patch.
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
  /// For each point that is said to prove a patch on the boundary: that patch.
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

/// If numbers leave binary64, nothing is proven.
template <class Proof>
bool is_proven(const Proof& proof) try {
  return proof();
} catch (const std::domain_error&) {  // of an interval without numbers, where its ends overflow
  return false;
}

}  // namespace

/// |sd(x)| is the distance of x from the boundary: the ball of this radius about x contains no point of the boundary,
/// and the patch lies in a smaller ball.
bool is_off_boundary(const Patch& patch, const Point& x, const Enclosure& signed_distance) {
  return magnitude(signed_distance).lo > patch.radius_about(x);
}

/// Consider a ball about x that contains the patch and no point of other primitives' surfaces. In the ball the solid is
/// this primitive, its complement, everything or nothing. In a union whose other primitives are outside of the ball it
/// is the primitive. Elsewhere a boundary point in the ball leaves the primitive and its complement, whose boundary is
/// the same.
bool is_on_boundary(const Patch& patch, std::size_t primitive, const CertifiedPoint& by, const ProvenSamples& samples,
                    const ProvenSignedDistance& distance, const Hook& interrupted) {
  if (!is_finite(by.point)) return false;
  const double radius = patch.radius_about(by.point);
  if (!samples.are_others_away(by.point, radius, primitive, by.signed_distance.certificate, interrupted)) return false;
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
    is_on[i] = static_cast<std::uint8_t>(is_proven([&] {
      return is_on_boundary(patch_of(cell), cell.primitive, cover.on[i], samples, distance, steps.interrupted());
    }));
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

namespace {

/// The largest distance of the boundary, whichever part of it lies on the patch. Infinite if numbers leave binary64.
double farthest_of_patch(const CoveredSurface& surface, const PlacedPatch& placed, const TriangleTree& tree,
                         double enough) try {
  if (placed.place == PatchPlace::off) return 0.0;
  const double farthest = distance_from(surface.surface_of(placed.cell).patch(placed.cell), tree, enough).farthest;
  return farthest >= 0.0 ? farthest : infinity;  // NaN is no bound
} catch (const std::domain_error&) {             // of an interval without numbers, where its ends overflow
  return infinity;
}

/// The lower bound from all triangles, one by one: no tree needs to be trusted.
double distance_down(const Point& x, const std::vector<Triangle>& triangles) {
  double least = infinity;
  for (const Triangle& triangle : triangles) least = std::min(least, distance_from_triangle(x, triangle).lo);
  return least;
}

/// A point of the boundary lies within |sd(x)| of x, and the distance from the triangles is 1-Lipschitz.
double lower_end(const CertifiedPoint& farthest, const std::vector<Triangle>& triangles,
                 const ProvenSignedDistance& distance) {
  if (!is_finite(farthest.point)) return 0.0;
  const Enclosure from_boundary = magnitude(distance(farthest.point, farthest.signed_distance));
  return std::max(0.0, subtract(distance_down(farthest.point, triangles), from_boundary.hi, Direction::down));
}

/// The boundary is part of the primitives' surfaces, which the patches cover. `within` only widens: the proof does not
/// depend on the rounding of bounds below it.
double upper_end(const CoveredSurface& surface, const TriangleTree& tree, double within, CheckSteps& steps) {
  std::vector<double> bounds(surface.patches.size(), infinity);
  steps.each(bounds.size(),
             [&](std::size_t i) { bounds[i] = farthest_of_patch(surface, surface.patches[i], tree, within); });
  double upper = std::isnan(within) ? 0.0 : std::max(0.0, within);
  for (const double bound : bounds) upper = std::max(upper, bound);
  return upper;
}

/// Nothing if the cell is not known to be finite.
std::optional<WeightedCell> cell_of(const CoveredSurface& surface, const PlacedPatch& placed, const TriangleTree& tree,
                                    double largest) try {
  const PatchedSurface& of = surface.surface_of(placed.cell);
  const WeightedCell cell = on_boundary(weighted_patch(of.patch(placed.cell), of.area(placed.cell), tree),
                                        placed.place == PatchPlace::on, largest);
  const bool is_known = std::isfinite(cell.weight.hi) && cell.weight.lo >= 0.0 && cell.range.lo >= 0.0 &&
                        cell.range.hi >= 0.0 && cell.mean.lo >= 0.0 && cell.mean.hi >= 0.0;  // no NaN
  return is_known ? std::optional(cell) : std::nullopt;
} catch (const std::domain_error&) {  // of an interval without numbers, where its ends overflow
  return std::nullopt;
}

AreaStatistics statistics_of(const CoveredSurface& surface, const TriangleTree& tree, double largest,
                             std::span<const double> percentiles, CheckSteps& steps) {
  AreaStatistics result;
  result.percentiles.resize(percentiles.size(), {0.0, infinity});
  const auto cells = boundary_cells(surface, tree, largest, steps);
  if (!cells) return result;
  result.mean = mean_of(*cells);
  const Distribution distribution(*cells);
  std::ranges::transform(percentiles, result.percentiles.begin(),
                         [&](double percent) { return distribution.percentile(percent); });
  return result;
}

}  // namespace

/// A patch that is farther than any point of the boundary contains no part of it.
std::optional<std::vector<WeightedCell>> boundary_cells(const CoveredSurface& surface, const TriangleTree& tree,
                                                        double largest, CheckSteps& steps) {
  std::vector<std::optional<WeightedCell>> cells(surface.patches.size());
  steps.each(cells.size(), [&](std::size_t i) {
    if (surface.patches[i].place != PatchPlace::off) cells[i] = cell_of(surface, surface.patches[i], tree, largest);
  });
  std::vector<WeightedCell> known;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (surface.patches[i].place == PatchPlace::off) continue;
    if (!cells[i]) return std::nullopt;
    if (cells[i]->range.lo <= largest) known.push_back(*cells[i]);
  }
  return known.empty() ? std::nullopt : std::optional(std::move(known));
}

std::size_t parts_of(const SurfaceProof& proof) {
  return 1 + 3 * parts_of(proof.cover);  // the farthest point; where patches lie, how far, how far in the mean
}

ProvenSurface proven_surface(const std::vector<Triangle>& triangles, const SurfaceProof& proof,
                             const DeviationChecker::Options& options, const ProvenSamples& samples,
                             const ProvenSignedDistance& distance, CheckSteps& steps) {
  ProvenSurface result;
  if (options.statistics_of_model) result.statistics.percentiles.resize(options.percentiles.size(), {0.0, infinity});
  steps.each(1, [&](std::size_t) { result.largest.lo = lower_end(proof.farthest, triangles, distance); });
  const std::optional<CoveredSurface> surface = covered_surface(proof.cover, {}, samples, distance, steps);
  if (!surface) return result;
  const TriangleTree tree(triangles);
  result.largest = between(result.largest.lo, upper_end(*surface, tree, proof.within, steps),
                           [] { return "the distance of the model's surface"; });
  if (options.statistics_of_model)
    result.statistics = statistics_of(*surface, tree, result.largest.hi, options.percentiles, steps);
  return result;
}

}  // namespace verisq::verify
