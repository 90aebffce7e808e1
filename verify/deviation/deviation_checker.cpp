/// Every sample by its certificate, every triangle by its samples, all of them together by area.
#include <algorithm>
#include <utility>

#include "verify/deviation/proven_samples.hpp"
#include "verify/deviation/proven_surface.hpp"
#include "verify/deviation/proven_triangle.hpp"
#include "verify/placement/check_steps.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/judgement.hpp"
#include "verisq/deviation_certificate.hpp"

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

DeviationChecker::DeviationChecker(const Model& model) : state_(std::make_unique<State>(model)) {}
DeviationChecker::~DeviationChecker() = default;
DeviationChecker::DeviationChecker(DeviationChecker&&) noexcept = default;
DeviationChecker& DeviationChecker::operator=(DeviationChecker&&) noexcept = default;

ProvenDeviation DeviationChecker::operator()(const Mesh& mesh, const DeviationCertificate& certificate,
                                             const Options& options) const {
  verify::SampleTally tally(state_->samples);
  const verify::SampleProofs proofs = tally.proofs();
  ProvenDeviation result;
  const std::optional<SurfaceProof>& surface = certificate.surface;
  verify::CheckSteps steps(mesh.vertices.size() + mesh.triangles.size() + (surface ? verify::parts_of(*surface) : 0),
                           options.check);
  std::vector<Enclosure> rows(mesh.vertices.size());
  steps.each(rows.size(), [&](std::size_t i) { rows[i] = tally(mesh.vertices[i], certificate.vertices[i]); });
  std::vector<TriangleDistances> triangles(mesh.triangles.size());
  steps.each(triangles.size(), [&](std::size_t n) {
    const auto& [a, b, c] = mesh.triangles[n];
    triangles[n] = verify::distances_on({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                        {rows[a], rows[b], rows[c]}, certificate.triangles[n], proofs);
  });
  if (surface && !rows.empty()) {
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

}  // namespace verisq
