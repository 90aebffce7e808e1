/// The certified deviations of deviation.hpp.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "host/errors/refusal.hpp"
#include "host/plan/deviation.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proof/mesh_solid.hpp"
#include "verify/proof/proven_surface.hpp"
#include "verify/proof/surface_patch.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/model_distances.hpp"
#include "verify/solids/model.hpp"
#include "verisq/deviation.hpp"
#include "verisq/distance.hpp"

namespace verisq {

CertifiedSamples::CertifiedSamples(const Model& model, double tolerance)
    : model_(model), checked_(model), tolerance_(tolerance) {
  if (!verify::is_union(model) || model.primitives.size() == 1) return;
  for (const Primitive& primitive : model.primitives) {
    each_.push_back({SignedDistance(Model{model.units, {primitive}, {}}), is_bent(primitive)});
  }
}

CertifiedEnclosure CertifiedSamples::at(const Point& x, const std::function<bool()>& interrupted) const {
  return model_.certified(x, tolerance_, interrupted);
}

bool CertifiedSamples::is_one_convex(const Point& x, double reach, Certificate& certificate) const {
  if (each_.empty()) return false;
  if (checked_.is_one_convex(x, reach, certificate)) return true;
  std::vector<Normal> others;
  bool one_near = false;
  for (std::uint32_t i = 0; i < each_.size(); ++i) {
    const CertifiedEnclosure one = each_[i].distance.certified(x, tolerance_);
    if (!(one.distance.lo >= reach)) {
      if (std::exchange(one_near, true) || each_[i].bent) return false;
      continue;
    }
    for (const auto& [primitive, v] : one.certificate.normals) others.push_back({i, v});
  }
  certificate.normals.insert(certificate.normals.end(), others.begin(), others.end());
  return one_near;
}

namespace {

constexpr std::size_t octants_of_primitive = 8;
/// Share of the allowed distance of patches from the mesh: room for other checkers, which round differently.
constexpr double room_for_rounding = 0x1p-30;

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

