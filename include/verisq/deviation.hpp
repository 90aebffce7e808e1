/// How far a mesh and the surface of a model lie apart, which areas are in contact, and what proves it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/clearance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/hidden.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Certificates of how far a mesh and a model's surface lie apart: proven again without device or search.

/// How the distances on a triangle, or on a part of it, are bounded.
enum class PieceProof : std::uint8_t {
  corners,  ///< those at its corners are enough
  centre,   ///< those, and that at its centroid
  halved,   ///< those of both halves: it is cut from the middle of its longest side to the corner across
};

/// The proof of a triangle, with all of its parts in preorder.
struct TriangleProof {
  std::vector<PieceProof> pieces;
  /// Signed distances, in the order of `pieces`: of `centre` at the piece's centroid, of `halved` at the middle of its
  /// longest side, both to nearest (docs/mathematics.md §20).
  std::vector<CertifiedEnclosure> samples;
};

/// How the distance from a patch of a primitive's surface, or a part of it, to the mesh is bounded.
enum class PatchProof : std::uint8_t {
  near,           ///< the mesh's triangles themselves, of which the checker finds near ones
  off,            ///< it is no part of the boundary of the model's solid: a point of `SurfaceProof::off` says so
  halved_along,   ///< both halves: of its arc along the latitude
  halved_around,  ///< likewise, of its arc around
  on,             ///< all of it is part of that boundary: a point of `SurfaceCover::on` says so; what it is follows
};

/// The largest number of patches of all primitives together, halved ones included: it limits a checker's work.
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
  /// Instead of all that, if the model is one mesh: the proofs of its triangles, whose samples' claims are ignored.
  std::vector<TriangleProof> triangles = {};
};

/// The certificate of a mesh, or of a cloud, which has no triangles.
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

/// Judges each number that is claimed: the largest, the mean, then the percentiles. Precondition: as many
/// percentiles, of the same percents.
[[nodiscard]] std::vector<Finding> check(const DistanceSummary& claimed, const DistanceSummary& proven);

/// Judges one number.
[[nodiscard]] Finding check(const Enclosure& claimed, const Enclosure& proven);

/// Enclosures of the mean of a surface's distances by area, and of percentiles.
struct AreaStatistics {
  Enclosure mean{0.0, infinity};
  std::vector<Enclosure> percentiles = {};

  [[nodiscard]] bool operator==(const AreaStatistics&) const = default;
};

/// Judges the mean, then the percentiles. Precondition: as many, of the same percents.
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

  struct Options {
    std::span<const double> percentiles = {};  ///< each above 0, at most 100
    bool statistics_of_model = false;          ///< mean and percentiles of the model's surface, too
    CheckOptions check;
  };

  /// Returns what the certificate proves about this mesh, whatever it holds: enclosures of the exact numbers, [0,
  /// infinity] where it proves nothing. The model's distance from the mesh is bounded no closer than
  /// `SurfaceProof::within`. Precondition:
  /// finite coordinates, triangles of vertices that are there; as many certificates as vertices and triangles; no claim
  /// holds a NaN.
  [[nodiscard]] ProvenDeviation operator()(const Mesh& mesh, const DeviationCertificate& certificate,
                                           const Options& options) const;

 private:
  struct State;
  Hidden<State> state_;
};

// Proves how far a mesh and the surface of a model lie apart, both ways: the two-sided Hausdorff distance.
//
// Distances are between the model's boundary and the triangles that the mesh's binary64 corners state (a cloud's
// points). They are Euclidean and not signed. The mesh need not be closed, oriented or manifold.

struct DeviationOptions {
  /// How wide an enclosure of the result may be: this share of its upper end, but never less than 1e-6 of the model's
  /// bounding radius. Above 0.
  double relative_tolerance = 0.05;
  /// Instead, in model units. Above 0.
  std::optional<double> tolerance = {};
  std::vector<double> percentiles{50.0, 95.0};  ///< each above 0, at most 100
  bool statistics_of_surface = true;  ///< mean and percentiles of the mesh's surface, not of its vertices alone
  bool from_model = true;             ///< the model's surface to the mesh; of a cloud to its points
  bool statistics_of_model = false;   ///< mean and percentiles of the model's surface, too: takes much longer
  /// A region of each triangle, to say where it deviates, too: below `regions`. Empty: none are asked for.
  std::vector<std::uint32_t> region_of = {};
  std::uint32_t regions = 0;
  std::uint64_t most_samples = 1U << 24U;  ///< of the model's surface and of the mesh's, each; what is left is wide
  std::string device = "auto";             ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };  ///< polled; true ends early, with what is proven by then
  std::function<bool()> out_of_time = {};                    ///< a time limit, likewise; once true, it must stay true
  /// Called now and then with what is worked at, and how much of it is done, from 0 to 1, about.
  std::function<void(std::string_view stage, double done)> progress = [](std::string_view, double) {};
};

