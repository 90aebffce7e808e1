/// This file implements union_fit.hpp.
#include "host/prepare/union_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/prepare/superquadric_fit.hpp"
#include "host/prepare/surface_samples.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::recovery {
namespace {

constexpr double most_excess = 20.0;  // of a residual over the distance, as a step sees it
constexpr double first_damping = 1e-3;
constexpr double least_damping = 1e-9;
constexpr double most_damping = 1e5;
constexpr double least_gain = 1e-7;

Shape with_exponents_up_to(Shape shape, double largest) {
  shape.exponents = shape.exponents.cwiseMin(largest);
  return shape;
}

}  // namespace

UnionFit::UnionFit(const UnionSamples& samples, const UnionOptions& options, std::vector<Shape> shapes)
    : samples_(&samples), options_(options), shapes_(std::move(shapes)) {
  std::vector<Eigen::Vector3d> points = samples.surface;
  points.insert(points.end(), samples.inside.begin(), samples.inside.end());
  points.insert(points.end(), samples.outside.begin(), samples.outside.end());
  count_ = points.size();
  blocks_ = blocks_of(points);
  const std::size_t first_inside = samples.surface.size();
  const std::size_t first_outside = first_inside + samples.inside.size();
  for (std::size_t i = first_inside; i < count_; ++i)
    blocks_[i / lanes].present[i % lanes] = i < first_outside ? options.inside_weight : options.outside_weight;
  distances_.resize(shapes_.size());
  damping_.assign(shapes_.size(), first_damping);
  for (std::size_t i = 0; i < shapes_.size(); ++i) measure(shapes_[i], distances_[i]);
  refresh();
}

void UnionFit::measure(const Shape& shape, std::vector<double>& distances) const {
  distances.resize(blocks_.size() * lanes);
  if (shape.curvature.isZero(0.0)) {
    distances_to(blocks_, shape, distances);
    return;
  }
  const DistanceToShape distance(shape, options_.family);
  for (std::size_t i = 0; i < count_; ++i) {
    const PointBlock& block = blocks_[i / lanes];
    distances[i] = distance.value({block.x[i % lanes], block.y[i % lanes], block.z[i % lanes]});
  }
}

double UnionFit::residual(std::size_t sample, double distance) const {
  if (sample < samples_->surface.size()) return distance;
  const std::size_t first_outside = samples_->surface.size() + samples_->inside.size();
  if (sample < first_outside) return std::max(distance, 0.0);
  return distance < 0.0 ? distance - samples_->beyond[sample - first_outside] : 0.0;
}

double UnionFit::cost_with(const std::vector<double>& others, const std::vector<double>& own) const {
  const std::size_t surface = samples_->surface.size();
  const std::size_t inside = surface + samples_->inside.size();
  double sum = 0.0;
  const double precision = 0.5 / (options_.noise * options_.noise);
  for (std::size_t i = 0; i < surface; ++i) {
    const double distance = std::min(others[i], own[i]);
    const double square = distance * distance;
    sum += options_.outlier_ratio > 0.0 ? -std::log(std::exp(-precision * square) + options_.outlier_ratio) / precision
                                        : square;
  }
  for (std::size_t i = surface; i < inside; ++i) {
    const double distance = std::max(std::min(others[i], own[i]), 0.0);
    sum += options_.inside_weight * distance * distance;
  }
  for (std::size_t i = inside; i < count_; ++i) {
    const double distance = residual(i, std::min(others[i], own[i]));
    sum += options_.outside_weight * distance * distance;
  }
  return sum;
}

std::vector<double> UnionFit::others_of(std::size_t primitive) const {
  std::vector<double> others(count_, std::numeric_limits<double>::infinity());
  for (std::size_t j = 0; j < shapes_.size(); ++j) {
    if (j == primitive) continue;
    for (std::size_t i = 0; i < count_; ++i) others[i] = std::min(others[i], distances_[j][i]);
  }
  return others;
}

std::vector<double> UnionFit::distances() const {
  return others_of(shapes_.size());
}

std::vector<std::size_t> UnionFit::owners() const {
  std::vector<std::size_t> owners(count_);
  for (std::size_t i = 0; i < count_; ++i)
    for (std::size_t j = 1; j < shapes_.size(); ++j)
      if (distances_[j][i] < distances_[owners[i]][i]) owners[i] = j;
  return owners;
}

void UnionFit::refresh() {
  const std::vector<double> all = distances();
  cost_ = cost_with(all, all);
}

void UnionFit::replace(std::size_t primitive, const Shape& shape) {
  shapes_[primitive] = shape;
  damping_[primitive] = first_damping;
  measure(shape, distances_[primitive]);
  refresh();
}

