/// Every sample by its certificate, every triangle by its samples, and by area what of them is no farther.
#include <algorithm>
#include <utility>

#include "verify/analysis/distance_up.hpp"
#include "verify/deviation/patch_cover.hpp"
#include "verify/deviation/proven_samples.hpp"
#include "verify/deviation/proven_surface.hpp"
#include "verify/deviation/proven_triangle.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/placement/check_steps.hpp"
#include "verify/proof/judgement.hpp"
#include "verisq/contact_certificate.hpp"

namespace verisq {

using verify::Direction;
using verify::TriangleDistances;
using verify::WeightedCell;

namespace {

const TriangleProof by_corners{{PieceProof::corners}, {}};

/// The proof of each triangle; where a triangle is named twice, the last one's.
std::vector<const TriangleProof*> proofs_of(const std::vector<DividedTriangle>& divided, std::size_t triangles) {
  std::vector<const TriangleProof*> proofs(triangles, &by_corners);
  for (const auto& [triangle, proof] : divided) {
    if (triangle < triangles) proofs[triangle] = &proof;
  }
  return proofs;
}

/// The signed distance is 1-Lipschitz.
Enclosure told_from(const Point& from, const Enclosure& there, const Point& x) {
  return verify::widened(there, verify::distance_up(from, x));
}

/// Of the vertices that are told by others. `rows` holds those of the others.
void tell(const Mesh& mesh, const std::vector<VertexProof>& proofs, std::vector<Enclosure>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::uint32_t from = proofs[i].told_by;
    if (proofs[i].own || from >= rows.size() || !proofs[from].own) continue;
    rows[i] = told_from(mesh.vertices[from], rows[from], mesh.vertices[i]);
  }
}

/// What is claimed is of all pieces of all triangles: what a proof says nothing of counts with any distance.
void add_up(const ContactTerms& terms, const std::vector<TriangleDistances>& triangles, ProvenContact& result) {
  std::vector<WeightedCell> all;
  std::vector<std::vector<WeightedCell>> by_region(terms.regions);
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    const std::vector<WeightedCell>& cells = triangles[n].cells;
    all.insert(all.end(), cells.begin(), cells.end());
    if (terms.regions == 0) continue;
    std::vector<WeightedCell>& of_region = by_region[terms.region_of[n]];
    of_region.insert(of_region.end(), cells.begin(), cells.end());
  }
  result.of_mesh = verify::area_within(all, terms.distance);
  for (const std::vector<WeightedCell>& cells : by_region)
    result.by_region.push_back(verify::area_within(cells, terms.distance));
}

/// Of what of the model's boundary lies on the primitives that count.
AreaWithin surface_within(const Mesh& mesh, const ContactTerms& terms, const SurfaceCover& cover,
                          const verify::ProvenSamples& samples, const verify::ProvenSignedDistance& distance,
                          verify::CheckSteps& steps) {
  constexpr AreaWithin anything{{0.0, infinity}, {0.0, infinity}, {0.0, 1.0}};
  const auto surface = verify::covered_surface(cover, terms.counted, samples, distance, steps);
  if (!surface || mesh.triangles.empty()) return anything;
  const verify::TriangleTree tree(verify::triangles_of(mesh));
  const auto cells = verify::boundary_cells(*surface, tree, infinity, steps);
  return cells ? verify::area_within(*cells, terms.distance) : anything;
}

Enclosure in_percent(const Enclosure& share) {
  return {std::max(0.0, verify::multiply(100.0, share.lo, Direction::down)),
          std::min(100.0, verify::multiply(100.0, share.hi, Direction::up))};
}

}  // namespace

ContactClaim claim_of(const AreaWithin& contact) {
  return {contact.area, contact.within, in_percent(contact.share)};
}

std::array<Finding, 3> check(const ContactClaim& claimed, const AreaWithin& proven) {
  const auto& [area, within, percent] = claim_of(proven);
  return {check(claimed.area, area), check(claimed.within, within), check(claimed.percent, percent)};
}

bool are_proved(const ContactClaims& claimed, const ProvenContact& proven) {
  const auto is_proved = [](const ContactClaim& claim, const AreaWithin& of) {
    return std::ranges::all_of(check(claim, of), [](const Finding& f) { return f.verdict == Verdict::proved; });
  };
  return !proven.interrupted && is_proved(claimed.of_mesh, proven.of_mesh) &&
         std::ranges::equal(claimed.by_region, proven.by_region, is_proved) &&
         (!claimed.of_model || (proven.of_model && is_proved(*claimed.of_model, *proven.of_model)));
}

struct ContactChecker::State {
  explicit State(const Model& of) : samples(of) {}

  verify::ProvenSamples samples;
};

ContactChecker::ContactChecker(const Model& model) : state_(std::make_unique<State>(model)) {}
ContactChecker::~ContactChecker() = default;
ContactChecker::ContactChecker(ContactChecker&&) noexcept = default;
ContactChecker& ContactChecker::operator=(ContactChecker&&) noexcept = default;

ProvenContact ContactChecker::operator()(const Mesh& mesh, const ContactTerms& terms,
                                         const ContactCertificate& certificate, const CheckOptions& options) const {
  verify::SampleTally tally(state_->samples);
  const verify::SampleProofs proofs = tally.proofs();
  const std::optional<SurfaceCover>& surface = certificate.surface;
  verify::CheckSteps steps(
      mesh.vertices.size() + mesh.triangles.size() + (surface ? 2 * verify::parts_of(*surface) : 0), options);
  std::vector<Enclosure> rows(mesh.vertices.size(), {-infinity, infinity});
  steps.each(rows.size(), [&](std::size_t i) {
    if (const auto& own = certificate.vertices[i].own) rows[i] = tally(mesh.vertices[i], *own);
  });
  tell(mesh, certificate.vertices, rows);
  const std::vector<const TriangleProof*> of_triangles = proofs_of(certificate.triangles, mesh.triangles.size());
  std::vector<TriangleDistances> triangles(mesh.triangles.size());
  steps.each(triangles.size(), [&](std::size_t n) {
    const auto& [a, b, c] = mesh.triangles[n];
    triangles[n] = verify::distances_on({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                        {rows[a], rows[b], rows[c]}, *of_triangles[n], proofs);
  });
  ProvenContact result;
  if (surface) result.of_model = surface_within(mesh, terms, *surface, state_->samples, proofs.distance, steps);
  result.interrupted = options.interrupted();
  result.samples = tally.looked_at();
  result.unproved_samples = tally.unproved();
  if (!result.interrupted) add_up(terms, triangles, result);
  return result;
}

}  // namespace verisq
