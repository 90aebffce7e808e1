/// How far a mesh and a surface lie apart: allowed widths, checks and distances, and the searches that certify them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/threads/parallel.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/proven_surface.hpp"
#include "verify/proof/surface_patch.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/checker.hpp"
#include "verisq/deviation.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq {

// The allowed widths of the enclosures of a deviation.

/// Share of the bounding radius: no narrower enclosure of a result is ever required.
inline constexpr double finest_share = 1e-6;
/// Share of the allowed width: the allowed width of samples, if tight ones are searched for.
inline constexpr double share_of_samples = 0.05;

/// The allowed width of an enclosure with this size, for a model of this bounding radius.
[[nodiscard]] inline double allowed_width(double size, const DeviationOptions& options, double bounding_radius) {
  if (options.tolerance) return *options.tolerance;
  return std::max(options.relative_tolerance * size, finest_share * bounding_radius);
}

// The required accuracy of distances that decide what is in contact.

/// Finer for solids whose distances need no search.
[[nodiscard]] inline double contact_tolerance(const Model& model) {
  constexpr double fine = 1e-6;  // of the bounding radius
  constexpr double coarse = 1e-3;
  const double share = is_union_of_convex(model) ? fine : coarse;
  return std::min(share * bounding_radius(model), std::numeric_limits<double>::max());
}

// Checks of a mesh and the regions of its triangles, for the searches of deviations.

/// Throws Error(input) for a mesh without vertices, coordinates that are not finite, and triangles that name missing
/// vertices.
void check_mesh(const Mesh& mesh);

/// Throws Error(input) unless each triangle has a region, below `regions`; if that is 0, there are no regions.
void check_regions(const Mesh& mesh, std::span<const std::uint32_t> region_of, std::uint32_t regions);

// Maps as the source of signed distances for the searches of deviations.

/// A mapper as a source of enclosures.
class MappedDistances {
 public:
  MappedDistances(const Model& model, const MapOptions& options)
      : mapper_(std::make_shared<PointMapper>(model, options)), out_of_time_(options.out_of_time) {}

  bool operator()(std::span<const Point> points, std::span<Enclosure> rows) const {
    return !map(points, rows).interrupted && !(out_of_time_ && out_of_time_());
  }

  [[nodiscard]] MapSummary map(std::span<const Point> points, std::span<Enclosure> rows) const {
    std::vector<Status> status(rows.size(), Status::wide);
    return map(points, rows, status);
  }

  [[nodiscard]] MapSummary map(std::span<const Point> points, std::span<Enclosure> rows,
                               std::span<Status> status) const {
    if (points.empty()) return {};
    constexpr std::ptrdiff_t stride = sizeof(Enclosure) / sizeof(double);
    return mapper_->map(points, {rows.size(), {&rows[0].lo, stride}, {&rows[0].hi, stride}, {status.data()}});
  }

 private:
  std::shared_ptr<PointMapper> mapper_;
  std::function<bool()> out_of_time_;
};

// The vertices of a mesh that bound others well enough to decide what is in contact.

/// For each vertex: the vertex whose certificate also bounds it, because |d(v) - d(w)| <= |v - w|. It is the vertex
/// itself if that bound could not prove of all of its triangles that they are farther than `distance`, or that they are
/// not. `rows` are signed distances of the vertices, which may be unbounded; the distances proven later may be off by
/// `tolerance`. This proves nothing. Precondition: finite coordinates, triangles of existing vertices.
[[nodiscard]] std::vector<std::uint32_t> tellers(const Mesh& mesh, std::span<const Enclosure> rows, double distance,
                                                 double tolerance);

// Deviations with their certificates: certified distances, and the distances of a model's whole surface.

// Signed distances with their certificates, in the form that the proofs of triangles need (docs/mathematics.md §20).

/// Uses no device. Immutable after construction: safe to call from many threads.
class CertifiedSamples {
 public:
  /// Samples are about as wide as the tolerance.
  CertifiedSamples(const Model& model, double tolerance);

  [[nodiscard]] double tolerance() const { return tolerance_; }
  /// Returns whether the model is one convex primitive.
  [[nodiscard]] bool convex() const { return checked_.convex(); }

  [[nodiscard]] CertifiedEnclosure at(const Point& x, const std::function<bool()>& interrupted) const;

  /// For a model of several primitives: returns whether its part within reach is one convex primitive. If so, adds the
  /// normals that prove it, unless the certificate has them.
  [[nodiscard]] bool is_one_convex(const Point& x, double reach, Certificate& certificate) const;

