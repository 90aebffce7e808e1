/// This file implements `PatchPlacer` and `certified_cover` of deviation.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "host/plan/deviation.hpp"
#include "host/threads/parallel.hpp"
#include "verify/proof/proven_surface.hpp"
#include "verify/proof/surface_patch.hpp"
#include "verify/solids/model.hpp"

namespace verisq {
namespace {

/// Share of a patch's radius: the width to which the distance of its middle from a boundary must be known.
constexpr double share_of_radius = 0.25;

}  // namespace

PatchPlacer::PatchPlacer(const Model& model, const SeenInterruption& interrupted)
    : distance_(model), checker_(model), samples_(model), interrupted_(interrupted) {
  for (const Primitive& primitive : model.primitives) each_.emplace_back(Model{model.units, {primitive}, {}});
}

std::optional<CertifiedPoint> PatchPlacer::off_boundary(const verify::Patch& patch, std::size_t primitive) const {
  if (!samples_.is_union()) return off_boundary_of_set(patch);
  for (std::size_t other = 0; other < each_.size(); ++other) {
    if (other == primitive) continue;
    if (auto point = inside(patch, other)) return point;
  }
  return std::nullopt;
}

std::optional<CertifiedPoint> PatchPlacer::on_boundary(const verify::Patch& patch, std::size_t primitive) const {
  CertifiedPoint by{patch.sample, {{-infinity, infinity}, {}}};
  std::vector<Normal> away;
  for (std::size_t other = 0; other < each_.size(); ++other) {
    if (other == primitive) continue;
    const auto normals = away_from(patch, other);
    if (!normals) return std::nullopt;
    away.insert(away.end(), normals->begin(), normals->end());
  }
  if (!samples_.is_union()) {
    by.signed_distance = distance_.certified(patch.sample, share_of_radius * patch.radius, hook());
  }
  std::vector<Normal>& normals = by.signed_distance.certificate.normals;
  normals.insert(normals.end(), away.begin(), away.end());
  const auto proven = [this](const Point& x, const CertifiedEnclosure& claimed) {
    bool proved = false;
    return samples_.distance(x, claimed, proved, hook());
  };
  if (!verify::is_on_boundary(patch, primitive, by, samples_, proven, hook())) return std::nullopt;
  return by;
}

/// Normals that prove its surface farther from the sample than the patch reaches; none where its sphere does.
std::optional<std::vector<Normal>> PatchPlacer::away_from(const verify::Patch& patch, std::size_t other) const {
  const Point& x = patch.sample;
  const auto by_sphere = [&](const auto& solid) { return solid.lower_by_sphere(x); };
  if (std::visit(by_sphere, checker_.primitives()[other]) > patch.radius) return std::vector<Normal>{};
  CertifiedEnclosure one = each_[other].certified(x, share_of_radius * patch.radius, hook());
  const bool is_inside = !samples_.is_union() && one.distance.hi < -patch.radius;
  if (!is_inside && !(one.distance.lo > patch.radius)) return std::nullopt;
  for (Normal& normal : one.certificate.normals) normal.primitive = static_cast<std::uint32_t>(other);
  return std::move(one.certificate.normals);
}

/// By a point inside and one outside, both at a distance of about the tolerance. Set operations have no other
/// certificate for points that lie as near to the boundary as rounding.
CertifiedEnclosure PatchPlacer::between_both_sides(const Point& x, double tolerance) const {
  CertifiedEnclosure result{{-infinity, infinity}, {}};
  constexpr std::size_t directions = 27;  // -1, 0 and 1 along each axis
  for (std::size_t n = 0; n < directions; ++n) {
    const std::array steps{n % 3, n / 3 % 3, n / 9};
    Point p = x;
    for (std::size_t i = 0; i < 3; ++i) p[i] += tolerance * (static_cast<double>(steps[i]) - 1.0) / std::sqrt(3.0);
    Certificate by_point;
    by_point.escape = p;
    by_point.witness = p;
    const auto [lo, hi] = checker_(x, {-2.0 * tolerance, 2.0 * tolerance}, by_point);
    if (lo > result.distance.lo) std::tie(result.distance.lo, result.certificate.escape) = std::tie(lo, p);
    if (hi < result.distance.hi) std::tie(result.distance.hi, result.certificate.witness) = std::tie(hi, p);
  }
  return result;
}

CertifiedPoint PatchPlacer::near_boundary(const Point& x, double tolerance) const {
  CertifiedPoint point{x, distance_.certified(x, tolerance, hook())};
  const Enclosure& distance = point.signed_distance.distance;
  if (!std::isfinite(distance.lo) || !std::isfinite(distance.hi))
    point.signed_distance = between_both_sides(x, tolerance);
  return point;
}

/// In a union: by a ball within another primitive; it is proven sooner than a ball in the union of all of them.
std::optional<CertifiedPoint> PatchPlacer::inside(const verify::Patch& patch, std::size_t other) const {
  const Point& x = patch.sample;
  if (!std::visit([&](const auto& solid) { return solid.contains(x); }, checker_.primitives()[other])) {
    return std::nullopt;
  }
  CertifiedEnclosure within = each_[other].certified(x, share_of_radius * patch.radius, hook());
  if (!(within.distance.hi < -patch.radius)) return std::nullopt;
  // A smaller ball than the largest takes less to be proven.
  const double depth =
      within.certificate.cover.empty() ? 0.5 * (patch.radius - within.distance.hi) : -within.distance.hi;
  within.distance = {-infinity, -depth};
  within.certificate.escape.reset();
  for (Normal& normal : within.certificate.normals) normal.primitive = static_cast<std::uint32_t>(other);
  return proven_off(patch, {x, std::move(within)});
}

std::optional<CertifiedPoint> PatchPlacer::off_boundary_of_set(const verify::Patch& patch) const {
  const double tolerance = share_of_radius * patch.radius;
  const Enclosure distance = distance_(patch.sample, tolerance, hook());
  if (!verify::is_off_boundary(patch, patch.sample, distance)) return std::nullopt;
  return proven_off(patch, {patch.sample, distance_.certified(patch.sample, tolerance, hook())});
}

std::optional<CertifiedPoint> PatchPlacer::proven_off(const verify::Patch& patch, CertifiedPoint point) const {
  const auto& [claimed, certificate] = point.signed_distance;
  if (!verify::is_off_boundary(patch, point.point, checker_(point.point, claimed, certificate, hook())))
    return std::nullopt;
  return point;
}

namespace {

using verify::PatchCell;
using verify::PatchedSurface;
using verify::PatchHalving;
using verify::PatchPlace;
using verify::WeightedCell;

constexpr std::size_t patches_at_a_time = 256;
constexpr std::size_t octants = 8;

struct Node {
  PatchCell cell;
  PatchPlace place = PatchPlace::open;
  std::optional<PatchHalving> halving = {};
  std::uint32_t first_half = 0;           ///< of two halves that follow each other, if it is halved
  std::optional<CertifiedPoint> by = {};  ///< proves its place, unless the proof of a larger patch does
  WeightedCell weighted = {{}, {}, {}};   ///< for a patch that is neither halved nor off
};

class CoverProver {
 public:
  explicit CoverProver(const CoverRequest& request)
      : request_(request), is_all_on_(request.model.primitives.size() == 1 && verify::is_union(request.model)) {
    for (std::uint32_t k = 0; k < request.model.primitives.size(); ++k)
      surfaces_.emplace_back(request.model.primitives[k], k);
  }

