/// `verisq check`, which is also the program `verisq-check`: one source file for each kind of answer that is proved
/// again, and the summaries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"

namespace verisq::command_line {

// `verisq check`, which is also the program `verisq-check`. Proves a finished map again from the model, the points or
// triangles, and the certificates; or the answer of a certificate file; or an octree. Without OpenCL.

/// As typed, but for the last member.
struct CheckArguments {
  std::vector<std::string> models;  ///< one for a map; for a certificate its models, in its order
  InputArguments inputs;            ///< all but the model
  // One of these, or a map with the certificate of a fit.
  std::string map;
  std::string certificate;
  std::string octree;
  std::string poses;                    ///< the poses that a certificate must be about; empty: any
  std::string within;                   ///< the bone's outer surface for a way in along a cavity; empty: none
  std::string surface_map;              ///< map of the fit's whole triangles
  std::optional<std::uint64_t> sample;  ///< number of the octree's cubes to check; nothing: all
  double point_radius = 0.0;
  bool json = false;
  bool no_progress = false;
  std::optional<double> time_limit;           ///< in seconds
  std::function<bool()> ended = interrupted;  ///< returns whether the work is to end: by a signal, or the time limit
};

/// `verified` only when every enclosure is proved. Throws Error(input) for errors that the user can correct, also for a
/// map that does not have one row for each point or triangle.
ExitStatus run_check(const CheckArguments& given);

// The summary of a checked map on the standard output: for people, or as one JSON object.

/// An enclosure and its finding.
struct CheckedRow {
  std::uint64_t index;
  std::variant<Point, Triangle> element;
  Enclosure claimed;
  Finding finding;
};

struct CheckReport {
  MapElements elements;
  std::string map;    ///< its file
  std::string units;  ///< of the model; empty when not given
  std::uint64_t proved = 0;
  std::uint64_t refuted = 0;
  std::uint64_t unproved = 0;
  std::uint64_t missing = 0;               ///< points or triangles without a row, for the file of an ended run
  std::uint64_t unbounded = 0;             ///< rows that leave an end unbounded, whatever their findings
  double largest_width = 0.0;              ///< of the proved enclosures
  Enclosure smallest{infinity, infinity};  ///< bounds of the smallest distance proven by all rows so far
  std::optional<CheckedRow> first;         ///< the first refuted row; without one, the first unproved
  std::optional<MapDifference> falsified;  ///< something else that the map shows, and that is not so
  double seconds = 0.0;                    ///< wall time from the first row to the last
  bool interrupted = false;

  [[nodiscard]] std::uint64_t rows() const { return proved + refuted + unproved; }
  /// A row without an end claims nothing there, so that proving it is no success.
  [[nodiscard]] bool all_proved() const { return refuted + unproved + missing + unbounded == 0 && !falsified; }
};

/// Adds a row, in any order.
void count(const CheckedRow& row, CheckReport& report);

/// The number of claims with each verdict.
struct VerdictCounts {
  std::size_t proved = 0;
  std::size_t refuted = 0;
  std::size_t unproved = 0;

