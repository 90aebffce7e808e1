/// Models of clouds and meshes, and models within or around a mesh, until that is proven.
#include "verisq/recovery.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>

#include "host/prepare/superquadric_fit.hpp"
#include "host/prepare/surface_samples.hpp"
#include "host/prepare/union_fit.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/error.hpp"
#include "verisq/mesh_topology.hpp"

namespace verisq {
namespace {

using namespace recovery;

constexpr std::size_t least_points = 12;        // a superquadric has eleven parameters
constexpr std::size_t most_points = 20'000;     // of a cloud or mesh that are looked at
constexpr std::size_t searched_points = 4'000;  // of those, while a union is searched
constexpr double largest_of_parts = 1.25;       // exponent, while parts are looked for
constexpr std::size_t most_primitives = 64;
constexpr double flat = 1e-9;      // extent across a plane over that along it
constexpr double exact = 1e-8;     // root of the mean square over the size: nothing is left to gain
constexpr double harmless = 1.01;  // cost without a primitive over that with it
constexpr int most_exchanges = 6;
constexpr double worth_an_exchange = 0.97;  // cost after it over that before
constexpr int sweeps = 40;
constexpr int pruning_sweeps = 15;
constexpr int last_sweeps = 80;  // primitives that overlap converge slowly, one after the other

void require(bool holds, std::string_view message) {
  if (!holds) throw Error(ErrorKind::input, std::string(message));
}

void check(const RecoveryOptions& options) {
  require(options.primitives >= 1 && options.primitives <= most_primitives,
          fmt::format("primitives: {} is not from 1 to {}", options.primitives, most_primitives));
  require(!options.deviation || (std::isfinite(*options.deviation) && *options.deviation > 0.0),
          "deviation: is not a positive number");
  require(options.most_outliers >= 0.0 && options.most_outliers <= 0.9, "outliers: are not a share from 0 to 0.9");
}

/// Throws Error(input) for clouds that no solid can be made of.
void check(std::span<const Eigen::Vector3d> points) {
  require(
      points.size() >= least_points,
      fmt::format("{} points are too few for a superquadric, which takes at least {}", points.size(), least_points));
  require(std::ranges::all_of(points, [](const Eigen::Vector3d& point) { return point.allFinite(); }),
          "a coordinate is not finite");
  const Eigen::Vector3d half = box_along(points, principal_axes(points)).half;
  require(half.minCoeff() > flat * half.maxCoeff(), "all points lie in a plane, or nearly so");
}

/// At most `most` of the points, chosen at random, in their order.
std::vector<Eigen::Vector3d> thinned(std::span<const Eigen::Vector3d> points, std::size_t most, std::uint64_t seed) {
  std::vector<Eigen::Vector3d> chosen;
  std::mt19937_64 random(seed);
  std::size_t left = std::min(most, points.size());
  for (std::size_t i = 0; i < points.size() && left > 0; ++i) {
    if (fraction(random) * static_cast<double>(points.size() - i) >= static_cast<double>(left)) continue;
    chosen.push_back(points[i]);
    --left;
  }
  return chosen;
}

double size_of(std::span<const Eigen::Vector3d> points) {
  return box_along(points, Eigen::Matrix3d::Identity()).half.maxCoeff();
}

/// The best fit from a straight superquadric, and from no start.
MixtureFit best_single(std::span<const Eigen::Vector3d> points, const RecoveryOptions& options, double most_outliers) {
  const Family family = family_of(options.taper, options.bend);
  const MixtureFit plain = recover_single(points, {Family::plain, options.seed, most_outliers});
  if (family == Family::plain) return plain;
  const double size = size_of(points);
  const MixtureFit deformed = fit_mixture(points, plain.shape, plain.mixture,
                                          {.family = family,
                                           .size = size,
                                           .area_over_volume = 1.5 / size,
                                           .least_noise = std::min(1e-9 * size, plain.mixture.noise),
                                           .most_outliers = most_outliers,
                                           .iterations = 100,
                                           .precision = 1e-9});
  const MixtureFit other = recover_single(points, {family, options.seed, most_outliers});
  return other.mixture.noise * (1.0 + other.mixture.outliers) <
                 deformed.mixture.noise * (1.0 + deformed.mixture.outliers)
             ? other
             : deformed;
}

/// The points that belong to the shape rather than to outliers.
std::vector<Eigen::Vector3d> inliers(std::span<const Eigen::Vector3d> points, const MixtureFit& fit) {
  const DistanceToShape distance(fit.shape, Family::plain);
  // The distance at which both are equally likely: a surface's density falls to that of outliers within a few times the
  // noise.
  constexpr double farthest = 3.0;
  if (fit.mixture.outliers <= 2e-3) return {points.begin(), points.end()};
  std::vector<Eigen::Vector3d> chosen;
  for (const Eigen::Vector3d& point : points)
    if (std::abs(distance.value(point)) <= farthest * fit.mixture.noise) chosen.push_back(point);
  return chosen.empty() ? std::vector<Eigen::Vector3d>(points.begin(), points.end()) : chosen;
}

/// The data that a recovery has about the surface.
struct Subject {
  std::vector<Eigen::Vector3d> points;
  const Mesh* mesh = nullptr;  ///< null for clouds
  bool closed = false;         ///< the mesh
  /// Null for clouds.
  std::unique_ptr<const verify::TriangleTree> tree = {};
};

bool near_enough(const RecoveryStage& stage, const RecoveryOptions& options) {
  return options.deviation && stage.to_model.percentile_95 <= *options.deviation &&
         (!stage.to_mesh || stage.to_mesh->percentile_95 <= *options.deviation);
}

/// Without the primitives that it does as well without.
UnionFit pruned(UnionFit fit, double no_cost) {
  for (std::size_t i = 0; i < fit.shapes().size() && fit.shapes().size() > 1;) {
    UnionFit less = fit;
    less.remove(i);
    for (int k = 0; k < pruning_sweeps; ++k)
      if (!less.sweep()) break;
    if (less.cost() <= std::max(harmless * fit.cost(), no_cost))
      fit = std::move(less);
    else
      ++i;
  }
  return fit;
}

/// Returns whether outliers may be among the points.
bool strews(const Subject& subject, const RecoveryOptions& options) {
  return subject.mesh == nullptr && options.most_outliers > 0.0;
}

/// Unions have no mixture: outliers are the points in less dense neighbourhoods.
std::vector<Eigen::Vector3d> without_outliers(const Subject& subject, const RecoveryOptions& options) {
  if (!strews(subject, options)) return subject.points;
  return dense_points(thinned(subject.points, searched_points, options.seed));
}

class UnionRecovery {
 public:
  UnionRecovery(const Subject& subject, const RecoveryOptions& options)
      : subject_(subject),
        options_(options),
        points_(without_outliers(subject, options)),
        size_(size_of(points_)),
        samples_{
            .surface = thinned(points_, searched_points, options.seed), .inside = {}, .outside = {}, .beyond = {}} {
    if (!subject.closed) return;
    add_space(*subject.mesh, *subject.tree, samples_);
  }

