/// What proves again how much of a mesh's area lies close to a model's surface, without device or search.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>
#include <verisq/area_within.hpp>
#include <verisq/certificate.hpp>
#include <verisq/check_options.hpp>
#include <verisq/checker.hpp>
#include <verisq/deviation_certificate.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// What is in contact, and by which triangles.
struct ContactTerms {
  double distance;  ///< no farther from the model's surface is contact, from inside as from outside; model units, >= 0
  /// A region of each triangle, below `regions`. Empty: there are none.
  std::vector<std::uint32_t> region_of = {};
  std::uint32_t regions = 0;
  /// Whose surface is the model's own that is asked about, one a primitive. Empty: all.
  std::vector<bool> counted = {};
};

/// What is claimed of all triangles, or of those of a region. Areas in squares of the model unit.
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
  /// Of what of the model's boundary is surface of the primitives that count; there only with a `SurfaceCover`.
  std::optional<ContactClaim> of_model = {};
};

/// What tells the signed distance of a vertex.
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

/// Of one claim: its area, what of that is in contact, the share in percent.
[[nodiscard]] std::array<Finding, 3> check(const ContactClaim& claimed, const AreaWithin& proven);

/// Whether all of them are proved; also that of the model's surface, where there is one. Precondition: as many regions.
[[nodiscard]] bool are_proved(const ContactClaims& claimed, const ProvenContact& proven);

/// Proves areas in contact by MPFR alone (docs/mathematics.md §20). Immutable after construction: safe to call from
/// many threads.
class ContactChecker {
 public:
  explicit ContactChecker(const Model& model);
  ~ContactChecker();
  ContactChecker(ContactChecker&&) noexcept;
  ContactChecker& operator=(ContactChecker&&) noexcept;

  /// What the certificate proves of this mesh, whatever it holds: enclosures of the exact numbers, of which those of
  /// areas of the mesh need no certificate; [0, 1] of a share where it proves nothing, of the model's surface [0,
  /// infinity] of areas. A point of that is in contact by its distance from the triangles. Precondition: finite
  /// coordinates, triangles of vertices that are there; as many proofs as vertices; no claim holds a NaN; a finite
  /// distance of at least 0; a region of each triangle, or none at all; of each primitive whether it counts, or of
  /// none; triangles where there is a `SurfaceCover`.
  [[nodiscard]] ProvenContact operator()(const Mesh& mesh, const ContactTerms& terms,
                                         const ContactCertificate& certificate, const CheckOptions& options) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
