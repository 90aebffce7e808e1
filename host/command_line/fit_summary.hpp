/// The certified summary of a fit: for people, for a report, or as one JSON object.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/fit_bound.hpp>
#include <verisq/fit_conditions.hpp>
#include <verisq/fit_solution.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/report.hpp>
#include <verisq/sides.hpp>

#include "host/command_line/fit_command.hpp"
#include "host/command_line/fit_instrument.hpp"

namespace verisq::command_line {

/// What no pose of the range exceeds, and how far from it the fit is.
struct BestPossible {
  FitBound bound;
  double asked;  ///< share of the bound that the fit may be below it
  /// What the proven objective is below the bound at most, as a share of the bound, rounded up; nothing unless every
  /// vertex is proven to keep the limit that the bound is for, and the objective to be positive.
  std::optional<double> gap;
  double seconds;  ///< wall time
};

struct FitSummary {
  Fit fit;
  Clearance clearance;
  std::optional<MeshClearance> surface;           ///< nothing where only vertices keep the limit
  std::optional<InstrumentClearance> instrument;  ///< of the chosen implant's; nothing where none is given
  FitSurface side_of;
  std::vector<SurfaceSide> required_sides;  ///< one a primitive; none where the surface is unsided
  std::optional<Sides> sides;               ///< likewise
  FemurFeatures changes;                    ///< of the bone's features; none where its landmarks are not given
  std::vector<KeptFeature> kept;            ///< ranges asked of them
  std::optional<ContactAreas> contact;      ///< nothing for a mesh without triangles
  double contact_distance;                  ///< no farther is contact
  std::vector<FitCondition> conditions;     ///< all that is asked
  std::vector<FitTrial> trials;             ///< what was not chosen
  std::vector<std::string> names;           ///< files of the series
  FitObjective maximised;
  double landmark_radius;
  std::string implant;               ///< file of the chosen one
  std::size_t implants;              ///< in the series
  bool sized;                        ///< the chosen one has sizes to choose from
  std::optional<BestPossible> best;  ///< nothing where it is not asked for, or the search was interrupted
  double penetration_limit;
  double tolerance;
  std::string units;                   ///< empty when not given
  double search_seconds;               ///< wall time
  double proof_seconds;                ///< wall time
  std::string output;                  ///< the fitted model
  std::string map;                     ///< empty when not asked for
  std::string surface_map = {};        ///< likewise
  std::string certificate_file = {};   ///< likewise
  std::string bound_certificate = {};  ///< likewise
  /// Of the bound, what that proves; nothing where it was not written.
  std::optional<double> certified_upper = {};
  std::string contact_certificate = {};  ///< empty when not written
};

/// The objective if every point of the cavity were served perfectly: the sum of the weights, rounded up.
[[nodiscard]] double largest_objective(const Clearance& clearance);

/// A sentence for each change that is not known, or not proven to be within what is asked.
[[nodiscard]] std::vector<std::string> broken_features(const FitSummary& summary);

/// A sentence for each area of contact that is not proven to be within what is asked.
[[nodiscard]] std::vector<std::string> broken_contacts(const FitSummary& summary);

/// A sentence for each primitive that is not proven to lie where it has to.
[[nodiscard]] std::vector<std::string> broken_sides(const FitSummary& summary);

/// What is proven, the most important first, areas included. Digits are rounded outward.
[[nodiscard]] std::vector<ReportLine> report_lines(const FitSummary& summary);

/// The same with a table of the areas, devices, times and files.
[[nodiscard]] std::string readable(const FitSummary& summary);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const FitSummary& summary);

}  // namespace verisq::command_line
