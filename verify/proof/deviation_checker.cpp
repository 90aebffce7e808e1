///
#include <algorithm>

#include "verify/numbers/rounding.hpp"
#include "verify/proof/check_steps.hpp"
#include "verify/proof/mesh_solid.hpp"
#include "verify/proof/proven_surface.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/deviation.hpp"

namespace verisq {

using verify::TriangleDistances;
using verify::WeightedCell;

namespace {

DistanceSummary summary_of(std::span<const WeightedCell> cells, double least, std::span<const double> percentiles) {
  DistanceSummary result;
  double greatest = 0.0;
  for (const WeightedCell& cell : cells) greatest = std::max(greatest, cell.range.hi);
  result.largest = verify::between(least, greatest, [] { return "the largest distance"; });
  result.mean = verify::mean_of(cells);
  const verify::Distribution distribution(cells);
  for (const double percent : percentiles) result.percentiles.push_back(distribution.percentile(percent));
  return result;
}

DistanceSummary of_vertices(std::span<const Enclosure> rows, std::span<const double> percentiles) {
  std::vector<WeightedCell> cells;
  double largest = 0.0;
  for (const Enclosure& row : rows) {
    const Enclosure found = verify::magnitude(row);
    cells.push_back({{1.0, 1.0}, found, found});
    largest = std::max(largest, found.lo);
  }
  return summary_of(cells, largest, percentiles);
}

DistanceSummary of_triangles(const Mesh& mesh, std::span<const Enclosure> rows,
                             std::span<const TriangleDistances> triangles, std::span<const double> percentiles) {
  std::vector<WeightedCell> cells;
  double largest = 0.0;
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    for (const std::uint32_t corner : mesh.triangles[n]) {
      largest = std::max(largest, verify::magnitude(rows[corner]).lo);
    }
    largest = std::max(largest, triangles[n].largest);
    cells.insert(cells.end(), triangles[n].cells.begin(), triangles[n].cells.end());
  }
  return summary_of(cells, largest, percentiles);
}

Enclosure larger(const Enclosure& a, const Enclosure& b) {
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}

DistanceSummary nothing_known(std::size_t percentiles) {
  return {{0.0, infinity}, {0.0, infinity}, std::vector<Enclosure>(percentiles, {0.0, infinity})};
}

/// The surface of a model that is one mesh, seen in its own frame, so that areas are those of its own triangles. The
/// other triangles are moved there, and rounded. The distances need no certificate; a proof only divides triangles.
DistanceSummary of_surface(const Primitive& primitive, const Mesh& others, const std::vector<TriangleProof>& proof,
                           std::span<const double> percentiles, verify::CheckSteps& steps) {
  const Mesh& own = *primitive.mesh;
  const verify::SeenTriangles seen(others, primitive.pose);
  const verify::SampleProofs proofs{[&](const Point& x, const CertifiedEnclosure&) { return seen.distance(x); },
                                    [](const Point&, double, const Certificate&) { return false; }, false};
  std::vector<Enclosure> rows(own.vertices.size());
  steps.each(rows.size(), [&](std::size_t i) { rows[i] = seen.distance(own.vertices[i]); });
  std::vector<TriangleDistances> triangles(own.triangles.size());
  steps.each(triangles.size(), [&](std::size_t n) {
    const auto& [a, b, c] = own.triangles[n];
    triangles[n] = verify::distances_on({own.vertices[a], own.vertices[b], own.vertices[c]},
                                        {rows[a], rows[b], rows[c]}, proof[n], proofs);
  });
  return of_triangles(own, rows, triangles, percentiles);
}

/// The steps of that work; 0 for a proof that is not of this model, which proves nothing.
std::size_t steps_of_surface(const Model& model, const SurfaceProof& proof) {
  const bool is_mesh = model.primitives.size() == 1 && model.primitives.front().mesh;
  if (!is_mesh || model.primitives.front().mesh->triangles.size() != proof.triangles.size()) return 0;
  return model.primitives.front().mesh->vertices.size() + proof.triangles.size();
}

}  // namespace

Finding check(const Enclosure& claimed, const Enclosure& proven) {
  return verify::judged(claimed, proven, proven);
}