  Recovery run() {
    options_.progress({1, std::numeric_limits<double>::infinity()});
    // Bends come last: while primitives are still few, they would only wrap parts that other primitives are to fill.
    const UnionOptions union_options{.family = options_.taper ? Family::tapered : Family::plain,
                                     .size = size_,
                                     .outlier_ratio = 0.0,
                                     .noise = size_,
                                     .largest_exponent = largest_of_parts};
    UnionFit fit = first(union_options);
    add_stage(fit);
    const double no_cost = exact * exact * size_ * size_ * static_cast<double>(samples_.surface.size());
    while (fit.shapes().size() < options_.primitives && fit.cost() > no_cost &&
           !near_enough(stages_.back(), options_) && !options_.interrupted()) {
      options_.progress({fit.shapes().size() + 1, stages_.back().to_model.mean});
      UnionFit more = grown(fit, options_.interrupted);
      if (!(more.cost() < fit.cost())) break;
      fit = std::move(more);
      add_stage(fit);
    }
    improve(fit, no_cost);
    if (!options_.interrupted()) {
      fit = pruned(std::move(fit), no_cost);
      fit.vary(family_of(options_.taper, options_.bend));
      if (options_.bend) bend(fit, no_cost);
      polish(fit);
    }
    return {.model = model_of(shapes_),
            .stages = std::move(stages_),
            .outliers = outliers(),
            .points = subject_.points.size(),
            .interrupted = options_.interrupted()};
  }

