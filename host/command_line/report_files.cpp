/// Checks and writes the files of a report.
#include "host/command_line/report_files.hpp"

#include <fmt/core.h>

#include <filesystem>

#include "host/command_line/overwriting.hpp"
#include "host/command_line/refusal.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {
namespace {

void check(const char* option, const std::string& file, const char* extension, const std::vector<std::string>& inputs) {
  if (file.empty()) return;
  if (std::filesystem::path(file).extension() != extension) {
    refuse(fmt::format("{} {}: its name must end in {}", option, file, extension));
  }
  refuse_to_overwrite(option, file, inputs);
  const OutputFile trial(file);  // leaves nothing behind
}

}  // namespace

void declare_report_files(Options& options, ReportFiles& files) {
  options.add("--report", files.html, "FILE",
              "An interactive page of the mesh and the model that any browser shows, without a network: .html");
  options.add("--png", files.png, "FILE", "A picture of the same: .png");
}

void check_usage(const ReportFiles& files, const std::vector<std::string>& inputs) {
  check("--report", files.html, ".html", inputs);
  check("--png", files.png, ".png", inputs);
}

void write(const ReportFiles& files, const Report& report) {
  if (!files.html.empty()) write_html_report(files.html, report);
  if (!files.png.empty()) write_picture(files.png, report);
}

}  // namespace verisq::command_line
