/// The data of a report as JSON (report/README.md), in its place in the page.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/report.hpp>

#include "host/files/output_file.hpp"
#include "host/mesh/extent.hpp"
#include "host/report/base64.hpp"
#include "host/report/model_surface.hpp"
#include "host/report/seated_implant.hpp"
#include "host/report/view.hpp"
#include "report/page_template.hpp"

namespace verisq {
namespace {

using Json = nlohmann::ordered_json;

template <class Number>
std::string text_of(std::vector<Number> numbers) {
  if constexpr (sizeof(Number) > 1) {
    std::ranges::transform(numbers, numbers.begin(), [](Number number) { return in_little_endian(number); });
  }
  return report::base64(std::as_bytes(std::span(numbers)));
}

/// To nearest; what is beyond the range of binary32 stops at its end.
float to_binary32(double x) {
  constexpr double largest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -largest, largest));
}

Json surface(const Mesh& mesh, const Point& centre) {
  std::vector<float> positions;
  positions.reserve(3 * mesh.vertices.size());
  for (const Point& vertex : mesh.vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis) positions.push_back(to_binary32(vertex[axis] - centre[axis]));
  }
  std::vector<std::uint32_t> triangles;
  triangles.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) triangles.insert(triangles.end(), triangle.begin(), triangle.end());
  return {{"positions", text_of(std::move(positions))}, {"triangles", text_of(std::move(triangles))}};
}

template <class Number, class Part>
std::string column(std::span<const MapResult> rows, const Part& part) {
  std::vector<Number> numbers(rows.size());
  std::ranges::transform(rows, numbers.begin(), part);
  return text_of(std::move(numbers));
}

/// As the poses are: about the files' origin.
Json path(std::span<const Pose> poses) {
  if (poses.empty()) return nullptr;
  Json path = Json::array();
  for (const Pose& pose : poses) path.push_back({{"translation", pose.translation}, {"quaternion", pose.quaternion}});
  return path;
}

Json areas(const Report& report) {
  if (report.area_names.empty()) return nullptr;
  return {{"names", report.area_names},
          {"of", text_of(std::vector<std::uint32_t>(report.area_of.begin(), report.area_of.end()))}};
}

Json data_of(const Report& report) {
  const Point centre = extent_of(report.bone.vertices).centre();
  const Mesh implant = report::model_surface(report.implant);
  const Eigen::Vector3d up = report::upright(report.bone, report::seated_surface(report), report.up);
  Json summary = Json::array();
  for (const ReportLine& line : report.summary) summary.push_back({{"label", line.label}, {"value", line.value}});
  return {
      {"format", "verisq-report/1"},
      {"title", report.title},
      {"units", report.units},
      {"solid_name", report.solid_name},
      {"range", report.range.value_or(default_range(report.rows, report.units))},
      {"up", std::array{up[0], up[1], up[2]}},
      {"summary", summary},
      {"centre", centre},
      {"bone", surface(report.bone, centre)},
      {"implant", surface(implant, centre)},
      {"lo", column<double>(report.rows, [](const MapResult& row) { return row.distance.lo; })},
      {"hi", column<double>(report.rows, [](const MapResult& row) { return row.distance.hi; })},
      {"status",
       column<std::uint8_t>(report.rows, [](const MapResult& row) { return static_cast<std::uint8_t>(row.status); })},
      {"areas", areas(report)},
      {"path", path(report.path)},
  };
}

/// Writes JSON so that no text in it can end the script element around it or open another: in JSON these characters
/// occur within texts alone. What is not ASCII is escaped, too; what is not UTF-8 is replaced.
void write_for_html(OutputFile& file, const Json& json) {
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string_view rest = text;
  while (true) {
    const std::size_t plain = rest.find_first_of("<>&");
    file.write(rest.substr(0, plain));
    if (plain == std::string_view::npos) return;
    file.write(rest[plain] == '<' ? "\\u003c" : rest[plain] == '>' ? "\\u003e" : "\\u0026");
    rest.remove_prefix(plain + 1);
  }
}

}  // namespace

void write_html_report(const std::filesystem::path& path, const Report& report) {
  constexpr std::string_view marker = "<!--verisq-report-data-->";
  const std::string_view page = report::page_template();
  const std::size_t place = page.find(marker);
  OutputFile file(path);
  file.write(page.substr(0, place));
  file.write(R"(<script type="application/json" id="verisq-report">)");
  write_for_html(file, data_of(report));
  file.write("</script>");
  file.write(page.substr(place + marker.size()));
  file.finish();
}

}  // namespace verisq