 private:
  /// Growing one by one may divide a solid where it has no seam: primitives change places as long as that pays.
  void improve(UnionFit& fit, double no_cost) {
    for (int k = 0; k < most_exchanges; ++k) {
      if (fit.shapes().size() < 2 || fit.cost() <= no_cost || near_enough(stages_.back(), options_) ||
          options_.interrupted())
        return;
      UnionFit other = exchanged(fit, options_.interrupted);
      if (!(other.cost() < worth_an_exchange * fit.cost())) return;
      fit = std::move(other);
      stages_.pop_back();
      add_stage(fit);
    }
  }

  /// One bent primitive may then replace two straight ones. `polish` leaves one stage for each number.
  void bend(UnionFit& fit, double no_cost) {
    for (int k = 0; k < sweeps && !options_.interrupted(); ++k)
      if (!fit.sweep()) break;
    add_stage(fit);
    improve(fit, no_cost);
  }

  /// From the likeliest superquadric, which may reach far beyond the surface, and from an ellipsoid in the box.
  [[nodiscard]] UnionFit first(const UnionOptions& union_options) const {
    Shape likeliest = recover_single(samples_.surface, {Family::plain, options_.seed, 0.0}).shape;
    likeliest = limited(likeliest, size_, largest_part);
    likeliest.exponents = likeliest.exponents.cwiseMin(union_options.largest_exponent);
    Shape ellipsoid;
    ellipsoid.rotation = principal_axes(samples_.surface);
    const OrientedBox box = box_along(samples_.surface, ellipsoid.rotation);
    ellipsoid.centre = box.centre;
    ellipsoid.axes = box.half;
    const UnionFit a = refined(UnionFit(samples_, union_options, {likeliest}), sweeps, options_.interrupted);
    const UnionFit b = refined(UnionFit(samples_, union_options, {ellipsoid}), sweeps, options_.interrupted);
    return a.cost() <= b.cost() ? a : b;
  }

  /// The share of outliers among the tested points.
  [[nodiscard]] double outliers() const {
    if (!strews(subject_, options_)) return 0.0;
    const std::size_t asked = std::min(subject_.points.size(), searched_points);
    return 1.0 - static_cast<double>(points_.size()) / static_cast<double>(asked);
  }

  void add_stage(const UnionFit& fit) {
    shapes_ = fit.shapes();
    stages_.push_back(stage_of(shapes_, points_, subject_.tree.get(), options_.seed));
  }

  /// One primitive may have the whole surface: then the method for points finds it, pointed or not.
  [[nodiscard]] bool alone(const UnionFit& fit) const {
    return fit.shapes().size() == 1 && !strews(subject_, options_);
  }

  /// Polishes the fit of the chosen number of primitives, with all points.
  void polish(const UnionFit& fit) {
    UnionSamples all = samples_;
    all.surface = points_;
    const UnionFit blunt = swept(UnionFit(all, fit.options(), fit.shapes()));
    std::vector<UnionFit> candidates{pointed(blunt), blunt};
    if (alone(fit)) {
      const Shape likeliest = best_single(points_, options_, 0.0).shape;
      candidates.push_back(pointed(UnionFit(all, fit.options(), {likeliest})));
    }
    std::vector<RecoveryStage> stages;
    std::vector<double> astray;
    for (const UnionFit& candidate : candidates) {
      stages.push_back(stage_of(candidate.shapes(), points_, subject_.tree.get(), options_.seed));
      astray.push_back(strays(stages.back(), candidate));
    }
    const auto best = static_cast<std::size_t>(std::ranges::min_element(astray) - astray.begin());
    shapes_ = candidates[best].shapes();
    while (!stages_.empty() && stages_.back().primitives >= shapes_.size()) stages_.pop_back();
    stages_.push_back(stages[best]);
  }

  [[nodiscard]] UnionFit pointed(UnionFit fit) const {
    fit.allow_exponents(recovery::largest_exponent);
    return swept(std::move(fit));
  }

  [[nodiscard]] UnionFit swept(UnionFit fit) const {
    for (int k = 0; k < last_sweeps && !options_.interrupted(); ++k)
      if (!fit.sweep()) break;
    return fit;
  }

