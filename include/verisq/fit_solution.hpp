/// A fit's requirements and its solution: the pose and the sizes of an implant, and the proof of how well it serves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq {

// A fit's requirements, and the problem that follows: which side of which surface, areas, features that are kept.

enum class Completion : std::uint8_t { cementless, cemented };

/// The solid or room that the mesh bounds.
enum class FitSurface : std::uint8_t {
  cavity,   ///< the room that the implant lies in
  bone,     ///< what it lies outside of
  unsided,  ///< sides do not matter
};

/// The range that a change of a feature, or an area of contact, must lie in.
struct KeptFeature {
  /// As implant_changes names it; of contact, in percent: "contact" (of the mesh's area), "contact:AREA" (of one area
  /// of it), "implant_contact" (of the surface of the primitives that have to lie on a side; of all where none has to).
  std::string name;
  Enclosure range;
};

/// One implant of a series, as its file has it.
struct FitImplant {
  std::string name;  ///< stands for it in messages
  UncertainModel model;
  FemurLandmarks landmarks = {};    ///< points that it names
  std::vector<AreaBox> areas = {};  ///< of the bone
};

/// The bone's landmarks, each known to within `radius`.
struct FitLandmarks {
  std::string name;  ///< stands for them in messages
  FemurLandmarks points;
  std::optional<Side> side = {};
  double radius = 0.0;  ///< model units, >= 0
};

/// Fields have the names of `verisq fit`'s options, and messages name them so. Lengths are in model units.
struct FitRequest {
  std::vector<FitImplant> implants;
  std::string mesh_name;  ///< stands for the mesh in messages
  Mesh mesh;
  std::optional<FitSurface> surface = {};  ///< nothing: a closed mesh whose normals point inward is a cavity
  std::optional<Plane> resection = {};     ///< in which the bone is cut
  std::vector<std::string> crossing = {};  ///< primitives that may pass through the opening, and lie anywhere
  std::vector<std::string> outside = {};   ///< primitives that have to lie outside of the cavity
  std::optional<FitLandmarks> landmarks = {};
  std::vector<KeptFeature> kept = {};
  FitObjective objective = FitObjective::fitness;
  bool implant_contact = false;  ///< whether the implant's area of contact is asked for, too
  Completion completion = Completion::cementless;
  std::optional<double> gap = {};            ///< finite, >= 0; by default 2, where the implants' units are mm
  std::optional<double> gap_tolerance = {};  ///< finite, > 0; of cemented completion, by default half the gap
  double penetration_limit = 0.0;            ///< finite, >= 0
  std::optional<bool> on_triangles = {};     ///< whether triangles keep the limit, too; by default where there are any
  Pose pose_start = {};
  std::optional<double> translation_range = {};  ///< finite, >= 0; by default half the diagonal of the mesh's box
  double rotation_range = 30.0;                  ///< degrees, in [0, 180]
  std::uint64_t seed = 1;
  std::size_t samples = 4096;
  std::optional<Cavity> labelled = {};  ///< areas of all of the mesh's vertices; nothing: the implants' boxes
  std::vector<Area> weights = {};       ///< of areas that are boxes, "elsewhere" among them
  std::string device = "auto";
};

struct FitProblem {
  std::vector<std::string> names;  ///< of the implants
  std::vector<UncertainModel> series;
  std::vector<FemurLandmarks> implant_landmarks;  ///< one an implant
  std::string units;                              ///< of all implants; empty when none has any
  Mesh mesh;                                      ///< cut off at the resection
  FitSurface surface = FitSurface::unsided;
  std::optional<FitLandmarks> bone;   ///< its landmarks, where they are given
  std::vector<KeptFeature> kept;      ///< of features
  std::vector<KeptFeature> contacts;  ///< of contact
  bool implant_contact = false;
  Cavity cavity;                     ///< the vertices of the mesh
  FitOptions options;                ///< but for its constraints: solve_fit adds those of `kept` and `contacts`
  std::vector<std::string> notices;  ///< what was taken for granted, a sentence each
};

/// Checks what is asked for, of each thing and of all together. Throws Error(input) naming option and file as `verisq
/// fit` does: for implants that a fit does not know, units that differ, a surface of which it has to be said what it
/// is, or that is not what is said, primitives, areas and features that are not there.
[[nodiscard]] FitProblem fit_problem(FitRequest request);

/// The changes of the bone's features by this implant of the series in this pose; empty without the bone's landmarks.
[[nodiscard]] FemurFeatures changes_of(const FitProblem& problem, std::size_t implant, const Pose& pose);

/// Whether a number known to be within `value` lies in the range; nothing where that is open.
[[nodiscard]] std::optional<bool> is_within(const Enclosure& value, const Enclosure& range);

/// Every change that a range is asked of is there, and proven to be within it.
[[nodiscard]] bool is_preserved(const FemurFeatures& changes, std::span<const KeptFeature> kept);

// The conditions on a fit: each with what is proven of it, and whether it keeps the fit from being better.

enum class ConditionUnit : std::uint8_t { none, length, degrees, percent };

