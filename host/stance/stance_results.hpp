/// Results of `stance` as it shows them: chosen quantities, comparisons of models, pictures.
#pragma once

#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "host/errors/refusal.hpp"
#include "verify/stance/sagittal_model.hpp"

namespace verisq::stance {

// Enclosures of a stance beside the paper's tables, and beside Monte-Carlo samples.

// Tables 2, 3 and 4 of the paper beside this program's enclosures, cell by cell (audit: docs/stance.md §1).

enum class CellVerdict : std::uint8_t {
  match,     ///< each end within 0.01 of the printed one, after directed rounding to the second digit
  misprint,  ///< each end within 0.01 of the value that, by the audit, the paper should have printed; `reason` says why
  differs,   ///< neither
  unprinted,  ///< our copy of the paper has no number there
};

[[nodiscard]] std::string_view word(CellVerdict verdict);

/// Ends in hundredths of the unit: whole numbers, or infinite.
struct Hundredths {
  double lo;
  double hi;

  [[nodiscard]] bool operator==(const Hundredths&) const = default;
};

/// The tightest hundredths around an enclosure: lower end down, upper end up.
[[nodiscard]] Hundredths rounded_outward(const Enclosure& enclosure);

/// "[-50.17, 45.49]", or one number where the ends are equal.
[[nodiscard]] std::string text(const Hundredths& cell);

struct Cell {
  std::string_view row;     ///< w1, w2, w4, w6
  std::string_view column;  ///< as in the paper
  Hundredths ours;
  std::string printed;  ///< empty where unprinted
  CellVerdict verdict;
  std::string_view reason;  ///< for a misprint, else empty
  /// Constants of examples/stance.xml that enter the cell and were chosen so that the tables come out: that it matches
  /// is no evidence for them.
  std::vector<std::string_view> reconstructed;
};

/// All that a cell may name.
[[nodiscard]] std::vector<std::string_view> reconstructed_constants();

struct PaperTable {
  std::string_view title;
  std::vector<Cell> cells;
};

struct PaperReport {
  std::array<PaperTable, 3> tables;          ///< 2, 3, 4
  ReferenceUncertainty unrounded;            ///< for Table 4, from sensitivities that are not rounded first
  [[nodiscard]] bool all_explained() const;  ///< no cell differs
};

/// In paper mode, for a model that has the parameters mp, px, Fx and mf. Throws Error(input) that names a missing one.
[[nodiscard]] PaperReport compare_with_paper(const Model& model);

// Monte-Carlo samples of uncertain parameters: tests whether enclosures contain them, and measures how much of each
// they fill.

/// The sampled function: its numbers are claimed to lie in `claimed` over the box of the uncertain set. Called on any
/// thread.
struct Sampled {
  std::vector<Enclosure> claimed;
  std::function<std::vector<double>(std::span<const double> parameters)> evaluate;  ///< in plain floating point
  /// Enclosures of the exact values at one point, which tell an escape from rounding errors of `evaluate`.
  std::function<std::vector<Enclosure>(std::span<const double> parameters)> enclose;
};

[[nodiscard]] Sampled sampled_wrench_of(const Model& model, std::vector<Enclosure> claimed);
[[nodiscard]] Sampled sampled_accelerations_of(const Model& model, const Instant& instant,
                                               std::vector<Enclosure> claimed);

/// A proven error: no exact value at `parameters` lies in the claimed enclosure.
struct Escape {
  std::size_t component;
  Enclosure exact;
  std::vector<double> parameters;
};

struct Samples {
  std::uint64_t count;          ///< number taken; fewer than requested if interrupted or escaped
  std::vector<Enclosure> hull;  ///< hull of the samples, within the claims; empty ([inf, -inf]) without samples
  std::optional<Escape> escape;
};

struct SampleOptions {
  std::uint64_t count;
  std::function<bool()> interrupted = {};
  std::function<void(std::uint64_t done)> progress = {};  ///< one call at a time
};

/// Uniform and independent over the ranges of the uncertain set, all others nominal; the same samples each time.
[[nodiscard]] Samples take_samples(const Model& model, UncertainSet uncertain, const Sampled& sampled,
                                   const SampleOptions& options);

/// The part of the enclosure that the hull fills, in [0, 1]; 1 for an enclosure that is a point.
[[nodiscard]] double filled_part(const Enclosure& hull, const Enclosure& claimed);

// The numbers of a stance model that an analysis covers, the caller's choice of them, and the model narrowed to them.

struct Scope {
  std::string meaning;  ///< of the results, in one sentence
  std::vector<std::string> acts;
  std::vector<std::string> does_not_act;
  std::vector<std::string> parameters_without_effect;  ///< names; of all parameters of the model, uncertain or not
};

/// The scope of the wrench and its sensitivities, one for each parameter of the model. Parameters without effect are
/// those whose derivatives are proven to be 0 over the box.
[[nodiscard]] Scope wrench_scope(const Model& model, std::span<const WrenchEnclosure> sensitivities);

[[nodiscard]] Scope acceleration_scope(const Model& model, AccelerationCase at);

[[nodiscard]] Scope equilibrium_scope(const Model& model, JointControl control);

[[nodiscard]] Scope stability_scope(const Model& model, JointControl control);
/// The scope of the motion in the sagittal plane.
[[nodiscard]] Scope motion_scope(const Model& model, const MotionOptions& options);

/// The scope of the drop of one of the model's cylinders.
[[nodiscard]] Scope bounce_scope(const Model& model, const ContactCylinder& cylinder);

// Pictures and tables of a stance: its motion, maps of two parameters, the view from the side.

// Pictures as SVG: the document, and names of a file as its text.

/// The words on one line, with the characters that XML reserves written as entities.
[[nodiscard]] inline std::string svg_text(std::string_view words) {
  std::string text;
  for (const char c : on_one_line(words)) {
    switch (c) {
      case '&': text += "&amp;"; break;
      case '<': text += "&lt;"; break;
      case '>': text += "&gt;"; break;
      default: text += c;
    }
  }
  return text;
}

/// A white picture with these elements.
[[nodiscard]] inline std::string svg_document(double width, double height, std::string_view elements) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"sans-serif\" "
      "font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
      width, height, elements);
}

