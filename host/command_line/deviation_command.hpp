/// `verisq deviation`: how far a mesh or a cloud and the surface of a model lie apart, both ways.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/point_stream.hpp"
#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// A length in model units, or a share of what it is the tolerance of.
struct LengthOrShare {
  double value;
  bool is_share;
};

/// "0.1", or "5%" for a share. Throws Error(input) that begins with `option` unless it is finite and above 0.
[[nodiscard]] LengthOrShare parse_length_or_share(std::string_view option, const std::string& text);

/// As typed; `run_deviation` checks what depends on several options.
struct DeviationArguments {
  InputArguments inputs;
  std::optional<LengthOrShare> tolerance;
  std::vector<double> percentiles;  ///< none: those of the library
  bool both_ways = false;           ///< of points
  bool statistics_of_model = false;
  std::uint32_t parts = 0;  ///< along the mesh; 0: none
  std::string landmarks;    ///< of a femur, whose regions are measured
  std::optional<double> time_limit;
  std::string device = "auto";
  std::string output;
  std::string certificate_file;  ///< what proves the distances again
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

void declare_deviation(Options& options, DeviationArguments& arguments);

/// Throws Error(input) for what the user can correct, before the first distance is computed.
ExitStatus run_deviation(const DeviationArguments& arguments);

}  // namespace verisq::command_line
