/// `verisq features`: head, neck, shaft and condyles of a femur, and what a surgeon measures of them, as intervals.
#pragma once

#include <optional>
#include <string>
#include <verisq/features.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// As typed; `run_features` checks what depends on several of them.
struct FeaturesArguments {
  std::string mesh;
  std::string model;
  double deviation = 0.3;  ///< of the model's mesh, in mm
  std::string landmarks;
  std::optional<Side> side;
  double landmark_radius = 0.0;
  std::string implant;
  std::string implant_head;  ///< empty: as the implant's file says, else its primitive "head"
  std::string implant_neck;
  std::string written_landmarks;
  std::string axes;
  std::string certificate_file;
  std::string device = "auto";
  ReportFiles report;
  bool json = false;
};

void declare_features(Options& options, FeaturesArguments& arguments);

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_features(const FeaturesArguments& arguments);

}  // namespace verisq::command_line
