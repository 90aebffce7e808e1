/// `verisq deviation`: how far a mesh or a cloud and the surface of a model lie apart, both ways.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/report.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"

namespace verisq::command_line {

// The deviation of a model and a mesh, one of which a command has just made: proven, with a progress bar.

struct ProofArguments {
  std::string device;
  bool no_progress;
  bool statistics;  ///< mean and percentiles, too
  std::function<bool()> ended;
};

/// Percentiles of the proven statistics.
inline const std::vector<double> proven_percentiles{95.0};

/// Ends early once `ended` returns true.
[[nodiscard]] Deviation proven_deviation(const Model& model, const Mesh& mesh, const ProofArguments& arguments);

// The output of `verisq deviation`: for people, for the page of a report, or as one JSON object.

struct DeviationReport {
  Deviation deviation;
  DeviationOptions options = {};
  std::vector<std::string> region_names = {};
  bool is_cloud = false;
  std::size_t triangles = 0;
  std::string output = {};                        ///< the file that holds the rows; empty when none was kept
  std::string certificate = {};                   ///< file of certificates for the distances; empty if none was written
  std::string without_surface = {};               ///< why it proves nothing of the model's surface, if that was found
  std::optional<ProvenDeviation> certified = {};  ///< the deviation that it proves
  ReportFiles files = {};
  std::string units = {};  ///< of the model; empty when not given
  double seconds = 0.0;    ///< wall time
};

[[nodiscard]] std::string readable(const DeviationReport& report);

[[nodiscard]] std::vector<ReportLine> report_lines(const DeviationReport& report);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const DeviationReport& report);

// A deviation for people to look at: the mesh, coloured by its distance to the model's surface, on a page or a
// picture.

/// The drawn model and mesh, and the files from which they were read or to which they were written.
struct DrawnDeviation {
  const Model& model;
  std::string model_file;
  const Mesh& mesh;
  std::string mesh_file;
};

/// Writes the reports of a finished map of the mesh's vertices, with the lines of `report`. Throws Error(failure).
void write(const ReportFiles& files, const DrawnDeviation& drawn, const DeviationReport& report);

// `verisq deviation`: the deviation between a mesh or a cloud and the surface of a model, both ways.

/// A length in model units, or a share of the quantity whose tolerance it is.
struct LengthOrShare {
  double value;
  bool is_share;
};

/// As typed; `run_deviation` checks what depends on several options.
struct DeviationArguments {
  InputArguments inputs;
  std::optional<LengthOrShare> tolerance;
  std::vector<double> percentiles;  ///< empty: the library's percentiles
  bool both_ways = false;           ///< for points
  bool statistics_of_model = false;
  std::uint32_t parts = 0;  ///< along the mesh; 0: none
  std::string landmarks;    ///< landmarks of a femur, whose regions are measured
  std::optional<double> time_limit;
  std::string device = "auto";
  std::string output;
  std::string certificate_file;  ///< receives the proof of the distances
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

}  // namespace verisq::command_line