/// Statistics of the distances of a set of points: all vertices, each of the same weight, or a whole surface, by area.
struct DistanceStatistics {
  Enclosure largest{0.0, infinity};  ///< the supremum
  Point farthest{};                  ///< about where: a point of the set within rounding of it is `largest.lo` away
  std::optional<Enclosure> mean = {};
  /// As asked for: of `p` the least distance that p % of the set do not exceed. Empty where there is none.
  std::vector<Enclosure> percentiles = {};
};

struct Deviation {
  std::vector<MapResult> vertices;               ///< signed distance of each vertex to the solid: negative inside
  MapSummary map;                                ///< of them
  DistanceStatistics of_vertices;                ///< of their distances to the model's surface
  std::optional<DistanceStatistics> from_mesh;   ///< of all points of all triangles; nothing for a cloud
  std::optional<DistanceStatistics> from_model;  ///< of all points of the model's surface
  std::vector<DistanceStatistics> by_region;     ///< of the mesh's triangles: `largest`, `farthest` and `mean`
  /// The larger of both largest distances: the two-sided Hausdorff distance. Nothing unless both are known.
  std::optional<Enclosure> hausdorff;
  std::uint64_t samples = 0;  ///< distances to the model that were asked for, but for those of `vertices`
  std::uint64_t patches = 0;  ///< parts of the model's surface whose distance to the mesh was bounded
  bool to_tolerance = false;  ///< every enclosure of the statistics is as narrow as asked for
  bool interrupted = false;
  bool out_of_time = false;  ///< the limit came, or `most_samples`, before all was narrow
};

/// Whether the enclosure is as narrow as the options ask for, of a model of this bounding radius.
[[nodiscard]] bool to_tolerance(const Enclosure& distance, const DeviationOptions& options, double bounding_radius);

/// Encloses the deviation of any model from any mesh (docs/mathematics.md §20). A mesh without triangles is a cloud.
/// Throws Error(input) for a mesh without vertices, coordinates that are not finite, triangles that name vertices which
/// are not there, options out of range, regions that are not one a triangle, and as Mapper.
[[nodiscard]] Deviation deviation(const Model& model, const Mesh& mesh, const DeviationOptions& options);

// How far a mesh and a model's surface lie apart, with what proves it again.

struct CertifiedDeviation {
  ProvenDeviation proven;  ///< what the certificate proves; `interrupted`: there is none
  DeviationCertificate certificate;
  std::string without_surface;  ///< why it says nothing of the model's surface; empty where it does, or none was found
};

/// Certifies what `deviation` found with the same arguments: the distances from the vertices to the model and, of a
/// mesh with triangles, from all of their points; and, where it is found, the largest distance of the model's surface
/// from the mesh. Largest distances are about as tight as those found; mean and percentiles, of the mesh alone, as the
/// samples leave them, of which those that nothing else needs are left out where the certificate would take more than
/// about so many `bytes` as a file (verisq/certificate_file.hpp); what the model's surface takes is at most half of
/// that. Uses no device; `progress`, `interrupted` as there, no time limit. Precondition: `found` is not interrupted.
/// Throws Error(input) where the largest length is below 1e-144 or above 1e144.
[[nodiscard]] CertifiedDeviation certified_deviation(const Model& model, const Mesh& mesh, const Deviation& found,
                                                     const DeviationOptions& options, std::size_t bytes = 64'000'000);

// Certificates of how much of a mesh's area lies close to a model's surface: proven again without device or search.

/// Which points are in contact, and which triangles count.
struct ContactTerms {
  double distance;  ///< no farther from the model's surface is contact, from inside as from outside; model units, >= 0
  /// A region of each triangle, below `regions`. Empty: there are none.
  std::vector<std::uint32_t> region_of = {};
  std::uint32_t regions = 0;
  /// Whose surface is the model's own that is asked about, one a primitive. Empty: all.
  std::vector<bool> counted = {};
};

/// The claim about all triangles, or about those of a region. Areas in squares of the model unit.
struct ContactClaim {
  Enclosure area;     ///< of all
  Enclosure within;   ///< of what is in contact
  Enclosure percent;  ///< of all that is, in [0, 100]
};

/// The share in percent, rounded outward.
[[nodiscard]] ContactClaim claim_of(const AreaWithin& contact);

struct ContactClaims {
  ContactClaim of_mesh;                 ///< of all triangles
  std::vector<ContactClaim> by_region;  ///< of each region's
  /// The claim about that part of the model's boundary which belongs to the primitives that count. Only with a
  /// `SurfaceCover`.
  std::optional<ContactClaim> of_model = {};
};

/// How the signed distance of a vertex is bounded.
struct VertexProof {
  std::optional<CertifiedEnclosure> own;  ///< at the vertex itself
  /// Without it: a vertex that has one; the distance between both vertices is added to either end.
  std::uint32_t told_by = 0;
};

