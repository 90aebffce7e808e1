/// Models of clouds and meshes, and on which side of a mesh they are proven to lie.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/hidden.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Proves that a model lies within the solid that a closed mesh bounds, or around it.
//
// The mesh counts as its binary64 corners state it, its triangles may cross each other. Its solid is what they part
// from infinity an odd number of times. A model that is proven to be around it contains all that they part from
// infinity.

enum class Containment : std::uint8_t {
  within,  ///< every point of the model is a point of the mesh's solid, its surface included
  around,  ///< every point of the mesh's solid is a point of the model
};

struct ContainmentOptions {
  std::uint64_t most_samples = 1U << 24U;  ///< distances asked for, about; then what is open stays undecided
  std::string device = "auto";             ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };  ///< polled; true ends early
};

/// Four primitives, their indices ascending, and a point of all of them.
struct CommonPoint {
  std::array<std::uint32_t, 4> primitives;
  Point point;
};

/// Proves that a union has no cavity: some of its primitives are apart, some have a point in common. Three primitives
/// or fewer need no certificate. A model within a mesh needs none: model and mesh are all the proof.
struct ContainmentCertificate {
  std::vector<Separation> apart;  ///< both of the same model, a before b
  std::vector<CommonPoint> common;
};

struct ContainmentFinding {
  Verdict verdict;
  std::string open;  ///< the first thing that is not proven; empty where all is
};

/// Proves a containment again: MPFR, no OpenCL, no solver. Immutable: safe to call from many threads.
class ContainmentChecker {
 public:
  /// Throws Error(input) for a model that has set operations or is none, and for a mesh that is not closed or not
  /// turned alike all over. Precondition: triangles of vertices that are there, finite coordinates.
  ContainmentChecker(const Model& model, const Mesh& mesh);

  /// `within` of a mesh in one part. `around` of unbent primitives alone.
  [[nodiscard]] ContainmentFinding operator()(Containment claim, const ContainmentCertificate& certificate,
                                              const CheckOptions& options = {}) const;

 private:
  struct State;
  Hidden<State> state_;
};

/// A point of the mesh, to within rounding, that contradicts it.
struct PointAcross {
  Point point;
  double excess;  ///< from above: how deep in a primitive (`within`), or how far from the model (`around`)
};

struct ContainmentProof {
  Containment containment = Containment::within;  ///< what was asked
  bool proven = false;
  std::uint64_t triangles_proven = 0;   ///< on the side where they should be
  std::uint64_t triangles_refuted = 0;  ///< some point of the triangle is proven to be on the other
  std::uint64_t triangles_undecided = 0;
  /// `within`: of the primitives, those whose centre is not proven to lie inside the mesh.
  std::vector<std::string> centres_outside = {};
  /// `around`: nothing is proven of cavities of the model, in which parts of the mesh's solid could lie.
  bool maybe_with_cavities = false;
  ContainmentCertificate certificate = {};
  std::vector<PointAcross> across = {};  ///< of the points looked at
  std::uint64_t samples = 0;
  bool interrupted = false;
};

/// Whether a mesh bounds a solid that models can be contained in: closed, and no side of more than two triangles.
[[nodiscard]] bool bounds_for_containment(const MeshTopology& topology);

/// Decides it as far as it can (docs/mathematics.md §21); `proven` false is no proof of the contrary. `around` by
/// several primitives is proven of convex ones alone. Throws Error(input) for models with set operations or without
/// primitives, meshes that do not bound a solid as above, coordinates that are not finite, and as Mapper.
[[nodiscard]] ContainmentProof prove_containment(const Model& model, const Mesh& mesh, Containment containment,
                                                 const ContainmentOptions& options);

// Models from point clouds and meshes: one superquadric, or a union of several, by a search in floating point that
// proves nothing.

/// Distances in floating point, of samples: estimated, not proven.
struct EstimatedDeviation {
  double mean;
  double root_mean_square;
  double percentile_95;
  double largest;
};

/// The deviation that a model of so many primitives reached.
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