  /// The proof for one octant of a primitive. Cut short if it is interrupted, or if all proofs together take too many
  /// bytes.
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
  /// Adds the result for the patch, or returns how to halve it.
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

/// For each primitive its octants, one after the other.
SurfaceCover joined(std::vector<OctantProof> proofs) {
  SurfaceCover cover;
  cover.patches.resize(proofs.size() / octants_of_primitive);
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    std::vector<PatchProof>& patches = cover.patches[i / octants_of_primitive];
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
  std::vector<OctantProof> proofs(octants_of_primitive * model.primitives.size());
  in_parallel_steps(proofs.size(), octants_of_primitive, interrupted, progress,
                    [&](std::size_t i) { proofs[i] = prover(i / octants_of_primitive, i % octants_of_primitive); });
  if (interrupted()) return {};
  if (prover.is_too_large()) {
    return {std::nullopt, fmt::format("it takes more than {} patches, or than the {} bytes that there are for them",
                                      most_patches, bytes)};
  }
  SurfaceProof proof{.within = enough * (1.0 + room_for_rounding), .cover = joined(std::move(proofs)), .farthest = {}};
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

namespace {

constexpr std::size_t elements_at_a_time = 1024;
constexpr std::size_t probes = 500;  // triangles that tell how much all of them take
constexpr int most_halvings_for_largest = 24;
constexpr std::size_t most_samples_of_triangle = 4096;
constexpr int most_halvings_for_mean = 4;

constexpr std::size_t bytes_of_triangle = 30;  // of a certificate file, without samples

/// The statistics of the distances from the mesh to the model.
const DistanceStatistics& statistics_of(const Deviation& found) {
  return found.from_mesh ? *found.from_mesh : found.of_vertices;
}

/// Distances to a surface. All functions may be called from many threads.
struct SampledSurface {
  std::function<CertifiedEnclosure(const Point& x)> at;
  /// As CertifiedSamples.
  std::function<bool(const Point& x, double reach, Certificate& certificate)> is_one_convex;
  bool convex;
  double tolerance;
};

SampledSurface sampled(const CertifiedSamples& samples, const SeenInterruption& interrupted) {
  return {[&](const Point& x) { return samples.at(x, [&] { return interrupted(); }); },
          [&](const Point& x, double reach, Certificate& certificate) {
            return samples.is_one_convex(x, reach, certificate);
          },
          samples.convex(), samples.tolerance()};
}

/// The required accuracy of distances.
using AllowedWidth = std::function<double(double size)>;

class DeviationProver {
 public:
  /// `statistics` were found of the mesh's triangles. `interrupted` must outlive this.
  DeviationProver(SampledSurface samples, const DistanceStatistics& statistics, const AllowedWidth& allowed,
                  const SeenInterruption& interrupted)
      : samples_(std::move(samples)),
        largest_(std::max(statistics.largest.hi, statistics.largest.lo + 0.25 * allowed(statistics.largest.lo))),
        interrupted_(interrupted) {
    if (statistics.mean) mean_width_ = 0.5 * allowed(statistics.mean->lo);
  }

  [[nodiscard]] CertifiedEnclosure at(const Point& x) const { return samples_.at(x); }

  /// Leaves out samples that only mean and percentiles need, so that about `bytes` bytes are enough. These are halvings
  /// and, if there is no room for all centroids, the centroids of triangles that hardly matter.
  void plan(const Mesh& mesh, std::span<const CertifiedEnclosure> vertices, std::size_t bytes) {
    const std::size_t count = mesh.triangles.size();
    counts_for_mean_.assign(count, true);
    if (count == 0) return;
    std::size_t used = bytes_of_triangle * count;
    for (const CertifiedEnclosure& vertex : vertices) used += size_of(vertex);
    const double left = bytes > used ? static_cast<double>(bytes - used) : 0.0;
    const double wanted = size_of_samples(mesh, vertices);
    if (wanted <= left) {
      halve_for_mean(mesh, vertices, left);
      return;
    }
    std::vector<std::pair<double, std::size_t>> widths;
    for (std::size_t n = 0; n < count; ++n) {
      const verify::TrianglePiece piece = whole(mesh, vertices, n);
      const verify::PieceShape shape = verify::shape_of(piece.corners, verify::displacement(piece.corners));
      widths.emplace_back(distances_by_corners(piece, shape).mean.width() * verify::area_of(piece.corners).hi, n);
    }
    std::ranges::sort(widths);
    const auto room = static_cast<std::size_t>(left / wanted * static_cast<double>(count));
    for (std::size_t i = 0; i < count - room; ++i) counts_for_mean_[widths[i].second] = false;
  }

  [[nodiscard]] TriangleProof operator()(const Mesh& mesh, std::span<const CertifiedEnclosure> vertices,
                                         std::size_t n) const {
    TriangleProof proof;
    const verify::TrianglePiece piece = whole(mesh, vertices, n);
    prove(piece, verify::displacement(piece.corners), proof);
    return proof;
  }

 private:
  /// Halves as often as `bytes` bytes allow.
  void halve_for_mean(const Mesh& mesh, std::span<const CertifiedEnclosure> vertices, double bytes) {
    while (halvings_for_mean_ < most_halvings_for_mean) {
      ++halvings_for_mean_;
      if (size_of_samples(mesh, vertices) <= bytes) continue;
      --halvings_for_mean_;
      return;
    }
  }

  /// The approximate size for all triangles, by some of them.
  [[nodiscard]] double size_of_samples(const Mesh& mesh, std::span<const CertifiedEnclosure> vertices) const {
    const std::size_t count = mesh.triangles.size();
    const std::size_t step = std::max<std::size_t>(1, count / probes);
    std::vector<std::size_t> sizes((count + step - 1) / step);
    in_parallel(sizes.size(), [&](std::size_t i) {
      for (const CertifiedEnclosure& sample : (*this)(mesh, vertices, i * step).samples) sizes[i] += size_of(sample);
    });
    const auto sum = static_cast<double>(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
    return sum / static_cast<double>(sizes.size()) * static_cast<double>(count);
  }

  [[nodiscard]] verify::TrianglePiece whole(const Mesh& mesh, std::span<const CertifiedEnclosure> vertices,
                                            std::size_t n) const {
    const auto& [a, b, c] = mesh.triangles[n];
    return {.corners = {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
            .triangle = static_cast<std::uint32_t>(n),
            .convex = samples_.convex,
            .at_corners = {vertices[a].distance, vertices[b].distance, vertices[c].distance}};
  }

  [[nodiscard]] static verify::PieceDistances distances_by_corners(verify::TrianglePiece piece,
                                                                   const verify::PieceShape& shape) {
    piece.at_centre = at_centre_by_corners(piece, shape);
    return distances_on(piece, shape);
  }

  [[nodiscard]] bool is_enough(const verify::TrianglePiece& piece, const verify::PieceDistances& distances) const {
    return distances.range.hi <= largest_ &&
           (!counts_for_mean_[piece.triangle] || distances.mean.width() <= mean_width_);
  }

  /// If a sample has no tight certificate, smaller pieces would not be bounded better.
  [[nodiscard]] bool is_divisible(const verify::TrianglePiece& piece, const verify::PieceDistances& distances,
                                  const TriangleProof& proof) const {
    const bool is_tight = piece.at_centre.width() <= 4.0 * samples_.tolerance;
    if (!is_tight || proof.samples.size() >= most_samples_of_triangle) return false;
    return piece.halvings < (distances.range.hi > largest_ ? most_halvings_for_largest : halvings_for_mean_);
  }

  void prove(verify::TrianglePiece piece, double off, TriangleProof& proof) const {
    const verify::PieceShape shape = verify::shape_of(piece.corners, off);
    const Enclosure by_corners = at_centre_by_corners(piece, shape);
    if (is_enough(piece, distances_by_corners(piece, shape)) || interrupted_()) {
      proof.pieces.push_back(PieceProof::corners);
      return;
    }
    const Point centre = verify::centre(piece.corners);
    CertifiedEnclosure sample = at(centre);
    const Enclosure widened = verify::widened(sample.distance, off);
    piece.at_centre = {std::max(widened.lo, by_corners.lo), std::min(widened.hi, by_corners.hi)};
    verify::PieceDistances distances = distances_on(piece, shape);
    if (!is_enough(piece, distances) && !piece.convex) {
      piece.convex = samples_.is_one_convex(centre, reach_of(piece.at_centre, shape, off), sample.certificate);
      if (piece.convex) distances = distances_on(piece, shape);
    }
    if (is_enough(piece, distances) || !is_divisible(piece, distances, proof)) {
      proof.pieces.push_back(PieceProof::centre);
      proof.samples.push_back(std::move(sample));
      return;
    }
    const verify::LongestSide side = verify::longest_side(piece.corners);
    proof.pieces.push_back(PieceProof::halved);
    proof.samples.push_back(at(side.middle));
    piece.convex = samples_.convex;
    const auto parts = verify::halves(piece, side, verify::widened(proof.samples.back().distance, off));
    for (const verify::TrianglePiece& part : parts) prove(part, off, proof);
  }

  SampledSurface samples_;
  double largest_;  ///< no piece need be proven to be nearer than this
  int halvings_for_mean_ = 0;
  std::vector<bool> counts_for_mean_;  ///< for each triangle
  double mean_width_ = infinity;       ///< width of the pieces' means, as far as it is reached
  const SeenInterruption& interrupted_;
};

/// The triangles of a model that is one mesh, in its own frame: as DeviationChecker proves them.
CertifiedSurface certified_mesh(const Primitive& primitive, const Mesh& others, const DistanceStatistics& found,
                                const AllowedWidth& allowed, std::size_t bytes, const SeenInterruption& interrupted,
                                const std::function<void(double)>& progress) {
  const Mesh& own = *primitive.mesh;
  const verify::PlacedMesh seen = verify::placed(others, verify::RigidMotion(primitive.pose).inverse());
  const verify::TriangleTree tree(verify::triangles_of(seen.mesh));
  const auto at = [&](const Point& x) {
    const Enclosure distance = verify::widened(tree.nearest(x).distance, seen.displacement);
    return CertifiedEnclosure{{std::max(0.0, distance.lo), distance.hi}, {}};
  };
  const auto never_convex = [](const Point&, double, const Certificate&) { return false; };
  DeviationProver prover({at, never_convex, false, share_of_samples * allowed(found.largest.lo)}, found, allowed,
                         interrupted);
  std::vector<CertifiedEnclosure> vertices(own.vertices.size());
  in_parallel(vertices.size(), [&](std::size_t i) { vertices[i] = at(own.vertices[i]); });
  prover.plan(own, vertices, bytes);
  SurfaceProof proof{.within = found.largest.hi, .cover = {}, .farthest = {found.farthest, {{0.0, 0.0}, {}}}};
  proof.triangles.resize(own.triangles.size());
  in_parallel_steps(proof.triangles.size(), elements_at_a_time, interrupted, progress,
                    [&](std::size_t n) { proof.triangles[n] = prover(own, vertices, n); });
  if (interrupted()) return {};
  return {std::move(proof), {}};
}

/// About how much of a certificate file it takes.
std::size_t size_of(const SurfaceProof& proof) {
  std::size_t size = bytes_of_triangle * proof.triangles.size();
  for (const TriangleProof& triangle : proof.triangles)
    for (const CertifiedEnclosure& sample : triangle.samples) size += size_of(sample);
  for (const std::vector<PatchProof>& patches : proof.cover.patches) size += patches.size();
  for (const CertifiedPoint& point : proof.cover.off) size += size_of(point);
  for (const CertifiedPoint& point : proof.cover.on) size += size_of(point);
  return size;
}

/// Drops a surface whose distance is not bounded from above.
void leave_out_unbounded_surface(CertifiedDeviation& result) {
  const std::optional<Enclosure>& from_model = result.proven.from_model;
  if (!from_model || std::isfinite(from_model->hi)) return;
  result.certificate.surface.reset();
  result.proven.from_model.reset();
  result.proven.statistics_from_model.reset();
  result.proven.hausdorff.reset();
  result.without_surface = "some of its patches are not bounded";
}

/// A certificate holds the coordinates as they are, so that lengths are not scaled here.
void refuse_extreme_lengths(const Model& model, const Mesh& mesh) {
  constexpr int most = 480;  // squares of such lengths are binary64 numbers, and so are those of what is divided
  const double largest = std::max(bounding_radius(model), verify::largest_coordinate(mesh.vertices));
  if (std::abs(std::ilogb(largest)) <= most) return;
  refuse(fmt::format(
      "lengths of about {:.0e}: a certificate of a deviation takes lengths from 1e-144 to 1e144; scale model "
      "and mesh",
      largest));
}

}  // namespace

CertifiedDeviation certified_deviation(const Model& model, const Mesh& mesh, const Deviation& found,
                                       const DeviationOptions& options, std::size_t bytes) {
  refuse_extreme_lengths(model, mesh);
  CertifiedDeviation result;
  result.proven.interrupted = true;
  const SeenInterruption interrupted(options.interrupted);
  const AllowedWidth allowed = [&options, radius = bounding_radius(model)](double size) {
    return allowed_width(size, options, radius);
  };
  const DistanceStatistics& statistics = statistics_of(found);
  const CertifiedSamples samples(model, share_of_samples * allowed(statistics.largest.lo));
  DeviationProver prover(sampled(samples, interrupted), statistics, allowed, interrupted);
  std::vector<CertifiedEnclosure>& vertices = result.certificate.vertices;
  std::vector<TriangleProof>& triangles = result.certificate.triangles;
  vertices.resize(mesh.vertices.size());
  triangles.resize(mesh.triangles.size());
  const double share_of_surface = found.from_model ? 0.2 : 0.0;
  const double share_of_vertices = mesh.triangles.empty() ? 0.5 : 0.25;
  const auto progress = [&options](double from, double to) {
    return [&options, from, to](double done) { options.progress("certificates", from + (to - from) * done); };
  };
  std::size_t left = bytes;
  if (found.from_model) {
    CertifiedSurface surface =
        has_mesh(model)
            ? certified_mesh(model.primitives.front(), mesh, *found.from_model, allowed, bytes / 2, interrupted,
                             progress(0.0, share_of_surface))
            : certified_surface(model, mesh, found, options, bytes / 2, interrupted, progress(0.0, share_of_surface));
    if (surface.proof) left -= std::min(left, size_of(*surface.proof));
    result.certificate.surface = std::move(surface.proof);
    result.without_surface = std::move(surface.missing);
  }
  in_parallel_steps(vertices.size(), elements_at_a_time, interrupted, progress(share_of_surface, share_of_vertices),
                    [&](std::size_t i) { vertices[i] = prover.at(mesh.vertices[i]); });
  if (interrupted()) return result;
  prover.plan(mesh, vertices, left);
  in_parallel_steps(triangles.size(), elements_at_a_time, interrupted, progress(share_of_vertices, 0.6),
                    [&](std::size_t n) { triangles[n] = prover(mesh, vertices, n); });
  if (interrupted()) return result;
  result.proven = DeviationChecker(model)(mesh, result.certificate,
                                          {.percentiles = options.percentiles,
                                           .statistics_of_model = found.from_model && found.from_model->mean,
                                           .check = {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                                     .interrupted = [&interrupted] { return interrupted(); },
                                                     .progress = progress(0.6, 1.0)}});
  leave_out_unbounded_surface(result);
  return result;
}

}  // namespace verisq
