/// The best pose of a fit's problem, how near it is to the best possible one, and the proof of what was found.
#pragma once

#include <functional>
#include <optional>
#include <vector>
#include <verisq/certified_contact.hpp>
#include <verisq/clearance.hpp>
#include <verisq/contact_area.hpp>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/fit_bound.hpp>
#include <verisq/fit_conditions.hpp>
#include <verisq/fit_problem.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/sides.hpp>

namespace verisq {

struct FitSolutionOptions {
  std::optional<double> gap = {};  ///< in (0, 1): asks for a bound, as FitBoundOptions
  std::function<bool()> interrupted = [] { return false; };
  std::function<bool()> out_of_time = [] { return false; };  ///< of the bound
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
  /// What else was found, the best first; where the size is to be largest, each larger implant that was tried.
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

/// What is proven of the fitted implant, as its numbers state it.
struct FitProof {
  Clearance clearance;
  std::optional<MeshClearance> surface;  ///< nothing where only vertices keep the limit
  std::optional<Sides> sides;            ///< nothing where the surface is unsided
  FemurFeatures changes;                 ///< none where the bone's landmarks are not given
  std::optional<ContactAreas> contact;   ///< nothing for a mesh without triangles
  std::vector<FitCondition> conditions;  ///< all that is asked
  /// What the proven objective is below the bound at most, as a share of the bound, rounded up; nothing without a
  /// bound, and unless every vertex is proven to keep the limit that the bound is for, and the objective to be
  /// positive.
  std::optional<double> gap;
};

/// The rows of all vertices go to `sink` as they come. Throws Error as certified_clearance, mesh_clearance,
/// prove_sides.
[[nodiscard]] FitProof prove_fit(const FitProblem& problem, const FitSolution& solution, const MapOptions& options,
                                 const Sink<Point>& sink);

/// What proves the areas in contact of `proof` again, as certified_contact; not that of the implant's own surface.
/// `interrupted` as `FitSolutionOptions` have it. Precondition: they are there.
[[nodiscard]] CertifiedContact certified_contact(
    const FitProblem& problem, const Fit& fit, const FitProof& proof, const std::function<bool()>& interrupted,
    const std::function<void(double)>& progress = [](double) {});

/// Every row is verified, nothing proven too deep, sides and features are kept, and a bound, where there is one, is as
/// near as `gap`.
[[nodiscard]] bool is_as_asked(const FitProblem& problem, const FitSolution& solution, const FitProof& proof,
                               const std::optional<double>& gap);

}  // namespace verisq