  /// The distance of the surface from the union and, for a mesh, of the union from the surface: only the latter reveals
  /// parts that reach out between the samples of the space.
  [[nodiscard]] static double strays(const RecoveryStage& stage, const UnionFit& fit) {
    return stage.to_mesh ? stage.to_model.mean + stage.to_mesh->mean : fit.cost();
  }

  const Subject& subject_;
  const RecoveryOptions& options_;
  std::vector<Eigen::Vector3d> points_;
  double size_;
  UnionSamples samples_;
  std::vector<Shape> shapes_;
  std::vector<RecoveryStage> stages_;
};

Recovery recover_one(const Subject& subject, const RecoveryOptions& options) {
  options.progress({1, std::numeric_limits<double>::infinity()});
  const MixtureFit fit = best_single(subject.points, options, subject.mesh == nullptr ? options.most_outliers : 0.0);
  const std::vector<Eigen::Vector3d> own = inliers(subject.points, fit);
  const std::array shapes{fit.shape};
  return {.model = model_of(shapes),
          .stages = {stage_of(shapes, own, subject.tree.get(), options.seed)},
          .outliers = 1.0 - static_cast<double>(own.size()) / static_cast<double>(subject.points.size()),
          .points = subject.points.size(),
          .interrupted = options.interrupted()};
}

Recovery recover(const Subject& subject, const RecoveryOptions& options) {
  check(subject.points);
  // A closed mesh determines its inside, which a cloud does not: unions can use that.
  const bool one = options.primitives == 1 && !subject.closed;
  return one ? recover_one(subject, options) : UnionRecovery(subject, options).run();
}

}  // namespace

Recovery recover(std::span<const Point> cloud, const RecoveryOptions& options) {
  check(options);
  std::vector<Eigen::Vector3d> points;
  points.reserve(cloud.size());
  for (const Point& point : cloud) points.emplace_back(point.data());
  return recover(Subject{.points = thinned(points, most_points, options.seed)}, options);
}

Recovery recover(const Mesh& mesh, const RecoveryOptions& options) {
  if (mesh.triangles.empty()) return recover(mesh.vertices, options);
  check(options);
  std::mt19937_64 random(options.seed);
  return recover(Subject{.points = sample_mesh(mesh, most_points, random),
                         .mesh = &mesh,
                         .closed = mesh_topology(mesh).closed(),
                         .tree = std::make_unique<const verify::TriangleTree>(verify::triangles_of(mesh))},
                 options);
}

namespace {

using namespace recovery;

constexpr std::size_t surface_samples = 20'000;
constexpr std::array penalties{3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 1e5};  // of a point astray; others count 1
constexpr int sweeps_a_penalty = 25;
constexpr int most_proofs = 12;
constexpr double least_growth = 1e-5;  // of the mesh's size: what a proof needs to end soon
constexpr double faster = 3.0;         // growth over that before, once a proof has failed

/// The shape with semi-axes longer by `growth`, or shorter: at least a thousandth of them is left.
Shape with_longer_axes(Shape shape, double growth) {
  shape.axes = (shape.axes.array() + growth).max(1e-3 * shape.axes.array());
  return shape;
}

/// The fit between two proofs.
class OneSidedFit {
 public:
  OneSidedFit(const Mesh& mesh, const verify::TriangleTree& tree, std::vector<Shape> shapes, Containment containment,
              const RecoveryOptions& options)
      : around_(containment == Containment::around), shapes_(std::move(shapes)), interrupted_(options.interrupted) {
    std::mt19937_64 random(options.seed);
    samples_.surface = sample_mesh(mesh, surface_samples, random);
    add_space(mesh, tree, samples_);
    for (const Eigen::Vector3d& point : samples_.surface) guard(point);
    guard_corners(mesh);
    options_ = {.family = family_of(options.taper, options.bend),
                .size = box_along(samples_.surface, Eigen::Matrix3d::Identity()).half.maxCoeff()};
    growth_ = least_growth * options_.size;
  }

  /// Adds a sample: no point of the mesh may be on the wrong side there.
  void guard(const Eigen::Vector3d& point) {
    if (around_) {
      samples_.inside.push_back(point);
    } else {
      samples_.outside.push_back(point);
      samples_.beyond.push_back(0.0);
    }
  }

