/// This file implements map_file.hpp.
#include "host/files/map_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/files/map_layout.hpp"
#include "host/files/output_file.hpp"
#include "host/files/words.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using Maker = std::unique_ptr<MapFormat> (*)(OutputFile&, const MapKind&);

/// A format and the data for which it has a place.
struct FormatTraits {
  std::string_view extension;
  Maker make;
  bool poses;
  bool certificates;
  bool columns;
  bool closest_points;
};

constexpr std::array formats{FormatTraits{".csv", make_csv_map, true, true, true, true},
                             FormatTraits{".npy", make_npy_map, true, false, true, true},
                             FormatTraits{".vtp", make_vtp_map, false, true, false, true},
                             FormatTraits{".ply", make_ply_map, false, false, false, false},
                             FormatTraits{".json", make_json_map, true, false, false, false}};

/// The extensions of the formats that have `trait`; there are several: ".csv, .npy and .json".
std::string extensions_with(bool FormatTraits::*trait) {
  std::vector<std::string_view> names;
  for (const FormatTraits& format : formats) {
    if (format.*trait) names.push_back(format.extension);
  }
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

bool is_coordinate(MapColumn column) {
  return column == MapColumn::x || column == MapColumn::y || column == MapColumn::z;
}

Maker maker_for(const std::filesystem::path& path, const MapForm& form) {
  const auto refuse = [&path](std::string_view why) {
    throw Error(ErrorKind::input, fmt::format("{}: {}", path.string(), why));
  };
  const std::string extension = lower_case(form.format.empty() ? path.extension().string() : form.format);
  const auto* const format = std::ranges::find(formats, extension, &FormatTraits::extension);
  if (format == formats.end()) {
    refuse(fmt::format("unknown map format {}: known are .csv, .npy, .vtp, .ply, .json{}",
                       in_quotes(form.format.empty() ? path.extension().string() : form.format),
                       extension.empty() ? "; end the file's name in one, or name the format" : ""));
  }
  const bool certified = has_certificates(form.contents);
  if (form.elements == MapElements::poses) {
    if (!format->poses) {
      refuse(fmt::format("maps of poses are written to {} only", extensions_with(&FormatTraits::poses)));
    }
    if (certified) refuse("maps of poses have no certificates");
  }
  if (certified && !format->certificates) {
    refuse(fmt::format("certificates are written to {} only", extensions_with(&FormatTraits::certificates)));
  }
  if (form.contents == MapContents::closest_points) {
    if (form.elements == MapElements::triangles) refuse("closest points are those of points and poses only");
    if (!format->closest_points) {
      refuse(fmt::format("closest points are written to {} only", extensions_with(&FormatTraits::closest_points)));
    }
  } else if (std::ranges::any_of(form.columns, is_of_closest_point)) {
    refuse("columns of closest points in a map without them");
  }
  const bool pairs = form.elements == MapElements::poses;
  if (std::ranges::any_of(form.columns, [&](MapColumn column) {
        return column != MapColumn::unique && is_of_closest_point(column) && is_of_closest_pair(column) != pairs;
      })) {
    refuse(pairs ? "columns of points in a map of poses" : "columns of poses in a map of points");
  }
  for (auto column = form.columns.begin(); column != form.columns.end(); ++column) {
    if (std::find(form.columns.begin(), column, *column) != column) {
      refuse(fmt::format("column {} twice", to_string(*column)));
    }
  }
  if (!form.columns.empty()) {
    if (!format->columns) {
      refuse(fmt::format("columns are chosen of {} only", extensions_with(&FormatTraits::columns)));
    }
    if (certified) refuse("the columns of certificates are not to be chosen");
    if (form.elements != MapElements::vertices && std::ranges::any_of(form.columns, is_coordinate)) {
      refuse("x, y, z are columns of maps of points only");
    }
  }
  return format->make;
}

/// Some formats state at their beginning the number of rows that follow.
void refuse_unknown_length(const std::filesystem::path& path, const OutputFile& output, Maker make,
                           const MapForm& form) {
  if (make != make_npy_map || output.can_be_rewritten() || form.rows) return;
  throw Error(ErrorKind::input, fmt::format("{}: a .npy begins with the number of its rows, which is not known of such "
                                            "an input: give a file, or .csv",
                                            path.string()));
}

OutputFile open_output(const std::filesystem::path& path) {
  return path == "-" ? OutputFile::standard_output() : OutputFile(path);
}

}  // namespace