std::vector<Finding> check(const DistanceSummary& claimed, const DistanceSummary& proven) {
  std::vector<Finding> findings{check(claimed.largest, proven.largest), check(claimed.mean, proven.mean)};
  for (std::size_t i = 0; i < claimed.percentiles.size(); ++i) {
    findings.push_back(check(claimed.percentiles[i], proven.percentiles[i]));
  }
  return findings;
}

std::vector<Finding> check(const AreaStatistics& claimed, const AreaStatistics& proven) {
  std::vector<Finding> findings{check(claimed.mean, proven.mean)};
  for (std::size_t i = 0; i < claimed.percentiles.size(); ++i) {
    findings.push_back(check(claimed.percentiles[i], proven.percentiles[i]));
  }
  return findings;
}

struct DeviationChecker::State {
  explicit State(const Model& of) : samples(of) {}

  verify::ProvenSamples samples;
};

DeviationChecker::DeviationChecker(const Model& model) : state_(hidden<State>(model)) {}

ProvenDeviation DeviationChecker::operator()(const Mesh& mesh, const DeviationCertificate& certificate,
                                             const Options& options) const {
  verify::SampleTally tally(state_->samples, options.check.interrupted);
  const verify::SampleProofs proofs = tally.proofs();
  ProvenDeviation result;
  const std::optional<SurfaceProof>& surface = certificate.surface;
  const std::size_t of_model = surface ? steps_of_surface(state_->samples.model(), *surface) : 0;
  verify::CheckSteps steps(mesh.vertices.size() + mesh.triangles.size() + of_model +
                               (surface && of_model == 0 ? verify::parts_of(*surface) : 0),
                           options.check);
  std::vector<Enclosure> rows(mesh.vertices.size());
  steps.each(rows.size(), [&](std::size_t i) { rows[i] = tally(mesh.vertices[i], certificate.vertices[i]); });
  std::vector<TriangleDistances> triangles(mesh.triangles.size());
  steps.each(triangles.size(), [&](std::size_t n) {
    const auto& [a, b, c] = mesh.triangles[n];
    triangles[n] = verify::distances_on({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                        {rows[a], rows[b], rows[c]}, certificate.triangles[n], proofs);
  });
  const Model& model = state_->samples.model();
  if (surface && has_mesh(model) && !rows.empty()) {
    const DistanceSummary proven =
        of_model > 0 ? of_surface(model.primitives.front(), mesh, surface->triangles, options.percentiles, steps)
                     : nothing_known(options.percentiles.size());
    result.from_model = proven.largest;
    if (options.statistics_of_model) result.statistics_from_model = {proven.mean, proven.percentiles};
  } else if (surface && !rows.empty()) {
    const verify::ProvenSurface proven =
        verify::proven_surface(verify::triangles_of(mesh), *surface, options, state_->samples, proofs.distance, steps);
    result.from_model = proven.largest;
    if (options.statistics_of_model) result.statistics_from_model = proven.statistics;
  }
  result.interrupted = options.check.interrupted();
  result.samples = tally.looked_at();
  result.unproved_samples = tally.unproved();
  if (result.interrupted || rows.empty()) return result;

  result.of_vertices = of_vertices(rows, options.percentiles);
  if (!triangles.empty()) result.from_mesh = of_triangles(mesh, rows, triangles, options.percentiles);
  if (result.from_model) {
    result.hausdorff =
        larger(result.from_mesh ? result.from_mesh->largest : result.of_vertices.largest, *result.from_model);
  }
  return result;
}

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

/// Sets the rows of the vertices that are bounded by another vertex; `rows` holds the rows of the others.
void tell(const Mesh& mesh, const std::vector<VertexProof>& proofs, std::vector<Enclosure>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::uint32_t from = proofs[i].told_by;
    if (proofs[i].own || from >= rows.size() || !proofs[from].own) continue;
    rows[i] = told_from(mesh.vertices[from], rows[from], mesh.vertices[i]);
  }
}

/// Claims are about all pieces of all triangles: a piece about which nothing is proven counts with any distance.
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

/// The areas of the part of the model's boundary that lies on the primitives that count.
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

ContactChecker::ContactChecker(const Model& model) {
  verify::require_valid(model);  // covers are of superquadrics, which a mesh's primitive has only as zeros
  state_ = hidden<State>(model);
}

ProvenContact ContactChecker::operator()(const Mesh& mesh, const ContactTerms& terms,
                                         const ContactCertificate& certificate, const CheckOptions& options) const {
  verify::SampleTally tally(state_->samples, options.interrupted);
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