/// A triangle that its corners alone do not tell enough of.
struct DividedTriangle {
  std::uint32_t triangle;
  TriangleProof proof;
};

struct ContactCertificate {
  std::vector<VertexProof> vertices;         ///< of each vertex
  std::vector<DividedTriangle> triangles;    ///< all others are told by their corners
  std::optional<SurfaceCover> surface = {};  ///< of the primitives that count, nothing of the others; may be missing
};

struct ProvenContact {
  AreaWithin of_mesh;
  std::vector<AreaWithin> by_region;   ///< of one without triangles all are 0
  std::optional<AreaWithin> of_model;  ///< nothing without a `SurfaceCover`
  std::uint64_t samples = 0;           ///< signed distances that were looked at
  std::uint64_t unproved_samples = 0;  ///< of these: they say less than they claim
  bool interrupted = false;            ///< nothing is said then
};

/// Judges one claim: its area, the area in contact, the share in percent.
[[nodiscard]] std::array<Finding, 3> check(const ContactClaim& claimed, const AreaWithin& proven);

/// Whether all of them are proved; also that of the model's surface, where there is one. Precondition: as many regions.
[[nodiscard]] bool are_proved(const ContactClaims& claimed, const ProvenContact& proven);

/// Proves areas in contact by MPFR alone (docs/mathematics.md §20). Immutable after construction: safe to call from
/// many threads.
class ContactChecker {
 public:
  explicit ContactChecker(const Model& model);

  /// Returns what the certificate proves about this mesh, whatever it holds: enclosures of the exact numbers. Areas of
  /// the mesh need no certificate. Where it proves nothing a share is [0, 1], and an area of the model's surface is [0,
  /// infinity]. A point of the model's surface is in contact by its distance from the triangles. Precondition: finite
  /// coordinates, triangles of vertices that are there; as many proofs as vertices; no claim holds a NaN; a finite
  /// distance of at least 0; a region of each triangle, or none at all; of each primitive whether it counts, or of
  /// none; triangles where there is a `SurfaceCover`.
  [[nodiscard]] ProvenContact operator()(const Mesh& mesh, const ContactTerms& terms,
                                         const ContactCertificate& certificate, const CheckOptions& options) const;

 private:
  struct State;
  Hidden<State> state_;
};

// Proves how much of the area of a mesh and of a model's surface lies close to the other: contact, by area.

struct ContactAreaOptions {
  double distance;            ///< no farther is contact; model units, >= 0
  double share_width = 0.01;  ///< how wide the enclosure of a share may be, > 0
  /// A region of each triangle, below `regions`. Empty: none are asked for.
  std::vector<std::uint32_t> region_of = {};
  std::uint32_t regions = 0;
  bool of_model = false;                   ///< the model's surface, too
  std::vector<bool> counted = {};          ///< whose surface that is, one a primitive; empty: all
  std::uint64_t most_samples = 1U << 22U;  ///< of the mesh's and of the model's surface, each; what is left is wide
  std::string device = "auto";             ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };
};

struct ContactAreas {
  AreaWithin of_mesh;                  ///< of all triangles
  std::vector<AreaWithin> by_region;   ///< of each region's triangles
  std::optional<AreaWithin> of_model;  ///< of the boundary of the solid that is the model
  std::uint64_t samples = 0;           ///< distances asked for
  bool interrupted = false;            ///< what is told is proven all the same
};

/// Distances are Euclidean and not signed: a point of the mesh counts by its distance from the model's boundary, from
/// inside as from outside; a point of the model's boundary by its distance from the triangles (docs/mathematics.md
/// §20). Any model. Throws Error(input) for a mesh without triangles, regions that are not one a triangle, options out
/// of range, and as Mapper.
[[nodiscard]] ContactAreas contact_areas(const Model& model, const Mesh& mesh, const ContactAreaOptions& options);

// How much of a mesh's area lies close to a model's surface, with what proves it again.

struct CertifiedContact {
  ContactTerms terms;
  /// Those found, where the certificate proves them; else wider, as it does.
  ContactClaims claims;
  ContactCertificate certificate;
  ProvenContact proven;  ///< `interrupted`: there is no certificate
};

/// Certifies what `contact_areas` found of the mesh with the same arguments; the model's own surface has no
/// certificate. Divides triangles as it does, those of which it is least known what is in contact, until that is known
/// as well as it was found, or the certificate takes more than about so many `bytes` as a file
/// (verisq/certificate_file.hpp). `progress` is told how much is done, from 0 to 1. Throws Error as contact_areas.
[[nodiscard]] CertifiedContact certified_contact(
    const Model& model, const Mesh& mesh, const ContactAreas& found, const ContactAreaOptions& options,
    const std::function<void(double)>& progress = [](double) {}, std::size_t bytes = 60'000'000);

}  // namespace verisq