void UnionFit::add(const Shape& shape) {
  shapes_.push_back(shape);
  damping_.push_back(first_damping);
  measure(shape, distances_.emplace_back());
  refresh();
}

void UnionFit::remove(std::size_t primitive) {
  const auto at = static_cast<std::ptrdiff_t>(primitive);
  shapes_.erase(shapes_.begin() + at);
  damping_.erase(damping_.begin() + at);
  distances_.erase(distances_.begin() + at);
  refresh();
}

bool UnionFit::step(std::size_t primitive) {
  if (bends(options_.family)) return step_of<most_parameters>(primitive);
  if (tapers(options_.family)) return step_of<12>(primitive);
  return step_of<11>(primitive);
}

template <int N>
bool UnionFit::step_of(std::size_t primitive) {
  const std::vector<double> others = others_of(primitive);
  const std::vector<double>& own = distances_[primitive];
  std::vector<Eigen::Vector3d> points;
  std::vector<double> weights;
  for (std::size_t i = 0; i < count_; ++i) {
    if (own[i] >= others[i] || residual(i, own[i]) == 0.0) continue;
    const PointBlock& block = blocks_[i / lanes];
    points.emplace_back(block.x[i % lanes], block.y[i % lanes], block.z[i % lanes]);
    // Weighted as if the distance were the residual: the slope of its square counts.
    const double excess = residual(i, own[i]) / own[i];
    weights.push_back(block.present[i % lanes] * std::min(excess, most_excess));
  }
  if (points.size() < 6) return false;
  const MixtureTerms terms{0.5 / (options_.noise * options_.noise), options_.outlier_ratio};
  NormalEquations<N> equations;
  if constexpr (N == most_parameters) {
    equations.matrix.setZero();
    equations.gradient.setZero();
    const DistanceToShape distance(shapes_[primitive], options_.family);
    SurfaceDistance at;
    for (std::size_t i = 0; i < points.size(); ++i) {
      distance.evaluate(points[i], at);
      const double likelihood = std::exp(-std::min(terms.precision * at.value * at.value, 600.0));
      const double weight = weights[i] * likelihood / (likelihood + terms.ratio);
      equations.gradient += weight * at.value * at.derivatives;
      equations.matrix.noalias() += weight * at.derivatives * at.derivatives.transpose();
    }
  } else {
    std::vector<PointBlock> blocks = blocks_of(points);
    for (std::size_t i = 0; i < points.size(); ++i) blocks[i / lanes].present[i % lanes] = weights[i];
    std::vector<double> unused(blocks.size() * lanes);
    const WeightedSums sums = weighted_sums(blocks, shapes_[primitive], tapers(options_.family), terms, unused);
    for (int i = 0; i < N; ++i) {
      equations.gradient[i] = sums.gradient[i];
      for (int j = i; j < N; ++j) equations.matrix(i, j) = equations.matrix(j, i) = sums.matrix[i][j];
    }
  }
  std::vector<double> trial_distances;
  for (double& damping = damping_[primitive]; damping < most_damping; damping *= 8.0) {
    const Shape trial = with_exponents_up_to(
        limited(moved(shapes_[primitive], damped_step<N>(equations, damping, shapes_[primitive], options_.size)),
                options_.size, largest_part),
        options_.largest_exponent);
    measure(trial, trial_distances);
    const double cost = cost_with(others, trial_distances);
    if (!(cost < cost_)) continue;
    const bool gained = cost < cost_ * (1.0 - least_gain);
    shapes_[primitive] = trial;
    std::swap(distances_[primitive], trial_distances);
    cost_ = cost;
    damping = std::max(least_damping, damping / 6.0);
    return gained;
  }
  damping_[primitive] = first_damping;
  return false;
}

bool UnionFit::sweep(std::span<const std::size_t> primitives) {
  bool gained = false;
  for (const std::size_t primitive : primitives) gained = step(primitive) || gained;
  return gained;
}

bool UnionFit::sweep() {
  std::vector<std::size_t> all(shapes_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return sweep(all);
}

namespace {

constexpr std::size_t space_points = 8'000;  // of the grid about a closed mesh
constexpr double grid_steps_near = 2.0;      // so near the grid cannot tell how long a primitive is

}  // namespace

void add_space(const Mesh& mesh, const verify::TriangleTree& tree, UnionSamples& samples) {
  const GridSample space = sample_space(mesh, space_points);
  samples.inside.insert(samples.inside.end(), space.inside.begin(), space.inside.end());
  for (const Eigen::Vector3d& point : space.outside) {
    const double distance = tree.nearest({point[0], point[1], point[2]}).distance.hi;
    samples.outside.push_back(point);
    samples.beyond.push_back(std::max(0.0, distance - grid_steps_near * space.step));
  }
}

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

/// Tries one primitive in another parametrisation, and keeps it if the union is better.
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
