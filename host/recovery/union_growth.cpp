/// Candidates: halves of the primitives that cost most, and new ones where the union misses most.
#include "host/recovery/union_growth.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "host/recovery/alternative_shapes.hpp"
#include "host/recovery/cloud_frame.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::recovery {
namespace {

constexpr std::size_t divided = 3;  // primitives that cost most
constexpr std::size_t places = 6;   // of new primitives
constexpr int candidate_sweeps = 12;
constexpr int joint_sweeps = 3;
constexpr std::size_t finalists = 3;
constexpr int refining_sweeps = 40;
constexpr int alternative_sweeps = 8;
constexpr double half_axis = 0.55;  // of a half, so that halves overlap

struct Candidate {
  UnionFit fit;
  std::vector<std::size_t> changed;  ///< primitives
};

std::vector<double> costs_by_primitive(const UnionFit& fit) {
  const std::vector<double> distances = fit.distances();
  const std::vector<std::size_t> owners = fit.owners();
  std::vector<double> costs(fit.shapes().size());
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const double residual = fit.residual(i, distances[i]);
    costs[owners[i]] += residual * residual;
  }
  return costs;
}

void add_halves(const UnionFit& fit, std::vector<Candidate>& candidates) {
  const std::vector<double> costs = costs_by_primitive(fit);
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&costs](std::size_t a, std::size_t b) { return costs[a] > costs[b]; });
  order.resize(std::min(order.size(), divided));
  for (const std::size_t primitive : order) {
    for (int axis = 0; axis < 3; ++axis) {
      const Shape& whole = fit.shapes()[primitive];
      Shape half = whole;
      half.axes[axis] *= half_axis;
      half.taper = 0.0;
      half.exponents = half.exponents.cwiseMax(0.3).cwiseMin(1.3);
      const Eigen::Vector3d shift = (1.0 - half_axis) * whole.axes[axis] * whole.rotation.col(axis);
      half.centre = whole.centre + shift;
      Candidate candidate{fit, {primitive, fit.shapes().size()}};
      candidate.fit.replace(primitive, half);
      half.centre = whole.centre - shift;
      candidate.fit.add(half);
      candidates.push_back(std::move(candidate));
    }
  }
}

Eigen::Vector3d sample_at(const UnionSamples& samples, std::size_t i) {
  if (i < samples.surface.size()) return samples.surface[i];
  i -= samples.surface.size();
  return i < samples.inside.size() ? samples.inside[i] : samples.outside[i - samples.inside.size()];
}

/// Ellipsoids about clusters of samples that the union does not reach.
void add_new(const UnionFit& fit, std::vector<Candidate>& candidates) {
  const std::vector<double> distances = fit.distances();
  const std::size_t count = fit.samples().surface.size() + fit.samples().inside.size();
  std::vector<std::size_t> missed;
  for (std::size_t i = 0; i < count; ++i)
    if (distances[i] > 0.0) missed.push_back(i);
  std::ranges::stable_sort(missed, [&](std::size_t a, std::size_t b) { return distances[a] > distances[b]; });
  std::vector<Eigen::Vector3d> centres;
  for (const std::size_t worst : missed) {
    if (centres.size() == places) return;
    const Eigen::Vector3d centre = sample_at(fit.samples(), worst);
    const double radius = std::max(4.0 * distances[worst], 0.1 * fit.options().size);
    if (std::ranges::any_of(centres, [&](const Eigen::Vector3d& other) { return (other - centre).norm() < radius; }))
      continue;
    centres.push_back(centre);
    std::vector<Eigen::Vector3d> cluster;
    for (const std::size_t i : missed) {
      const Eigen::Vector3d point = sample_at(fit.samples(), i);
      if (distances[i] > 0.3 * distances[worst] && (point - centre).norm() < radius) cluster.push_back(point);
    }
    if (cluster.size() < 4) continue;
    Shape shape;
    shape.rotation = principal_axes(cluster);
    const OrientedBox box = box_along(cluster, shape.rotation);
    shape.centre = box.centre;
    shape.axes = box.half.cwiseMax(0.3 * box.half.maxCoeff());
    Candidate candidate{fit, {fit.shapes().size()}};
    candidate.fit.add(shape);
    candidates.push_back(std::move(candidate));
  }
}

