/// A free recovery, a fit that may cross the mesh's surface on one side alone, a little growth, and a proof; once more,
/// with what the proof found, until it holds.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <string>
#include <utility>

#include "host/recovery/cloud_frame.hpp"
#include "host/recovery/damped_step.hpp"
#include "host/recovery/estimated_deviation.hpp"
#include "host/recovery/mesh_sample.hpp"
#include "host/recovery/space_samples.hpp"
#include "host/recovery/union_fit.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verisq/error.hpp"
#include "verisq/recovery.hpp"

namespace verisq {
namespace {

using namespace recovery;

constexpr std::size_t surface_samples = 20'000;
constexpr std::array penalties{3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 1e5};  // of a point astray; others count 1
constexpr int sweeps_a_penalty = 25;
constexpr int most_proofs = 12;
constexpr double least_growth = 1e-5;  // of the mesh's size: what a proof needs to end soon
constexpr double faster = 3.0;         // growth over that before, once a proof has failed

/// Semi-axes longer by so much, or shorter: at least a thousandth of them is left.
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

  /// No point of the mesh may be on the wrong side there.
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

  /// As fitted, but each so much larger, or smaller, that none of its samples is astray.
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

  /// Of each primitive, how far the samples that are nearest to it are astray, at most, to first order.
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

/// Those that lie beside the mesh, as long as others are left.
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