 private:
  struct OnePrimitive {
    SignedDistance distance;
    bool bent;
  };

  SignedDistance model_;
  verify::ProvenSamples checked_;
  std::vector<OnePrimitive> each_;  ///< for a union of several primitives
  double tolerance_;
};

// The certificate of how far a model's surface lies from a mesh: patches that cover it.

struct CertifiedSurface {
  std::optional<SurfaceProof> proof;
  std::string missing;  ///< why there is none; empty where there is one, or it is interrupted
};

/// The certificate of the result that `deviation` found with the same arguments, in about `bytes` bytes of a file, or
/// nothing. Precondition: `found.from_model`.
[[nodiscard]] CertifiedSurface certified_surface(const Model& model, const Mesh& mesh, const Deviation& found,
                                                 const DeviationOptions& options, std::size_t bytes,
                                                 const SeenInterruption& interrupted,
                                                 const std::function<void(double)>& progress);

// Covers of a model's surface whose places are proven one by one, with their certificates.

// About how many bytes of a certificate file a point's certificate takes.

[[nodiscard]] inline std::size_t size_of(const CertifiedEnclosure& sample) {
  const auto& [normals, escape, weights, witness, cover] = sample.certificate;
  return 80 + 75 * normals.size() + (escape ? 75 : 0) + (witness ? 75 : 0) + cover.size() / 4;
}

[[nodiscard]] inline std::size_t size_of(const CertifiedPoint& point) {
  return 80 + size_of(point.signed_distance);
}

// Finds the proof that a patch of a primitive's surface is part of the model's surface, or is not.

/// Uses no device. Immutable after construction: safe to call from many threads.
class PatchPlacer {
 public:
  /// `interrupted` must outlive this.
  PatchPlacer(const Model& model, const SeenInterruption& interrupted);

  /// A point that proves, as a checker has it, that no part of the patch is part of the boundary.
  [[nodiscard]] std::optional<CertifiedPoint> off_boundary(const verify::Patch& patch, std::size_t primitive) const;

  /// A point that proves that all of the patch is on the boundary.
  [[nodiscard]] std::optional<CertifiedPoint> on_boundary(const verify::Patch& patch, std::size_t primitive) const;

  /// The signed distance of a point near the boundary.
  [[nodiscard]] CertifiedPoint near_boundary(const Point& x, double tolerance) const;

 private:
  [[nodiscard]] CertifiedEnclosure between_both_sides(const Point& x, double tolerance) const;
  [[nodiscard]] std::optional<CertifiedPoint> inside(const verify::Patch& patch, std::size_t other) const;
  [[nodiscard]] std::optional<CertifiedPoint> off_boundary_of_set(const verify::Patch& patch) const;
  [[nodiscard]] std::optional<CertifiedPoint> proven_off(const verify::Patch& patch, CertifiedPoint point) const;
  [[nodiscard]] std::optional<std::vector<Normal>> away_from(const verify::Patch& patch, std::size_t other) const;

  [[nodiscard]] std::function<bool()> hook() const {
    return [this] { return interrupted_(); };
  }

  SignedDistance distance_;
  std::vector<SignedDistance> each_;  ///< for each primitive by itself
  verify::ExactChecker checker_;
  verify::ProvenSamples samples_;
  const SeenInterruption& interrupted_;
};

// Patches of a model's surface, halved until the enclosures of their areas and distances are narrow enough, with the
// proofs of their places.

/// Marks the cells that must be divided; none if they are small enough.
using CoverGoal = std::function<void(std::span<const verify::WeightedCell> cells, std::vector<bool>& chosen)>;

/// The referenced objects must outlive it.
struct CoverRequest {
  const Model& model;
  const verify::TriangleTree& triangles;
  const PatchPlacer& placer;
  std::vector<bool> counted;  ///< as `ContactTerms`
  double largest;             ///< no point of the boundary is farther from the triangles
  CoverGoal choose;
  std::size_t bytes;  ///< size of a file, about
  const SeenInterruption& interrupted;
};

/// Halves the patches of a cover further, until the goal is reached, or the file would be too large; says where they
/// lie. Precondition: it covers the primitives that count.
[[nodiscard]] SurfaceCover certified_cover(const CoverRequest& request, SurfaceCover begun);

/// The octants of the primitives that count.
[[nodiscard]] SurfaceCover octants_of(const Model& model, const std::vector<bool>& counted);

}  // namespace verisq