  SurfaceCover operator()(SurfaceCover begun) {
    begin(std::move(begun));
    // A generation may double the size.
    while (!request_.interrupted() && 2 * bytes_ < request_.bytes && 2 * nodes_.size() < most_patches) {
      const std::vector<std::uint32_t> chosen = choose();
      if (chosen.empty()) break;
      halve(chosen);
    }
    return cover();
  }

 private:
  /// The nodes of the cover that there is, then where they lie, larger ones first.
  void begin(SurfaceCover begun) {
    std::vector<std::uint32_t> generation;
    std::size_t used = 0;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      if (begun.patches[k].empty()) continue;
      const auto first = static_cast<std::uint32_t>(nodes_.size());
      for (const PatchCell& octant : surfaces_[k].octants()) {
        generation.push_back(static_cast<std::uint32_t>(nodes_.size()));
        nodes_.push_back({.cell = octant});
      }
      roots_.emplace_back(k, first);
      follow(begun.patches[k], first, begun.off, used);
    }
    while (!generation.empty() && !request_.interrupted()) {
      place(generation);
      generation = halves_of(generation);
    }
  }

  void follow(std::span<const PatchProof> steps, std::uint32_t first_octant, std::vector<CertifiedPoint>& off,
              std::size_t& used) {
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = octants; i > 0; --i) open.push_back(first_octant + i - 1);
    for (const PatchProof step : steps) {
      const std::uint32_t n = open.back();
      open.pop_back();
      surfaces_[nodes_[n].cell.primitive].prepare(nodes_[n].cell);
      if (step == PatchProof::off) {
        nodes_[n].place = PatchPlace::off;
        nodes_[n].by = std::move(off[used++]);
      }
      if (step == PatchProof::near || step == PatchProof::off) continue;
      add_halves(n, step == PatchProof::halved_along ? PatchHalving::along : PatchHalving::around);
      open.insert(open.end(), {nodes_[n].first_half + 1, nodes_[n].first_half});
    }
  }

  void add_halves(std::uint32_t n, PatchHalving halving) {
    const auto halves = surfaces_[nodes_[n].cell.primitive].halves(nodes_[n].cell, halving);
    nodes_[n].halving = halving;
    nodes_[n].first_half = static_cast<std::uint32_t>(nodes_.size());
    const PatchPlace inherited = nodes_[n].place;
    for (const PatchCell& half : halves) nodes_.push_back({.cell = half, .place = inherited});
    bytes_ += halves.size();
  }

