/// Checks and writes the files of a report.
#include "host/command_line/report_files.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <system_error>
#include <verisq/error.hpp>

#include "host/files/output_file.hpp"

namespace verisq::command_line {
namespace {

void check(const char* option, const std::string& file, const char* extension,
           std::initializer_list<std::string> inputs) {
  if (file.empty()) return;
  if (std::filesystem::path(file).extension() != extension) {
    throw Error(ErrorKind::input, fmt::format("{} {}: its name must end in {}", option, file, extension));
  }
  for (const std::string& input : inputs) {
    std::error_code missing;  // a file that does not exist is not overwritten
    if (!input.empty() && std::filesystem::equivalent(input, file, missing)) {
      throw Error(ErrorKind::input, fmt::format("{} {}: would overwrite an input", option, file));
    }
  }
  const OutputFile trial(file);  // leaves nothing behind
}

}  // namespace

void declare_report_files(CLI::App& command, ReportFiles& files) {
  command
      .add_option("--report", files.html,
                  "An interactive page of the mesh and the model that any browser shows, without a network: .html")
      ->option_text("FILE");
  command.add_option("--png", files.png, "A picture of the same: .png")->option_text("FILE");
}

void check_usage(const ReportFiles& files, std::initializer_list<std::string> inputs) {
  check("--report", files.html, ".html", inputs);
  check("--png", files.png, ".png", inputs);
}

void write(const ReportFiles& files, const Report& report) {
  if (!files.html.empty()) write_html_report(files.html, report);
  if (!files.png.empty()) write_picture(files.png, report);
}

}  // namespace verisq::command_line
