/// The data of a report as JSON (report/README.md), in its place in the page.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>
#include <verisq/report.hpp>

#include "host/mesh/extent.hpp"
#include "host/report/column_text.hpp"
#include "host/report/filled_page.hpp"
#include "host/report/model_surface.hpp"
#include "host/report/proof_data.hpp"
#include "host/report/seated_implant.hpp"
#include "host/report/view.hpp"
#include "report/page_template.hpp"

namespace verisq {
namespace {

using Json = nlohmann::ordered_json;

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
  return {{"positions", report::column_text(std::move(positions))},
          {"triangles", report::column_text(std::move(triangles))}};
}

template <class Number, class Part>
std::string column(std::span<const MapResult> rows, const Part& part) {
  std::vector<Number> numbers(rows.size());
  std::ranges::transform(rows, numbers.begin(), part);
  return report::column_text(std::move(numbers));
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
          {"of", report::column_text(std::vector<std::uint32_t>(report.area_of.begin(), report.area_of.end()))}};
}

Json data_of(const Report& report) {
  const Point centre = extent_of(report.bone.vertices).centre();
  const Mesh implant = report::model_surface(report.implant);
  const Mesh seated = report::seated_surface(report);
  const Eigen::Vector3d up = report::upright(report.bone, seated, report.up);
  const Eigen::Vector3d front = report::broad_view(report.bone, seated, up).axes.row(2);
  Json summary = Json::array();
  for (const ReportLine& line : report.summary) summary.push_back({{"label", line.label}, {"value", line.value}});
  return {
      {"format", "verisq-report/1"},
      {"title", report.title},
      {"units", report.units},
      {"solid_name", report.solid_name},
      {"range", report.range.value_or(default_range(report.rows, report.units))},
      {"up", std::array{up[0], up[1], up[2]}},
      {"front", std::array{front[0], front[1], front[2]}},
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
      {"proof", report::proof_data(report)},
  };
}

/// The page has its checker, of some 400 kB, between these, for pages with certificates alone.
constexpr std::string_view prover_begins = "<!--verisq-prover-->";
constexpr std::string_view prover_ends = "<!--/verisq-prover-->";

std::string page_without_prover() {
  const std::string_view page = report::page_template();
  const std::size_t first = page.find(prover_begins);
  const std::size_t last = page.find(prover_ends);
  return std::string(page.substr(0, first)).append(page.substr(last + prover_ends.size()));
}

}  // namespace

void write_html_report(const std::filesystem::path& path, const Report& report) {
  const std::string page = report.proof ? std::string(report::page_template()) : page_without_prover();
  // What is not ASCII is escaped; what is not UTF-8 is replaced.
  report::write_filled_page(path, page, data_of(report).dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace verisq
