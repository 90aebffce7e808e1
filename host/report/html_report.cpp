/// This file implements html_report.hpp.
#include "host/report/html_report.hpp"

#include <algorithm>
#include <array>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/files.hpp>
#include <verisq/report.hpp>

#include "host/files/input_file.hpp"
#include "host/files/output_file.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "host/report/projection.hpp"
#include "report/page_template.hpp"
#include "verify/numbers/points.hpp"

namespace verisq::report {
namespace {

using Digits = boost::archive::iterators::base64_from_binary<
    boost::archive::iterators::transform_width<const char*, 6, 8>>;  // 6 bits a digit, from bytes of 8

}  // namespace

std::string base64(std::span<const std::byte> bytes) {
  const auto* const begin = reinterpret_cast<const char*>(bytes.data());
  const std::size_t rest = bytes.size() % 3;
  const char* const end_of_whole = begin + (bytes.size() - rest);
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  text.append(Digits(begin), Digits(end_of_whole));
  if (rest == 0) return text;
  std::array<char, 3> last{};
  std::copy_n(end_of_whole, rest, last.begin());
  text.append(Digits(last.data()), Digits(last.data() + last.size()));
  text.replace(text.size() - (3 - rest), 3 - rest, 3 - rest, '=');
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t piece = std::size_t{1} << 16;

/// Calls `take` with all bytes of a file.
template <class Take>
void for_each_piece(const std::filesystem::path& path, const Take& take) {
  InputFile file(path);
  while (file.remaining() > 0) {
    const std::size_t size = std::min<std::uint64_t>(piece, file.remaining());
    take(file.take(size, "its bytes"));
  }
}

std::string text_of(const std::filesystem::path& path) {
  std::string text;
  for_each_piece(path, [&](std::string_view bytes) { text += bytes; });
  return text;
}

std::string sha256_of(const std::filesystem::path& path) {
  Sha256 hash;
  for_each_piece(path, [&](std::string_view bytes) { hash.add(std::as_bytes(std::span(bytes))); });
  return hash.digest();
}

template <class Number, std::size_t size>
void append(std::vector<Number>& numbers, const std::array<Number, size>& more) {
  numbers.insert(numbers.end(), more.begin(), more.end());
}

std::vector<double> vertices(const Mesh& mesh) {
  std::vector<double> numbers;
  for (const Point& vertex : mesh.vertices) append(numbers, vertex);
  return numbers;
}

/// The primitives' poses, if they are not those of the file.
Json poses(const Report& report) {
  if (!report.proof->moved) return nullptr;
  std::vector<double> numbers;
  for (const Primitive& primitive : report.implant.primitives) {
    append(numbers, primitive.pose.translation);
    append(numbers, primitive.pose.quaternion);
  }
  return column_text(std::move(numbers));
}

/// As they were read, by primitive; null where no primitive is a mesh.
Json meshes(const Model& model) {
  if (!has_mesh(model)) return nullptr;
  Json result = Json::array();
  for (const Primitive& primitive : model.primitives) {
    if (!primitive.mesh) {
      result.push_back(nullptr);
      continue;
    }
    std::vector<std::uint32_t> corners;
    for (const auto& triangle : primitive.mesh->triangles) append(corners, triangle);
    result.push_back(
        {{"vertices", column_text(vertices(*primitive.mesh))}, {"triangles", column_text(std::move(corners))}});
  }
  return result;
}

/// Points that some rows have.
struct RowPoints {
  std::vector<std::uint32_t> rows;
  std::vector<double> points;

  void add(std::size_t row, const std::optional<Point>& point) {
    if (!point) return;
    rows.push_back(static_cast<std::uint32_t>(row));
    append(points, *point);
  }
};

/// The bits of all rows one after the other, eight in a byte, the highest first.
struct CoverBits {
  std::vector<std::uint32_t> ends;
  std::vector<std::uint8_t> bytes;
  std::uint32_t count = 0;

  void add(const std::vector<bool>& cover) {
    for (const bool bit : cover) {
      if (count % 8 == 0) bytes.push_back(0);
      bytes.back() |= static_cast<std::uint8_t>((bit ? 0x80U : 0U) >> (count++ % 8));
    }
    ends.push_back(count);
  }
};

Json columns_of(std::span<const Certificate> certificates) {
  std::vector<std::uint32_t> ends;
  std::vector<std::uint32_t> primitives;
  std::vector<double> vectors;
  RowPoints escapes;
  RowPoints witnesses;
  CoverBits covers;
  for (std::size_t row = 0; row < certificates.size(); ++row) {
    const Certificate& certificate = certificates[row];
    for (const auto& [primitive, vector] : certificate.normals) {
      primitives.push_back(primitive);
      append(vectors, vector);
    }
    ends.push_back(static_cast<std::uint32_t>(primitives.size()));
    escapes.add(row, certificate.escape);
    witnesses.add(row, certificate.witness);
    covers.add(certificate.cover);
  }
  return {{"normals_end", column_text(std::move(ends))},
          {"primitives", column_text(std::move(primitives))},
          {"normals", column_text(std::move(vectors))},
          {"escaping", column_text(std::move(escapes.rows))},
          {"escapes", column_text(std::move(escapes.points))},
          {"witnessing", column_text(std::move(witnesses.rows))},
          {"witnesses", column_text(std::move(witnesses.points))},
          {"covers_end", column_text(std::move(covers.ends))},
          {"covers", column_text(std::move(covers.bytes))}};
}

}  // namespace

Json proof_data(const Report& report) {
  if (!report.proof) return nullptr;
  const ReportProof& proof = *report.proof;
  const bool is_text = !is_mesh_name(proof.model_file);
  return {{"model", is_text ? Json(text_of(proof.model_file)) : Json(nullptr)},
          {"model_name", proof.model_file.filename().string()},
          {"model_sha256", subject_file(proof.model_file).sha256},
          {"meshes", meshes(report.implant)},
          {"mesh_name", proof.mesh_file.filename().string()},
          {"mesh_sha256", sha256_of(proof.mesh_file)},
          {"poses", poses(report)},
          {"point_radius", proof.point_radius},
          {"vertices", column_text(vertices(report.bone))},
          {"certificates", columns_of(proof.certificates)}};
}

namespace {

/// In JSON these characters only occur within texts.
void write_for_html(OutputFile& file, std::string_view json) {
  while (true) {
    const std::size_t plain = json.find_first_of("<>&");
    file.write(json.substr(0, plain));
    if (plain == std::string_view::npos) return;
    file.write(json[plain] == '<' ? "\\u003c" : json[plain] == '>' ? "\\u003e" : "\\u0026");
    json.remove_prefix(plain + 1);
  }
}

}  // namespace

void write_filled_page(const std::filesystem::path& path, std::string_view page, std::string_view json) {
  constexpr std::string_view marker = "<!--verisq-report-data-->";
  const std::size_t place = page.find(marker);
  OutputFile file(path);
  file.write(page.substr(0, place));
  file.write(R"(<script type="application/json" id="verisq-report">)");
  write_for_html(file, json);
  file.write("</script>");
  file.write(page.substr(place + marker.size()));
  file.finish();
}

}  // namespace verisq::report

namespace verisq {
namespace {

using Json = nlohmann::ordered_json;

/// Rounded to nearest; a number beyond the range of binary32 becomes its end.
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

/// Poses are about the files' origin. The page squares quaternions.
Json path(std::span<const Pose> poses) {
  if (poses.empty()) return nullptr;
  Json path = Json::array();
  for (const Pose& pose : poses)
    path.push_back({{"translation", pose.translation}, {"quaternion", verify::near_one(pose.quaternion)}});
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
  // Non-ASCII characters are escaped; invalid UTF-8 is replaced.
  report::write_filled_page(path, page, data_of(report).dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace verisq