void sort(std::vector<Candidate>& candidates) {
  std::ranges::stable_sort(candidates,
                           [](const Candidate& a, const Candidate& b) { return a.fit.cost() < b.fit.cost(); });
}

/// The same union with one primitive in another parametrisation, where that is better.
bool try_alternatives(UnionFit& fit, const std::function<bool()>& interrupted) {
  bool gained = false;
  for (std::size_t primitive = 0; primitive < fit.shapes().size() && !interrupted(); ++primitive) {
    const std::vector<std::size_t> owners = fit.owners();
    std::vector<Eigen::Vector3d> own;
    for (std::size_t i = 0; i < fit.samples().surface.size(); ++i)
      if (owners[i] == primitive) own.push_back(fit.samples().surface[i]);
    if (own.empty()) continue;
    const MixtureFit as_fit{.shape = fit.shapes()[primitive],
                            .mixture = {.noise = 0.02 * fit.options().size, .outliers = 0.0},
                            .cost = 0.0};
    const std::vector<Shape> shapes = alternative_shapes(as_fit, own);
    std::vector<Candidate> candidates(shapes.size(), Candidate{fit, {primitive}});
    in_parallel(candidates.size(), [&](std::size_t i) {
      candidates[i].fit.replace(primitive, shapes[i]);
      for (int k = 0; k < alternative_sweeps; ++k)
        if (!candidates[i].fit.sweep(candidates[i].changed)) break;
    });
    sort(candidates);
    if (candidates.front().fit.cost() >= 0.999 * fit.cost()) continue;
    fit = candidates.front().fit;
    gained = true;
  }
  return gained;
}

}  // namespace

UnionFit refined(UnionFit fit, int sweeps, const std::function<bool()>& interrupted) {
  for (int round = 0; round < 3; ++round) {
    for (int k = 0; k < sweeps && !interrupted(); ++k)
      if (!fit.sweep()) break;
    if (interrupted() || !try_alternatives(fit, interrupted)) break;
  }
  return fit;
}

UnionFit grown(const UnionFit& fit, const std::function<bool()>& interrupted) {
  std::vector<Candidate> candidates;
  add_halves(fit, candidates);
  add_new(fit, candidates);
  in_parallel(candidates.size(), [&](std::size_t i) {
    Candidate& candidate = candidates[i];
    candidate.fit.vary(Family::plain);  // a new primitive that also bends and tapers loses its way
    for (int k = 0; k < candidate_sweeps && !interrupted(); ++k)
      if (!candidate.fit.sweep(candidate.changed)) break;
    candidate.fit.vary(fit.options().family);
    for (int k = 0; k < joint_sweeps && !interrupted(); ++k) candidate.fit.sweep();
  });
  sort(candidates);
  if (candidates.size() > finalists) candidates.resize(finalists, candidates.front());
  in_parallel(candidates.size(), [&](std::size_t i) {
    for (int k = 0; k < refining_sweeps && !interrupted(); ++k)
      if (!candidates[i].fit.sweep()) break;
  });
  sort(candidates);
  return refined(candidates.front().fit, refining_sweeps, interrupted);
}

UnionFit exchanged(const UnionFit& fit, const std::function<bool()>& interrupted) {
  const UnionFit more = grown(fit, interrupted);
  std::vector<Candidate> candidates(more.shapes().size(), Candidate{more, {}});
  in_parallel(candidates.size(), [&](std::size_t i) {
    candidates[i].fit.remove(i);
    for (int k = 0; k < candidate_sweeps && !interrupted(); ++k)
      if (!candidates[i].fit.sweep()) break;
  });
  sort(candidates);
  return refined(candidates.front().fit, refining_sweeps, interrupted);
}

}  // namespace verisq::recovery
