/// Models from point clouds and meshes: one superquadric, or a union of several, by a search in floating point that
/// proves nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/containment.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Distances in floating point, of samples: estimated, not proven.
struct EstimatedDeviation {
  double mean;
  double root_mean_square;
  double percentile_95;
  double largest;
};

/// What a model of so many primitives reached.
struct RecoveryStage {
  std::size_t primitives;
  EstimatedDeviation to_model;                     ///< of points that are no outliers, or of samples of the mesh
  std::optional<EstimatedDeviation> to_mesh = {};  ///< of samples of the model's surface; nothing for clouds
  std::optional<Containment> containment = {};     ///< what the model was then fitted to, if anything
};

struct RecoveryProgress {
  std::size_t primitives;  ///< of the model that is being searched
  double mean_deviation;   ///< of the last one found, estimated; infinite before the first
};

struct RecoveryOptions {
  std::size_t primitives = 1;            ///< at most so many
  std::optional<double> deviation = {};  ///< fewer, once 95 % of both deviations are at most this, in model units; > 0
  bool taper = false;                    ///< primitives may be tapered
  bool bend = false;                     ///< primitives may be bent
  double most_outliers = 0.6;            ///< share of a cloud's points that may belong to nothing, from 0 to 0.9
  std::uint64_t seed = 1;                ///< the same seed gives the same model, however many threads there are
  std::function<bool()> interrupted = [] { return false; };  ///< polled; true: the best so far is returned
  std::function<void(const RecoveryProgress&)> progress = [](const RecoveryProgress&) {};
};

struct Recovery {
  Model model;                        ///< the union of its primitives, without units
  std::vector<RecoveryStage> stages;  ///< one for each number of primitives that was tried; the last is the model's
  double outliers;                    ///< share of the points that belong to nothing, estimated; 0 of meshes
  std::size_t points;                 ///< of the cloud, or sampled on the mesh
  bool interrupted;
};

/// The likeliest superquadric, or union, for points on its surface: moved by noise, missing in parts, some of them
/// outliers. Source: a mixture of the surface and of outliers as in Liu et al., CVPR 2022; distances to first order
/// (Taubin, PAMI 1991). Throws Error(input) for fewer than 12 points, points that are not finite or lie in a plane, and
/// options out of their ranges.
[[nodiscard]] Recovery recover(std::span<const Point> cloud, const RecoveryOptions& options);

/// The same for samples of a mesh's surface, uniform by area; several primitives also fill its inside, as far as it is
/// closed. A mesh without triangles is the cloud of its vertices. Throws as above.
[[nodiscard]] Recovery recover(const Mesh& mesh, const RecoveryOptions& options);

struct ContainedRecovery {
  Recovery recovery;       ///< its model is the contained one, and so is the last of its stages, where proofs > 0
  ContainmentProof proof;  ///< of that model
  std::size_t proofs;      ///< that were tried
};

/// The same, then fitted to lie within the mesh's solid or around it, as close to its surface as it can, until that is
/// proven; where it cannot be, with the last proof that was tried. Throws Error(input) as above and as
/// `prove_containment`.
[[nodiscard]] ContainedRecovery recover_contained(const Mesh& mesh, Containment containment,
                                                  const RecoveryOptions& options, const ContainmentOptions& proof);

}  // namespace verisq