// A proven motion over time, as a table and as a picture.

/// CSV, a header and a row for each slab: from, to, then _lo and _hi of each quantity; these contain it at all times
/// between the two. Shortest decimals that read back as the same binary64.
[[nodiscard]] std::string motion_table(const Motion& motion);

/// SVG: the tubes of x, height and pitch of the root and of the cylinders' forces over time.
[[nodiscard]] std::string motion_picture(const Motion& motion);

// A picture of the proven results over a box of two parameters, cell by cell.

/// SVG: the first parameter to the right, the second upward. Preconditions: cells of two uncertain parameters, these
/// two, at least one.
[[nodiscard]] std::string parameter_map(std::span<const EquilibriumCell> cells, const std::array<Parameter, 2>& axes);
[[nodiscard]] std::string parameter_map(std::span<const StabilityCell> cells, const std::array<Parameter, 2>& axes);

// The proven places of the points of a body that a picture from the side shows.

/// A point in the world, m.
struct SidePoint {
  Enclosure x, y;
};

struct SideView {
  std::vector<SidePoint> origins;    ///< of the frames of all bodies: the joints that carry them
  std::vector<SidePoint> cylinders;  ///< middles of the axes of all cylinders
  SidePoint trunk;                   ///< the root's centre of mass
};

/// Contains all points for all parameters of the box and all joints within `positions` (of all joints, bodies in order,
/// m or rad). Computed from these alone: a foot that the ground holds is no narrower here than the chain that leads to
/// it.
[[nodiscard]] SideView side_view(const Model& model, UncertainSet uncertain, std::span<const Enclosure> positions);

/// The positions of all joints of the model, from those of its sagittal plane (SagittalModel::joints); the others are
/// as in the file.
[[nodiscard]] std::vector<Enclosure> all_positions(const SagittalModel& sagittal, std::span<const Enclosure> positions);

}  // namespace verisq::stance
