/// Every sample by its certificate, every triangle by its samples, all of them together by area.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

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

}  // namespace

std::vector<Finding> check(const DistanceSummary& claimed, const DistanceSummary& proven) {
  const auto judged = [](const Enclosure& claim, const Enclosure& found) {
    return verify::judged(claim, found, found);
  };
  std::vector<Finding> findings{judged(claimed.largest, proven.largest), judged(claimed.mean, proven.mean)};
  for (std::size_t i = 0; i < claimed.percentiles.size(); ++i) {
    findings.push_back(judged(claimed.percentiles[i], proven.percentiles[i]));
  }
  return findings;
}

struct DeviationChecker::State {
  explicit State(const Model& model)
      : checker(model),
        primitives(model),
        is_union(verify::is_union(model)),
        convex(verify::is_one_convex_primitive(model)) {}

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
  verify::CheckSteps steps(mesh.vertices.size() + mesh.triangles.size(), options.check);
  std::vector<Enclosure> rows(mesh.vertices.size());
  steps.each(rows.size(), [&](std::size_t i) { rows[i] = distance(mesh.vertices[i], certificate.vertices[i]); });
  std::vector<TriangleDistances> triangles(mesh.triangles.size());
  steps.each(triangles.size(), [&](std::size_t n) {
    const auto& [a, b, c] = mesh.triangles[n];
    triangles[n] = verify::distances_on({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                        {rows[a], rows[b], rows[c]}, certificate.triangles[n], proofs);
  });
  result.interrupted = options.check.interrupted();
  result.samples = samples;
  result.unproved_samples = unproved;
  if (result.interrupted || rows.empty()) return result;

  std::vector<WeightedCell> of_vertices;
  double largest = 0.0;
  for (const Enclosure& row : rows) {
    const Enclosure found = verify::magnitude(row);
    of_vertices.push_back({{1.0, 1.0}, found, found});
    largest = std::max(largest, found.lo);
  }
  result.of_vertices = summary_of(of_vertices, largest, options.percentiles);
  if (triangles.empty()) return result;
  std::vector<WeightedCell> of_mesh;
  double largest_of_mesh = 0.0;
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    for (const std::uint32_t corner : mesh.triangles[n]) {
      largest_of_mesh = std::max(largest_of_mesh, verify::magnitude(rows[corner]).lo);
    }
    largest_of_mesh = std::max(largest_of_mesh, triangles[n].largest);
    of_mesh.insert(of_mesh.end(), triangles[n].cells.begin(), triangles[n].cells.end());
  }
  result.from_mesh = summary_of(of_mesh, largest_of_mesh, options.percentiles);
  return result;
}

}  // namespace verisq
