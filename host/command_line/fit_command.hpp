/// `verisq fit`: the pose and the sizes of an implant that serve a cavity best, and the proof of how well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/fit_solution.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model.hpp>
#include <verisq/report.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "verisq/device.hpp"

namespace verisq::command_line {

/// As typed; `fit_request` and the library check what depends on the files or on several options.
struct FitArguments {
  std::vector<std::string> implants;     ///< files of the series
  std::vector<std::string> instruments;  ///< files: none, or one an implant
  std::string mesh;
  bool cavity = false;  ///< the mesh is the surface of a cavity
  bool bone = false;
  bool any_side = false;
  std::optional<Plane> resection;
  std::vector<std::string> crossing;  ///< primitives
  std::vector<std::string> outside;   ///< primitives
  std::string landmarks;              ///< of the bone; empty when not given
  double landmark_radius = 0.0;
  std::vector<KeptFeature> kept;
  bool implant_contact = false;
  FitObjective objective = FitObjective::fitness;
  Completion completion = Completion::cementless;
  std::optional<double> gap;
  std::optional<double> gap_tolerance;
  double penetration_limit = 0.0;
  std::optional<MapElements> on;  ///< the elements that keep the limit: vertices or triangles
  std::optional<Pose> pose_start;
  std::optional<double> translation_range;
  double rotation_range = 30.0;  ///< degrees
  std::uint64_t seed = 1;
  std::size_t samples = 4096;
  std::optional<double>
      bound;                  ///< percent: a proof that no pose of the range is better by more; nothing: not asked for
  double bound_time = 300.0;  ///< seconds for it
  std::optional<double> time_limit;  ///< seconds for all
  std::string bound_certificate;
  std::string contact_certificate;    ///< for areas in contact; empty when not requested
  std::optional<std::string> labels;  ///< a property of the mesh's vertices
  std::vector<Area> weights;
  std::optional<double> tolerance;
  std::string device = "auto";
  std::string output;
  std::string map;               ///< empty when not requested
  bool certificates = false;     ///< in the map, and in the page of the report
  std::string surface_map;       ///< of whole triangles, with certificates; empty when not requested
  std::string certificate_file;  ///< proves the joint statements of the map's distances; empty when not requested
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

void declare_fit(Options& options, FitArguments& arguments);

/// `verified` when every enclosure is at most the tolerance wide and nothing is proven too deep. Throws Error(input)
/// for whatever the user can correct, before the search.
ExitStatus run_fit(const FitArguments& arguments);

// The request of a fit, from the options and files of the user.

/// Throws Error(input) naming file or option, key and value.
[[nodiscard]] FitRequest read_fit_request(const FitArguments& arguments);

// The instrument that prepares the bed of an implant, like its rasp, at the pose of the fitted implant: how deep it
// cuts.

struct Instrument {
  std::string file;
  Model model;  ///< in the frame of its implant
};

/// One for each implant, in the order of the series; none if none is given. Throws Error(input) for another number of
/// them, for units other than those of `problem`, and like read_model.
[[nodiscard]] std::vector<Instrument> read_instruments(const FitProblem& problem, const FitArguments& arguments);

/// The clearance of one instrument at the pose of the implant.
struct InstrumentClearance {
  std::string file;
  MeshClearance surface;  ///< of the whole bone
};

/// Proves the clearance of the chosen implant's instrument, as far as possible until `stop` returns true. Errors as
/// those of mesh_clearance. Precondition: a mesh with triangles.
[[nodiscard]] InstrumentClearance prove_instrument(const FitProblem& problem, const Fit& fit,
                                                   const Instrument& instrument, const std::function<bool()>& stop);

// The files of a fit for a later proof of its distances: certificates in its maps and its page, and a file of the
// distances' joint statements.

/// Adds --certificates, --surface-map and --certificate-file.
void declare_certificates(Options& options, FitArguments& arguments);

/// Returns whether the distances of the vertices get certificates.
[[nodiscard]] bool certifies(const FitArguments& arguments);

/// Throws Error(input) if no file would contain them, or if they would be about a mesh other than the file's.
void check_certificates(const FitArguments& arguments);

/// Throws Error(input) for a mesh without triangles, if their map is requested.
void refuse_what_has_no_certificates(const FitProblem& problem, const FitArguments& arguments);

/// The contents of the map of the vertices.
[[nodiscard]] MapContents contents_of(const FitArguments& arguments);

/// Writes the map of whole triangles and the certificate file, if they are requested. Precondition: the fitted model's
/// file is written. `options`: tolerance, device and when to end. Returns unverified if the limit left triangles wide.
/// Throws Error(failure), and like TriangleMapper.
[[nodiscard]] ExitStatus write_certificates(const FitProblem& problem, const Model& fitted, const Clearance& clearance,
                                            std::vector<SideClaim> sides, const MapOptions& options,
                                            const FitArguments& arguments);

/// Writes the certificate of the bound, if it is requested and finished by the limit; else reports why not. Returns the
/// upper end that it proves: hardly more than the bound's.
std::optional<double> write_bound_certificate(const FitProblem& problem, const FitSolution& solution,
                                              const Deadline& limit, const FitArguments& arguments);

// The option --contact-certificate-file of `verisq fit`: the proof of its areas in contact.

/// Adds it.
void declare_contact_certificate(Options& options, FitArguments& arguments);

/// Throws Error(input) where the mesh is not that of the file, or is no file that a digest can name.
void check_contact_certificate(const FitArguments& arguments);

/// Throws Error(input) for a mesh without triangles, if the file is requested.
void refuse_what_has_no_contact(const FitProblem& problem, const FitArguments& arguments);

/// The result of writing the file.
enum class ContactFile : std::uint8_t { not_asked_for, written, interrupted, out_of_time, too_large };

/// Writes the file if it is requested, with the areas that the fit found, as far as they are proven. Reports other
/// areas, and a file that is not written, on the standard error. Ctrl-C ends it, unless one had come before, and so
/// does the limit. Precondition: the fitted model's file is written. Throws Error(failure).
[[nodiscard]] ContactFile write_contact_certificate(const FitProblem& problem, const Fit& fit, const FitProof& proof,
                                                    const Deadline& limit, const FitArguments& arguments);

// The certified summary of a fit: for people, for a report, or as one JSON object.

/// The objective that no pose of the range exceeds, and the gap between it and the fit.
struct BestPossible {
  FitBound bound;
  double asked;  ///< share of the bound that the fit may be below it
  /// The largest distance of the proven objective below the bound, as a share of the bound, rounded up. Nothing unless
  /// every vertex is proven to keep the bound's limit, and the objective to be positive.
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
  std::optional<Sides> sides;               ///< the proven sides; none where the surface is unsided
  FemurFeatures changes;                    ///< of the bone's features; none where its landmarks are not given
  std::vector<KeptFeature> kept;            ///< ranges required of them
  std::optional<ContactAreas> contact;      ///< nothing for a mesh without triangles
  double contact_distance;                  ///< all requirements
  std::vector<FitCondition> conditions;     ///< all that is asked
  std::vector<std::string> unfinished;      ///< the results that the time limit left open
  std::vector<FitTrial> trials;             ///< the candidates that were not chosen
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
  /// The upper end that the bound's certificate proves; nothing if it was not written.
  std::optional<double> certified_upper = {};
  std::string contact_certificate = {};  ///< empty when not written
};

/// The objective if every point of the cavity were served perfectly: the sum of the weights, rounded up.
[[nodiscard]] double largest_objective(const Clearance& clearance);

/// A sentence for each change that is not known, or not proven to be within its required range.
[[nodiscard]] std::vector<std::string> broken_features(const FitSummary& summary);

/// A sentence for each area of contact that is not proven to be within its required range.
[[nodiscard]] std::vector<std::string> broken_contacts(const FitSummary& summary);

/// A sentence for each primitive that is not proven to lie on its required side.
[[nodiscard]] std::vector<std::string> broken_sides(const FitSummary& summary);

/// The proven results, the most important first, areas included. Digits are rounded outward.
[[nodiscard]] std::vector<ReportLine> report_lines(const FitSummary& summary);

/// The same with a table of the areas, devices, times and files.
[[nodiscard]] std::string readable(const FitSummary& summary);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const FitSummary& summary);

}  // namespace verisq::command_line