  [[nodiscard]] std::vector<std::uint32_t> halves_of(const std::vector<std::uint32_t>& generation) {
    std::vector<std::uint32_t> halves;
    for (const std::uint32_t n : generation) {
      if (!nodes_[n].halving) continue;
      for (std::uint32_t i = 0; i < 2; ++i) {
        Node& half = nodes_[nodes_[n].first_half + i];
        if (nodes_[n].place == PatchPlace::on) half.place = PatchPlace::on;
        halves.push_back(nodes_[n].first_half + i);
      }
    }
    return halves;
  }

  /// Determines the places and the distances of the patches.
  void place(const std::vector<std::uint32_t>& generation) {
    for (const std::uint32_t n : generation) surfaces_[nodes_[n].cell.primitive].prepare(nodes_[n].cell);
    in_parallel_steps(
        generation.size(), patches_at_a_time, request_.interrupted, [](double) {},
        [&](std::size_t i) { place(nodes_[generation[i]]); });
    for (const std::uint32_t n : generation) bytes_ += nodes_[n].by ? size_of(*nodes_[n].by) : 0;
  }

  void place(Node& node) const {
    if (node.place == PatchPlace::off) return;
    const PatchedSurface& surface = surfaces_[node.cell.primitive];
    const verify::Patch patch = surface.patch(node.cell);
    if (is_all_on_) node.place = PatchPlace::on;
    if (node.place == PatchPlace::open && !node.halving) {
      node.by = request_.placer.off_boundary(patch, node.cell.primitive);
      if (node.by) node.place = PatchPlace::off;
    }
    if (node.place == PatchPlace::open) {
      node.by = request_.placer.on_boundary(patch, node.cell.primitive);
      if (node.by) node.place = PatchPlace::on;
    }
    if (node.halving || node.place == PatchPlace::off) return;
    node.weighted = on_boundary(weighted_patch(patch, surface.area(node.cell), request_.triangles),
                                node.place == PatchPlace::on, request_.largest);
  }

  [[nodiscard]] std::vector<std::uint32_t> choose() const {
    std::vector<std::uint32_t> leaves;
    std::vector<WeightedCell> cells;
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      const Node& node = nodes_[n];
      if (node.halving || node.place == PatchPlace::off || node.weighted.range.lo > request_.largest) continue;
      leaves.push_back(n);
      cells.push_back(node.weighted);
    }
    if (cells.empty()) return {};
    std::vector<bool> chosen(cells.size(), false);
    request_.choose(cells, chosen);
    std::vector<std::uint32_t> indices;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const PatchCell& cell = nodes_[leaves[i]].cell;
      if (chosen[i] && surfaces_[cell.primitive].halving(cell)) indices.push_back(leaves[i]);
    }
    return indices;
  }

  void halve(const std::vector<std::uint32_t>& chosen) {
    for (const std::uint32_t n : chosen) {
      const PatchCell& cell = nodes_[n].cell;
      add_halves(n, *surfaces_[cell.primitive].halving(cell));
    }
    place(halves_of(chosen));
  }

  /// The cover in preorder.
  [[nodiscard]] SurfaceCover cover() {
    SurfaceCover cover;
    cover.patches.resize(surfaces_.size());
    for (const auto& [primitive, first] : roots_) {
      std::vector<PatchProof>& patches = cover.patches[primitive];
      std::vector<std::uint32_t> open;
      for (std::uint32_t i = octants; i > 0; --i) open.push_back(first + i - 1);
      while (!open.empty()) {
        Node& node = nodes_[open.back()];
        open.pop_back();
        append(node, patches, cover);
        if (node.halving) open.insert(open.end(), {node.first_half + 1, node.first_half});
      }
    }
    return cover;
  }

  static void append(Node& node, std::vector<PatchProof>& patches, SurfaceCover& cover) {
    if (node.by && node.place == PatchPlace::on) {
      patches.push_back(PatchProof::on);
      cover.on.push_back(*std::move(node.by));
    }
    if (node.halving) {
      patches.push_back(*node.halving == PatchHalving::along ? PatchProof::halved_along : PatchProof::halved_around);
    } else if (node.by && node.place == PatchPlace::off) {
      patches.push_back(PatchProof::off);
      cover.off.push_back(*std::move(node.by));
    } else {
      patches.push_back(PatchProof::near);
    }
  }

  const CoverRequest& request_;
  bool is_all_on_;
  std::vector<PatchedSurface> surfaces_;                      // one a primitive
  std::vector<std::pair<std::size_t, std::uint32_t>> roots_;  // of a primitive its first octant
  std::vector<Node> nodes_;
  std::size_t bytes_ = 0;  // of the file, about
};

}  // namespace

SurfaceCover certified_cover(const CoverRequest& request, SurfaceCover begun) {
  return CoverProver(request)(std::move(begun));
}

SurfaceCover octants_of(const Model& model, const std::vector<bool>& counted) {
  SurfaceCover cover;
  cover.patches.resize(model.primitives.size());
  for (std::size_t k = 0; k < cover.patches.size(); ++k) {
    if (counted.empty() || counted[k]) cover.patches[k].assign(octants, PatchProof::near);
  }
  return cover;
}

}  // namespace verisq
