/// This file implements the drawing of a deviation, by the reports of maps.
#include "host/command_line/deviation_drawing.hpp"

#include <fmt/core.h>

#include <filesystem>

namespace verisq::command_line {
namespace {

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

void write(const ReportFiles& files, const DrawnDeviation& drawn, const DeviationReport& report) {
  write(files, {.title = fmt::format("{}: deviation from {}", file_name(drawn.mesh_file), file_name(drawn.model_file)),
                .bone = drawn.mesh,
                .rows = report.deviation.vertices,
                .implant = drawn.model,
                .units = drawn.model.units,
                .summary = report_lines(report),
                .area_names = {},
                .area_of = {},
                .solid_name = "model"});
}

}  // namespace verisq::command_line
