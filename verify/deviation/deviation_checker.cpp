/// Every sample by its certificate, every triangle by its samples, all of them together by area.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "verify/deviation/proven_surface.hpp"
#include "verify/deviation/proven_triangle.hpp"
#include "verify/placement/check_steps.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/proof/exact_checker.hpp"
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

struct DeviationChecker::State {
  explicit State(const Model& of)
      : model(of),
        checker(of),
        primitives(of),
        is_union(verify::is_union(of)),
        convex(verify::is_one_convex_primitive(of)) {}

  /// What is proved of a claim, or what is proven instead of it.
  [[nodiscard]] Enclosure distance(const Point& x, const CertifiedEnclosure& claimed, bool& proved) const {
    const Finding finding = checker(x, claimed.distance, claimed.certificate);
    proved = finding.verdict == Verdict::proved;
    return proved ? claimed.distance : finding.proven;
  }

  /// The others are farther, by spheres and normals.
  [[nodiscard]] bool is_one_convex(const Point& x, double reach, const Certificate& certificate) const {
    if (!is_union || !std::isfinite(reach)) return false;
    std::size_t near = 0;
    bool convex_one = false;
    const std::span<const verify::PosedPrimitive> all = primitives.primitives();
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      double lower = std::visit([&](const auto& solid) { return solid.lower_by_sphere(x); }, all[i]);
      for (const auto& [primitive, v] : certificate.normals) {
        if (primitive == i) lower = std::max(lower, verify::lower_by_normal(all[i], x, {v[0], v[1], v[2]}));
      }
      if (lower >= reach) continue;
      ++near;
      convex_one = std::holds_alternative<verify::PosedSuperquadric>(all[i]);
    }
    return near == 1 && convex_one;
  }

  Model model;
  Checker checker;
  verify::ExactChecker primitives;
  bool is_union;
  bool convex;
};

DeviationChecker::DeviationChecker(const Model& model) : state_(std::make_unique<State>(State(model))) {}
DeviationChecker::~DeviationChecker() = default;
DeviationChecker::DeviationChecker(DeviationChecker&&) noexcept = default;
DeviationChecker& DeviationChecker::operator=(DeviationChecker&&) noexcept = default;

ProvenDeviation DeviationChecker::operator()(const Mesh& mesh, const DeviationCertificate& certificate,
                                             const Options& options) const {
  std::atomic<std::uint64_t> samples{0};
  std::atomic<std::uint64_t> unproved{0};
  const auto distance = [&](const Point& x, const CertifiedEnclosure& claimed) {
    bool proved = false;
    const Enclosure found = state_->distance(x, claimed, proved);
    ++samples;
    if (!proved) ++unproved;
    return found;
  };
  const verify::SampleProofs proofs{
      distance,
      [this](const Point& x, double reach, const Certificate& of) { return state_->is_one_convex(x, reach, of); },
      state_->convex};

  ProvenDeviation result;
  const std::optional<SurfaceProof>& surface = certificate.surface;
  verify::CheckSteps steps(mesh.vertices.size() + mesh.triangles.size() + (surface ? verify::parts_of(*surface) : 0),
                           options.check);
  std::vector<Enclosure> rows(mesh.vertices.size());
  steps.each(rows.size(), [&](std::size_t i) { rows[i] = distance(mesh.vertices[i], certificate.vertices[i]); });
  std::vector<TriangleDistances> triangles(mesh.triangles.size());
  steps.each(triangles.size(), [&](std::size_t n) {
    const auto& [a, b, c] = mesh.triangles[n];
    triangles[n] = verify::distances_on({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                        {rows[a], rows[b], rows[c]}, certificate.triangles[n], proofs);
  });
  if (surface && !rows.empty()) {
    result.from_model =
        verify::farthest_of_surface(state_->model, verify::triangles_of(mesh), *surface, distance, steps);
  }
  result.interrupted = options.check.interrupted();
  result.samples = samples;
  result.unproved_samples = unproved;
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
