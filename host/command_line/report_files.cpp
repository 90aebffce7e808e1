/// Checks and writes the files of a report.
#include "host/command_line/report_files.hpp"

#include <fmt/core.h>

#include <filesystem>

#include "host/command_line/direction_option.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/errors/refusal.hpp"
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
  options.add("--range", files.range, parse_positive_length, "NUMBER",
              "Where the colours of both end, in model units (default: 3 mm where a tenth of the vertices is nearer,\n"
              "else where few are beyond)");
  options.add("--up", files.up, parse_direction, "x,y,z",
              "What both show on top (default: the mesh's long axis, at the model's end)");
}

void check_usage(const ReportFiles& files, const std::vector<std::string>& inputs,
                 const std::vector<std::string>& outputs) {
  if (!files.any() && files.range) refuse("--range: give the --report or --png that it is for");
  if (!files.any() && files.up) refuse("--up: give the --report or --png that it is for");
  check("--report", files.html, ".html", inputs);
  check("--png", files.png, ".png", inputs);
  std::vector<std::string> all{files.html, files.png};
  all.insert(all.end(), outputs.begin(), outputs.end());
  refuse_one_file_twice(all);
}

void write(const ReportFiles& files, const Report& report) {
  Report shown = report;
  if (files.range) shown.range = files.range;
  if (files.up) shown.up = files.up;
  if (!files.html.empty()) write_html_report(files.html, shown);
  if (!files.png.empty()) write_picture(files.png, shown);
}

}  // namespace verisq::command_line
