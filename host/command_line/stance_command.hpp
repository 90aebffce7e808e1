/// `verisq stance`: enclosures of wrench, sensitivities and accelerations of a stance model with uncertain parameters.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/stance_equilibrium.hpp>
#include <verisq/stance_motion.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/named_number.hpp"
#include "host/command_line/named_range.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed; `run_stance` checks what depends on the file or on several options.
struct StanceArguments {
  std::string model;
  std::optional<std::string> uncertain;
  std::vector<NamedRange> ranges;  ///< instead of the file's
  std::optional<double> within;    ///< per cent of the nominal value, of every uncertain parameter
  std::optional<stance::Mode> mode;
  bool sensitivities = false;
  OptionalText accelerations;       ///< the case, fall where empty
  std::vector<NamedNumber> joints;  ///< other positions than the file's
  std::optional<stance::JointControl> equilibrium;
  std::optional<stance::JointControl> stability;
  std::string parameter_map;     ///< file; or empty
  std::string certificate_file;  ///< likewise
  std::optional<std::uint32_t> cells;
  std::optional<double> simulate;  ///< in s
  std::optional<double> lift;      ///< in m
  std::optional<double> drop;      ///< in m
  std::optional<stance::Push> push;
  std::string csv, plot;
  std::optional<std::uint64_t> monte_carlo;
  OptionalText report;
  std::optional<std::string> bounce;
  std::optional<double> drop_height;  ///< in m
  bool json = false;
  bool no_progress = false;
};

void declare_stance(Options& options, StanceArguments& arguments);

/// Throws Error(input) for whatever the user can correct, Error(failure) where a sample escapes from an enclosure.
ExitStatus run_stance(const StanceArguments& arguments);

}  // namespace verisq::command_line
