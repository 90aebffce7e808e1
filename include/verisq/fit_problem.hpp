/// What is asked of a fit, and the problem that this is: which side of which surface, areas, features that are kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/cavity.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/mesh.hpp>
#include <verisq/plane_cut.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

enum class Completion : std::uint8_t { cementless, cemented };

/// What the mesh bounds.
enum class FitSurface : std::uint8_t {
  cavity,   ///< the room that the implant lies in
  bone,     ///< what it lies outside of
  unsided,  ///< sides do not matter
};

/// What a change of a feature, or an area of contact, has to be within.
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

/// What the implant of the series changes of the bone in this pose; nothing without the bone's landmarks.
[[nodiscard]] FemurFeatures changes_of(const FitProblem& problem, std::size_t implant, const Pose& pose);

/// Whether a number known to be within `value` lies in the range; nothing where that is open.
[[nodiscard]] std::optional<bool> is_within(const Enclosure& value, const Enclosure& range);

/// Every change that a range is asked of is there, and proven to be within it.
[[nodiscard]] bool is_preserved(const FemurFeatures& changes, std::span<const KeptFeature> kept);

}  // namespace verisq