  void refit() {
    const std::span<const double> all(penalties);
    for (const double penalty : fitted_ ? all.last(1) : all) {
      (around_ ? options_.inside_weight : options_.outside_weight) = penalty;
      UnionFit fit(samples_, options_, shapes_);
      for (int k = 0; k < sweeps_a_penalty && !interrupted_(); ++k)
        if (!fit.sweep()) break;
      shapes_ = fit.shapes();
      astray_ = astray(fit);
    }
    fitted_ = true;
  }

  [[nodiscard]] std::size_t size() const { return shapes_.size(); }

  /// The fitted shapes, each so much larger, or smaller, that none of its samples is astray.
  [[nodiscard]] std::vector<Shape> shapes() const {
    std::vector<Shape> shapes = shapes_;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const double growth = astray_[i] + growth_;
      shapes[i] = with_longer_axes(shapes[i], around_ ? growth : -growth);
    }
    return shapes;
  }

  /// After a proof that failed.
  void grow() { growth_ *= faster; }

  void remove(std::size_t shape) { shapes_.erase(shapes_.begin() + static_cast<std::ptrdiff_t>(shape)); }

 private:
  /// Vertices that no triangle uses are no part of the surface.
  void guard_corners(const Mesh& mesh) {
    std::vector<bool> guarded(mesh.vertices.size(), false);
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (!guarded[corner]) guard(Eigen::Vector3d(mesh.vertices[corner].data()));
        guarded[corner] = true;
      }
    }
  }

  /// For each primitive: an upper bound, to first order, of how far the samples nearest to it are astray.
  [[nodiscard]] std::vector<double> astray(const UnionFit& fit) const {
    const std::vector<double> distances = fit.distances();
    const std::vector<std::size_t> owners = fit.owners();
    const std::size_t first_outside = samples_.surface.size() + samples_.inside.size();
    std::vector<double> most(shapes_.size(), 0.0);
    for (std::size_t i = around_ ? samples_.surface.size() : first_outside;
         i < (around_ ? first_outside : distances.size()); ++i)
      most[owners[i]] = std::max(most[owners[i]], around_ ? distances[i] : -distances[i]);
    return most;
  }

  bool around_;
  std::vector<Shape> shapes_;
  std::function<bool()> interrupted_;
  UnionSamples samples_;
  UnionOptions options_;
  bool fitted_ = false;
  std::vector<double> astray_;
  double growth_ = 0.0;
};

std::vector<Shape> shapes_of(const Model& model) {
  std::vector<Shape> shapes;
  for (const Primitive& primitive : model.primitives) shapes.push_back(shape_of(primitive));
  return shapes;
}

/// Removes the primitives that lie beside the mesh, as long as others are left.
void remove_outside(const Model& model, std::span<const std::string> names, OneSidedFit& fit) {
  for (std::size_t i = model.primitives.size(); i-- > 0;)
    if (fit.size() > 1 && std::ranges::count(names, model.primitives[i].name) > 0) fit.remove(i);
}

}  // namespace

ContainedRecovery recover_contained(const Mesh& mesh, Containment containment, const RecoveryOptions& options,
                                    const ContainmentOptions& proof_options) {
  if (!bounds_for_containment(mesh_topology(mesh)))
    throw Error(ErrorKind::input, "the mesh is not closed: nothing can be within or around it");
  ContainedRecovery result{.recovery = recover(mesh, options), .proof = {}, .proofs = 0};
  const verify::TriangleTree tree(verify::triangles_of(mesh));
  OneSidedFit fit(mesh, tree, shapes_of(result.recovery.model), containment, options);
  while (!result.proof.proven && result.proofs < most_proofs && !options.interrupted()) {
    fit.refit();
    if (options.interrupted()) break;
    result.recovery.model = model_of(fit.shapes());
    result.proof = prove_containment(result.recovery.model, mesh, containment, proof_options);
    ++result.proofs;
    for (const PointAcross& across : result.proof.across) fit.guard(Eigen::Vector3d(across.point.data()));
    remove_outside(result.recovery.model, result.proof.centres_outside, fit);
    fit.grow();
  }
  result.recovery.interrupted = result.recovery.interrupted || options.interrupted();
  if (result.proofs == 0) return result;
  std::mt19937_64 random(options.seed);
  result.recovery.stages.push_back(
      stage_of(shapes_of(result.recovery.model), sample_mesh(mesh, surface_samples, random), &tree, options.seed));
  result.recovery.stages.back().containment = containment;
  return result;
}

}  // namespace verisq
