/// Steps of single primitives over the samples that they own.
#include "host/recovery/union_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/recovery/damped_step.hpp"

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
    // As if the distance were the residual: what counts is the slope of its square.
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

}  // namespace verisq::recovery
