/// The options --report and --png, --range and --up: a finished map for people to look at.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/report.hpp>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// Names of files, as typed, empty when not asked for; and how they show things.
struct ReportFiles {
  std::string html;
  std::string png;
  std::optional<double> range = {};
  std::optional<Point> up = {};

  [[nodiscard]] bool any() const { return !html.empty() || !png.empty(); }
};

/// Adds --report, --png, --range and --up.
void declare_report_files(Options& options, ReportFiles& files);

/// Throws Error(input) for other extensions and where a file would overwrite one of `inputs`, whose empty names are
/// none, or be one of the other `outputs`, by links, too; Error(failure) where a file cannot be written: known before
/// all the work, not after it.
void check_usage(const ReportFiles& files, const std::vector<std::string>& inputs,
                 const std::vector<std::string>& outputs);

/// Throws Error(failure). --range and --up, where given, take the place of what `report` says.
void write(const ReportFiles& files, const Report& report);

}  // namespace verisq::command_line