  [[nodiscard]] std::size_t all() const { return proved + refuted + unproved; }
  [[nodiscard]] bool are_all_proved() const { return refuted + unproved == 0; }
};

/// Counts the verdicts of anything with findings.
template <class Claims, class FindingOf>
[[nodiscard]] VerdictCounts counted(const Claims& claims, const FindingOf& finding_of) {
  VerdictCounts counts;
  for (const auto& claim : claims) {
    switch (std::invoke(finding_of, claim).verdict) {
      case Verdict::proved: ++counts.proved; break;
      case Verdict::refuted: ++counts.refuted; break;
      case Verdict::unproved: ++counts.unproved; break;
    }
  }
  return counts;
}

/// A line each, under a line of all `claims`.
[[nodiscard]] std::string verdicts_in_words(std::string_view claims, const VerdictCounts& counts);

/// A line, of claims that have an infinite end; empty where there are none.
[[nodiscard]] std::string unbounded_in_words(std::uint64_t count);

/// The same where only an upper end can be missing.
[[nodiscard]] std::string unbounded_above_in_words(std::uint64_t count);

/// How many claims became what, then a line a claim: `words` says what it claims. Below a claim that is not proved
/// stands what is proven of it, with the claim's `units`.
[[nodiscard]] std::string claims_in_words(
    const JudgedAnswer& judged, const std::function<std::string(const JudgedClaim&)>& words,
    const std::function<std::string(std::uint64_t)>& unbounded = unbounded_in_words,
    const std::function<std::string(const JudgedClaim&)>& units = [](const JudgedClaim&) { return std::string(); });

/// A list of objects: each begins as `head` says, and has "verdict", "claimed" and "proven".
[[nodiscard]] JsonValue claims_of(const JudgedAnswer& judged,
                                  const std::function<JsonObject(const JudgedClaim&)>& head);

/// An answer whose claims are judged together, and what its kind alone says about them.
struct JudgedKind {
  std::string_view elements;  ///< of the progress bar, in the plural; a literal
  std::string_view steps;     ///< the bar shows them, or
  std::uint64_t count = 0;    ///< the rate of so many elements
  std::function<JudgedAnswer(const CheckOptions&)> judge;
  std::function<std::string(const JudgedAnswer&)> words;   ///< stand above the time and the certificate's name
  std::function<JsonObject(const JudgedAnswer&)> members;  ///< likewise
};

/// Judges the answer and prints the findings. `verified` where all is proved.
[[nodiscard]] ExitStatus proved_again(const JudgedKind& kind, const CheckArguments& arguments);

/// The end that is wrong or open, and the reason. Precondition: not proved.
[[nodiscard]] std::string reason(const Enclosure& claimed, const Finding& finding);

/// 17 significant digits, which give back the same binary64.
[[nodiscard]] std::string exact_text(const Enclosure& enclosure);

/// The number of rows, and of each verdict: a line each.
[[nodiscard]] std::string verdicts_in_words(const CheckReport& report);

/// Describes the first refuted or unproved row.
[[nodiscard]] std::string readable(const CheckedRow& row, MapElements elements);
[[nodiscard]] JsonObject object_of(const CheckedRow& row, MapElements elements);

[[nodiscard]] std::string readable(const CheckReport& report);

/// JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] JsonObject object_of(const CheckReport& report);
/// One line.
[[nodiscard]] std::string json(const CheckReport& report);

// `verisq check --certificate` of pairs and poses: proves the answer of a certificate file again.

/// As typed.
struct CertificateCheckArguments {
  std::string certificate;
  std::vector<std::string> models;  ///< in the order of the certificate
  std::string poses;                ///< a file with the poses that the certificate must have; empty: any
  bool json = false;
  std::function<bool()> ended = {};  ///< as in CheckArguments
};

/// A and B.
using TwoModels = std::array<Model, 2>;

/// The given models. Throws Error(input) unless they are the models of the answer, in its stated units.
[[nodiscard]] TwoModels models_of(const std::array<SubjectFile, 2>& subjects, const std::string& stated_units,
                                  const CertificateCheckArguments& arguments);

/// Throws Error(input) unless the file, if one is given, holds these poses in this order.
void refuse_other_poses(const std::string& file, std::span<const Pose> poses, const std::string& certificate);

/// A line that says who must check whether the path is the one that the user meant. `way` is "way" or "path".
[[nodiscard]] std::string meant_in_words(const std::string& file, std::string_view way);

/// Throws Error(input) unless the units of `what` are those that the certificate states.
void refuse_other_units(const std::string& units, const char* what, const std::string& stated,
                        const std::string& certificate);

/// Throws Error(input) if no model is given, or an option that an answer about two models does not use.
[[nodiscard]] CertificateCheckArguments arguments_of_two_models(const CheckArguments& arguments);

/// `verified` only when the answer is proved. Throws Error(input) for errors that the user can correct, also for models
/// other than those of the answer.
ExitStatus run_check(const PairAnswer& answer, const CheckArguments& given);
ExitStatus run_check(const PoseAnswers& answers, const CheckArguments& given);

// Whether one tolerance explains every status of a map: "verified" rows are at most that wide, "wide" rows are wider. A
// tolerance of 0, which requests the tightest rows, has a width of its own for each row.

/// The widths that a tolerance of 0 calls verified: rows at most `surely` wide are, none wider than `possibly` is.
struct TightestWidths {
  double surely = 0.0;
  double possibly = infinity;
};

/// The tolerance itself is not in the map, nor can a map prove which of device and host verified a row.
class StatusConsistency {
 public:
  /// Adds a row; rows may come in any order.
  void add(std::uint64_t index, const MapResult& row, const TightestWidths& tightest);

  /// A row whose status no finite tolerance allows beside the statuses of the others; the array is "status".
  [[nodiscard]] std::optional<MapDifference> contradiction() const;

 private:
  struct Row {
    std::uint64_t index;
    Status status;
    double width;
  };

  std::optional<Row> widest_verified_;
  std::optional<Row> narrowest_wide_;
  bool tightest_explains_ = true;  ///< a tolerance of 0 does
};

// `verisq check --map`: every row of a map proved again.

/// Called with the proven enclosure of each row, by one thread at a time, in any order.
using Proven = std::function<void(std::uint64_t row, const Enclosure& proven)>;

/// `map` is `arguments.map`. Throws Error(input) for errors that the user can correct.
[[nodiscard]] CheckReport checked_map(const CheckArguments& arguments, MapReader& map, const Proven& proven);

// Proves the octree of a file again: all of its cubes, or some chosen at random.

struct OctreeCheckArguments {
  std::string octree;
  std::string model;
  std::optional<Pose> pose;             ///< moves the model
  std::optional<std::uint64_t> sample;  ///< how many cubes
  bool json;
  bool no_progress;
  std::function<bool()> ended;
};

/// `verified` only where every cube that was looked at is proved.
ExitStatus run_octree_check(const OctreeCheckArguments& arguments);

// Proves the answers of a certificate file of many poses again, and reports the findings.

struct PosesReport {
  /// An answer that is not proved.
  struct Open {
    std::size_t index;
    PosedAnswer answer;
    Finding finding;
  };