/// The file and the format that fills it.
class MapWriter::Format {
 public:
  Format(const std::filesystem::path& path, const Mesh* mesh, const MapForm& form)
      : make_(maker_for(path, form)), output_(open_output(path)) {
    refuse_unknown_length(path, output_, make_, form);
    rows_ = make_(output_, {mesh, form.contents, form.elements, form.columns, form.rows, form.first_row});
  }

  void append(const MapChunk& chunk) { rows_->append(chunk); }
  void finish() {
    rows_->finish();
    output_.finish();
  }
  std::filesystem::path keep_partial() {
    if (!rows_->valid_after_any_row()) return {};
    return output_.finish_as_partial();
  }

 private:
  Maker make_;  // before the file: an unknown extension must not leave a file
  OutputFile output_;
  std::unique_ptr<MapFormat> rows_;
};

MapWriter::MapWriter(const std::filesystem::path& path, const Mesh* mesh, MapContents contents, MapElements elements)
    : MapWriter(path, mesh, MapForm{.contents = contents, .elements = elements}) {}
MapWriter::MapWriter(const std::filesystem::path& path, const Mesh* mesh, const MapForm& form)
    : format_(hidden<Format>(path, mesh, form)) {}

void MapWriter::append(std::span<const Point> points, std::span<const MapResult> results,
                       std::span<const Certificate> certificates) {
  format_->append({points, results, certificates});
}

void MapWriter::append(std::span<const MapResult> results, std::span<const Certificate> certificates) {
  format_->append({{}, results, certificates});
}

void MapWriter::append_closest(std::span<const Point> points, std::span<const MapResult> results,
                               std::span<const ClosestPoint> closest) {
  format_->append({points, results, {}, closest});
}

void MapWriter::append_closest(std::span<const MapResult> results, std::span<const ClosestPoints> closest) {
  format_->append({{}, results, {}, {}, closest});
}

void MapWriter::finish() {
  format_->finish();
}

std::filesystem::path MapWriter::keep_partial() {
  return format_->keep_partial();
}

namespace {

/// At least hi - lo, which a binary64 number need not be.
double width_of(const Enclosure& distance) {
  if (!std::isfinite(distance.lo) || !std::isfinite(distance.hi)) return infinity;
  return verify::subtract(distance.hi, distance.lo, verify::Direction::up);
}

/// The ends of one box, then those of another, in the order of the columns from `first` on.
double end_in(MapColumn column, MapColumn first, const EnclosedPoint& one, const EnclosedPoint& other) {
  const int offset = static_cast<int>(column) - static_cast<int>(first);
  const Enclosure& coordinate = (offset < 6 ? one : other)[static_cast<std::size_t>(offset % 6 / 2)];
  return offset % 2 == 0 ? coordinate.lo : coordinate.hi;
}

}  // namespace

double number_in(MapColumn column, const MapRow& row) {
  if (is_of_closest_pair(column)) return end_in(column, MapColumn::on_a_x_lo, row.pair->on_a, row.pair->on_b);
  if (is_of_closest_point(column))
    return end_in(column, MapColumn::closest_x_lo, row.closest->point, row.closest->normal);
  const auto& [lo, hi] = row.result.distance;
  switch (column) {
    case MapColumn::x: return (*row.point)[0];
    case MapColumn::y: return (*row.point)[1];
    case MapColumn::z: return (*row.point)[2];
    case MapColumn::hi: return hi;
    case MapColumn::mid: return finite_middle(lo, hi);
    case MapColumn::width: return width_of(row.result.distance);
    default: return lo;
  }
}

bool is_unique(const MapRow& row) {
  return row.pair == nullptr ? row.closest->unique : row.pair->unique;
}

std::int32_t primitive_in(const ClosestPoint& closest) {
  return closest.primitive ? static_cast<std::int32_t>(*closest.primitive) : -1;
}

std::vector<MapColumn> columns_of_closest_points(MapElements elements) {
  const bool pairs = elements == MapElements::poses;
  const MapColumn first = pairs ? MapColumn::on_a_x_lo : MapColumn::closest_x_lo;
  const MapColumn last = pairs ? MapColumn::on_b_z_hi : MapColumn::primitive;
  std::vector<MapColumn> columns{MapColumn::unique};
  for (int k = static_cast<int>(first); k <= static_cast<int>(last); ++k) columns.push_back(static_cast<MapColumn>(k));
  return columns;
}

