/// What proves how far a mesh and a model's surface lie apart again, without device or search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>
#include <verisq/certificate.hpp>
#include <verisq/check_options.hpp>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// What tells the distances on a triangle, or on a part of it.
enum class PieceProof : std::uint8_t {
  corners,  ///< those at its corners are enough
  centre,   ///< those, and that at its centroid
  halved,   ///< those of both halves: it is cut from the middle of its longest side to the corner across
};

/// Of a triangle with all of its parts in preorder.
struct TriangleProof {
  std::vector<PieceProof> pieces;
  /// Signed distances, in the order of `pieces`: of `centre` at the piece's centroid, of `halved` at the middle of its
  /// longest side, both to nearest (docs/mathematics.md §20).
  std::vector<CertifiedEnclosure> samples;
};

/// What tells how far a patch of a primitive's surface lies from the mesh, or a part of it.
enum class PatchProof : std::uint8_t {
  near,           ///< the mesh's triangles themselves, of which the checker finds near ones
  off,            ///< it is no part of the boundary of the model's solid: a point of `SurfaceProof::off` says so
  halved_along,   ///< both halves: of its arc along the latitude
  halved_around,  ///< likewise, of its arc around
  on,             ///< all of it is part of that boundary: a point of `SurfaceCover::on` says so; what it is follows
};

/// Of all primitives, halved ones included: what more would take to follow no checker need have.
inline constexpr std::size_t most_patches = std::size_t{1} << 22U;

/// A point and its signed distance to the model.
struct CertifiedPoint {
  Point point;
  CertifiedEnclosure signed_distance;
};

/// Patches that together hold the model's surface (docs/mathematics.md §20).
struct SurfaceCover {
  std::vector<std::vector<PatchProof>> patches;  ///< of each primitive: its eight octants with all parts in preorder
  /// In the order of `patches`: the patch is nearer to the point than the model's surface is.
  std::vector<CertifiedPoint> off;
  /// Likewise: the patch is nearer to the point than all other primitives' surfaces are, by the normals; in a union
  /// these are outside of it, else the model's surface is nearer to the point than the patch reaches, too.
  std::vector<CertifiedPoint> on = {};
};

/// How far the model's surface lies from the mesh, at most, and at least, in the mean, and percentiles.
struct SurfaceProof {
  double within = infinity;  ///< what the largest distance is shown to be at most, no harder is tried; need not be true
  SurfaceCover cover;
  /// Near the model's surface, and from the mesh at least as far as is claimed.
  CertifiedPoint farthest;
};

/// Of a mesh, or of a cloud, which has no triangles.
struct DeviationCertificate {
  std::vector<CertifiedEnclosure> vertices;  ///< signed distances
  std::vector<TriangleProof> triangles;
  std::optional<SurfaceProof> surface = {};  ///< the other way, of the model; may be missing
};

/// Enclosures of the largest distance to the model's surface, of the mean and of percentiles.
struct DistanceSummary {
  Enclosure largest{0.0, infinity};
  Enclosure mean{0.0, infinity};
  std::vector<Enclosure> percentiles = {};  ///< the least distances that so many percent do not exceed
};

/// What is proven of each number that is claimed: the largest, the mean, then the percentiles. Precondition: as many
/// percentiles, of the same percents.
[[nodiscard]] std::vector<Finding> check(const DistanceSummary& claimed, const DistanceSummary& proven);

/// Of one number.
[[nodiscard]] Finding check(const Enclosure& claimed, const Enclosure& proven);

/// Enclosures of the mean of a surface's distances by area, and of percentiles.
struct AreaStatistics {
  Enclosure mean{0.0, infinity};
  std::vector<Enclosure> percentiles = {};

  [[nodiscard]] bool operator==(const AreaStatistics&) const = default;
};

/// What is proven of the mean, then of the percentiles. Precondition: as many, of the same percents.
[[nodiscard]] std::vector<Finding> check(const AreaStatistics& claimed, const AreaStatistics& proven);

struct ProvenDeviation {
  DistanceSummary of_vertices;               ///< each of the same weight
  std::optional<DistanceSummary> from_mesh;  ///< of all points of all triangles, by area; nothing of a cloud
  /// The largest distance of the model's surface from the mesh; nothing without a `SurfaceProof`.
  std::optional<Enclosure> from_model;
  std::optional<AreaStatistics> statistics_from_model;  ///< of these distances; nothing unless they are asked for, too
  std::optional<Enclosure> hausdorff;                   ///< the larger of both largest distances; likewise
  std::uint64_t samples = 0;                            ///< signed distances that were looked at
  std::uint64_t unproved_samples = 0;                   ///< of these: they say less than they claim
  bool interrupted = false;                             ///< nothing is said then
};

/// Proves deviations by MPFR alone. Immutable after construction: safe to call from many threads.
class DeviationChecker {
 public:
  explicit DeviationChecker(const Model& model);
  ~DeviationChecker();
  DeviationChecker(DeviationChecker&&) noexcept;
  DeviationChecker& operator=(DeviationChecker&&) noexcept;

  struct Options {
    std::span<const double> percentiles = {};  ///< each above 0, at most 100
    bool statistics_of_model = false;          ///< mean and percentiles of the model's surface, too
    CheckOptions check;
  };

  /// What the certificate proves of this mesh, whatever it holds: enclosures of the exact numbers, [0, infinity] where
  /// it proves nothing; how far the model lies from the mesh no closer than `SurfaceProof::within`. Precondition:
  /// finite coordinates, triangles of vertices that are there; as many certificates as vertices and triangles; no claim
  /// holds a NaN.
  [[nodiscard]] ProvenDeviation operator()(const Mesh& mesh, const DeviationCertificate& certificate,
                                           const Options& options) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
