/// The options --report and --png: a finished map for people to look at.
#pragma once

#include <initializer_list>
#include <string>
#include <verisq/report.hpp>

namespace CLI {
class App;
}

namespace verisq::command_line {

/// Names of files, as typed; empty when not asked for.
struct ReportFiles {
  std::string html;
  std::string png;

  [[nodiscard]] bool any() const { return !html.empty() || !png.empty(); }
};

/// Adds --report and --png to `command`; parsing fills `files`.
void declare_report_files(CLI::App& command, ReportFiles& files);

/// Throws Error(input) for other extensions and where a file would overwrite one of `inputs`, whose empty names are
/// none; Error(failure) where a file cannot be written: known before all the work, not after it.
void check_usage(const ReportFiles& files, std::initializer_list<std::string> inputs);

/// Throws Error(failure).
void write(const ReportFiles& files, const Report& report);

}  // namespace verisq::command_line