AppendedRows::AppendedRows(const Mesh* mesh, MapElements elements, std::uint64_t first, const MapChunk& chunk)
    : first_(first),
      points_(chunk.points),
      results_(chunk.results),
      closest_(chunk.closest),
      pairs_(chunk.closest_pairs) {
  if (!points_.empty() || mesh == nullptr || elements != MapElements::vertices) return;
  const std::span<const Point> vertices = mesh->vertices;
  points_ = vertices.subspan(static_cast<std::size_t>(first), results_.size());
}

CollectedMap::CollectedMap(const MapKind& kind) : mesh_(kind.mesh), elements_(kind.elements) {
  const std::size_t rows = complete_size();
  lo_.reserve(rows);
  hi_.reserve(rows);
  statuses_.reserve(rows);
}

void CollectedMap::append(std::span<const Point> points, std::span<const MapResult> results) {
  if (mesh_ == nullptr) points_.insert(points_.end(), points.begin(), points.end());
  for (const MapResult& result : results) {
    lo_.push_back(result.distance.lo);
    hi_.push_back(result.distance.hi);
    statuses_.push_back(static_cast<std::uint8_t>(result.status));
  }
}

void CollectedMap::check_complete(const OutputFile& output) const {
  if (complete_size() == statuses_.size()) return;
  output.fail(fmt::format("{} results for {} {}", statuses_.size(), complete_size(),
                          elements_ == MapElements::vertices ? "vertices" : "triangles"));
}

std::size_t CollectedMap::complete_size() const {
  return elements_ == MapElements::vertices ? vertices().size() : triangles().size();
}

std::span<const Point> CollectedMap::vertices() const {
  return mesh_ == nullptr ? points_ : mesh_->vertices;
}

std::span<const std::array<std::uint32_t, 3>> CollectedMap::triangles() const {
  if (mesh_ == nullptr) return {};
  return mesh_->triangles;
}

namespace {

class PlyMap final : public MapFormat {
 public:
  PlyMap(OutputFile& output, const MapKind& kind) : output_(output), map_(kind) {}

  void append(const MapChunk& chunk) override { map_.append(chunk.points, chunk.results); }

  void finish() override {
    map_.check_complete(output_);
    write_header();
    for (std::size_t k = 0; k < map_.vertices().size(); ++k) {
      output_.write_little_endian<double>(map_.vertices()[k]);
      if (map_.elements() == MapElements::vertices) write_result(k);
    }
    for (std::size_t k = 0; k < map_.triangles().size(); ++k) {
      output_.write(std::string_view("\3", 1));  // corners
      output_.write_little_endian<std::uint32_t>(map_.triangles()[k]);
      if (map_.elements() == MapElements::triangles) write_result(k);
    }
  }

 private:
  void write_header() {
    output_.write("ply\nformat binary_little_endian 1.0\ncomment verisq-map/1; status: 0 device-verified, ");
    output_.write("1 host-verified, 2 wide\n");
    output_.write(fmt::format("element vertex {}\n", map_.vertices().size()));
    output_.write("property double x\nproperty double y\nproperty double z\n");
    if (map_.elements() == MapElements::vertices) output_.write(result_properties);
    if (map_.elements() == MapElements::triangles || !map_.triangles().empty()) {
      output_.write(fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", map_.triangles().size()));
    }
    if (map_.elements() == MapElements::triangles) output_.write(result_properties);
    output_.write("end_header\n");
  }

  void write_result(std::size_t k) {
    const double lo = map_.lo()[k];
    const double hi = map_.hi()[k];
    output_.write_little_endian<double>(std::array{lo, hi, finite_middle(lo, hi)});
    output_.write_little_endian(map_.statuses().subspan(k, 1));
  }

  static constexpr std::string_view result_properties =
      "property double dist_lo\nproperty double dist_hi\nproperty double dist_mid\nproperty uchar status\n";

  OutputFile& output_;
  CollectedMap map_;
};

}  // namespace

std::unique_ptr<MapFormat> make_ply_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<PlyMap>(output, kind);
}

}  // namespace verisq