  CertificateCheckArguments arguments;
  std::string units;
  std::uint64_t proved = 0;
  std::uint64_t refuted = 0;
  std::uint64_t unproved = 0;
  std::uint64_t unbounded = 0;  ///< answers without a claim from above
  double largest_width = 0.0;   ///< of the proved answers
  std::optional<Open> first{};  ///< refuted; without one, unproved
  double seconds = 0.0;
  bool interrupted = false;
};

/// Precondition: the models are those of the answers.
[[nodiscard]] PosesReport checked_poses(const Model& a, const Model& b, const PoseAnswers& answers,
                                        const CertificateCheckArguments& arguments);

[[nodiscard]] std::string readable(const PosesReport& report);
[[nodiscard]] std::string json(const PosesReport& report);

// The length of a path of poses, and its description.

/// The approximate length of the moving origin's way: for people.
[[nodiscard]] double length_of(std::span<const Pose> path);

// `verisq check --certificate` of a path: how near two models come while one of them moves, proved again.

/// `verified` only when every claim is proved, and the smallest distance has an end. Throws Error(input) for errors
/// that the user can correct, also for models other than those of the answer.
ExitStatus run_check(const PathAnswer& answer, const CheckArguments& arguments);

// `verisq check --certificate` of a way in: the smallest distance of every vertex along it proved again.

/// `verified` only when every distance is proved, and claimed on both sides. Throws Error(input) for errors that the
/// user can correct, also for a model or mesh other than those of the answer.
ExitStatus run_check(const InsertionAnswer& answer, const CheckArguments& arguments);

// The statements of `verisq check --certificate` for a fit about the sides on which the implant's parts lie.

struct SideCheckReport {
  std::vector<Verdict> verdicts = {};   ///< one for each claim; none for an interrupted check
  std::vector<std::string> names = {};  ///< of all primitives
  std::size_t rims = 0;                 ///< over which the mesh was closed
  std::optional<bool> outward = {};     ///< whether its normals point outward
  bool interrupted = false;

  [[nodiscard]] bool all_proved() const;
};

/// Reads model and mesh if there are claims. Throws Error(input).
[[nodiscard]] SideCheckReport checked_sides(const FitAnswer& answer, const CheckArguments& arguments);

/// A line for each claim, and one for the primitives without a claim.
[[nodiscard]] std::string sides_in_words(const FitAnswer& answer, const SideCheckReport& report);
[[nodiscard]] JsonValue sides_of(const FitAnswer& answer, const SideCheckReport& report);

// The wanted distances and the weights of vertices, as a certificate states them, for its reader.

/// "0.5 mm", or "0.5".
[[nodiscard]] std::string with_units(const std::string& number, const std::string& units);

/// The criterion, and each area: a line each.
[[nodiscard]] std::string criterion_in_words(const StatedTerms& terms, const std::string& units);

/// Objects with "name", "weight" and "points".
[[nodiscard]] JsonValue areas_of(const StatedTerms& terms);

// `verisq check --certificate` of a fit: every distance proved, and then their joint statements.

/// `verified` only when every distance and every claim is proved. Throws Error(input) for errors that the user can
/// correct, also for a model or mesh other than those of the answer.
ExitStatus run_check(const FitAnswer& answer, const CheckArguments& arguments);

// `verisq check --certificate` of a fit's best possible objective: proves its bound again.

/// `verified` only when the bound is proved. Throws Error(input) for errors that the user can correct, also for models
/// or a mesh other than those of the answer.
ExitStatus run_check(const BestFitAnswer& answer, const CheckArguments& arguments);

// `verisq check --certificate` of a deviation: proves it again from the distances that the file holds.

/// Throws Error(input) for errors that the user can correct, also for files other than those of the answer.
ExitStatus run_check(const DeviationAnswer& answer, const CheckArguments& arguments);

// `verisq check --certificate` of areas in contact: proves each of them again.

/// `verified` only when every claim is proved. Throws Error(input) for errors that the user can correct, also for a
/// model or mesh other than those of the answer.
ExitStatus run_check(const ContactAnswer& answer, const CheckArguments& arguments);

// `verisq check --certificate` of a model within a mesh, or around it: proves it again.

/// `verified` only when the containment is proved. Throws like the check of areas in contact.
ExitStatus run_check(const ContainmentAnswer& answer, const CheckArguments& arguments);

// `verisq check --certificate` of a body's equilibrium: proves it once more, at 127 bits.

/// Throws Error(input) for errors that the user can correct, also for a model other than that of the answer.
ExitStatus run_check(const EquilibriumAnswer& answer, const CheckArguments& arguments);

// `verisq check --certificate` of a femur's features: encloses them once more, at 127 bits.

/// Throws Error(input) for errors that the user can correct, also for files other than those of the answer, if some are
/// given.
ExitStatus run_check(const FeaturesAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