/// An end of a range.
enum class RangeEnd : std::uint8_t { lower, upper };

struct FitCondition {
  std::string name;  ///< "smallest distance", "side of stem", a feature, "contact:proximal"
  ConditionUnit unit = ConditionUnit::none;
  std::optional<Enclosure> value = {};  ///< proven; nothing of sides
  std::optional<Enclosure> range = {};  ///< asked of it; nothing of sides
  std::optional<bool> kept = {};        ///< proven, or proven not to be; nothing where that is open
  /// Where the value comes so close to an end of the range that this end may be what keeps the fit from being better:
  /// to a hundredth of the distance on which the fitness changes, of a degree, or to half a percent.
  std::optional<RangeEnd> binds = {};
};

// The best pose of a fit's problem, how near it is to the best possible one, and the proof of what was found.

struct FitSolutionOptions {
  std::optional<double> gap = {};  ///< in (0, 1): asks for a bound, as FitBoundOptions
  std::function<bool()> interrupted = [] { return false; };
  std::function<bool()> out_of_time = [] { return false; };  ///< of the bound
  std::function<bool()> search_out_of_time = {};             ///< of the search and the bound; empty: no limit
  std::function<void(const FitProgress&)> progress = [](const FitProgress&) {};
  std::function<void(const FitBoundProgress&)> bound_progress = [](const FitBoundProgress&) {};
  std::function<void(const Fit&)> found = [](const Fit&) {};  ///< a second time where the bound met a better pose
};

/// An implant in a pose that was not chosen. Of `fit` nothing is proven.
struct FitTrial {
  FitFinalist fit;
  double size;            ///< implant_size
  FemurFeatures changes;  ///< proven of this pose; none without the bone's landmarks
  /// Whether all conditions were proven of it; nothing where that was not tried, and no change is proven to be beyond
  /// what is asked.
  std::optional<bool> kept;
  std::vector<std::string> open;  ///< conditions that were not proven, by their names
};

/// Nothing of `fit` is proven.
struct FitSolution {
  Fit fit;
  /// The other fits that were found, the best first; where the size is to be largest, each larger implant that was
  /// tried.
  std::vector<FitTrial> trials = {};
  std::optional<FitBound> bound = {};  ///< nothing where it is not asked for, or the search was interrupted
  double bound_seconds = 0.0;          ///< wall time
};

/// Searches; then, where a gap is given, bounds; then searches again from what the bound came across: the better fit
/// counts. Where the size is to be largest, the implants are searched and proven one after the other, the largest
/// first, until all conditions are proven of one; where they are of none, the one counts that `fit` would choose by F.
/// Throws Error(input) for a gap where implants have sizes to choose from, or are to be largest, and as `fit` and
/// `bound_fit`.
[[nodiscard]] FitSolution solve_fit(const FitProblem& problem, const FitSolutionOptions& options);

/// How close the whole bone comes to a posed model, its implant or what prepares that one's bed, with the samples that
/// a fit may take. Throws Error as mesh_clearance. Precondition: a mesh with triangles.
[[nodiscard]] MeshClearance prove_surface(const FitProblem& problem, const Model& model, const MapOptions& options);

/// The proof about the fitted implant, as its numbers state it.
struct FitProof {
  Clearance clearance;
  std::optional<MeshClearance> surface;      ///< nothing where only vertices keep the limit
  std::optional<Sides> sides;                ///< nothing where the surface is unsided
  FemurFeatures changes;                     ///< none where the bone's landmarks are not given
  std::optional<ContactAreas> contact;       ///< nothing for a mesh without triangles
  std::vector<FitCondition> conditions;      ///< all that is asked
  std::vector<std::string> unfinished = {};  ///< what the time limit, or an interruption, left open, in words
  /// By how much the proven objective is below the bound at most, as a share of the bound, rounded up. Nothing without
  /// a bound, or unless every vertex is proven to keep the bound's limit and the objective to be positive.
  std::optional<double> gap;
};

/// The rows of all vertices go to `sink` as they come. Throws Error as certified_clearance, mesh_clearance,
/// prove_sides.
/// At `options.out_of_time` what is not proven yet stays open: rows are valid, and wide, and `unfinished` names the
/// rest.
[[nodiscard]] FitProof prove_fit(const FitProblem& problem, const FitSolution& solution, const MapOptions& options,
                                 const Sink<Point>& sink);

/// Certifies the areas in contact of `proof`, as certified_contact; not that of the implant's own surface.
/// `interrupted` as `FitSolutionOptions` have it. Precondition: they are there.
[[nodiscard]] CertifiedContact certified_contact(
    const FitProblem& problem, const Fit& fit, const FitProof& proof, const std::function<bool()>& interrupted,
    const std::function<void(double)>& progress = [](double) {});

/// The time limit left nothing open, every row is verified, nothing proven too deep, sides and features are kept, and a
/// bound, where there is one, is as near as `gap`.
[[nodiscard]] bool is_as_asked(const FitProblem& problem, const FitSolution& solution, const FitProof& proof,
                               const std::optional<double>& gap);

}  // namespace verisq
