/// Picks the format of a map to write by the extension of its file.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/files/map_format.hpp"
#include "host/files/output_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

using Maker = std::unique_ptr<MapFormat> (*)(OutputFile&, const MapKind&);

/// A format and what it has a place for.
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

/// The extensions of the formats that have `trait`, of which there are several: ".csv, .npy and .json".
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
    refuse(fmt::format("unknown map format {}: known are .csv, .npy, .vtp, .ply, .json",
                       in_quotes(form.format.empty() ? path.extension().string() : form.format)));
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

/// A stream tells at its beginning how many rows of an array will follow.
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
    : format_(std::make_unique<Format>(path, mesh, form)) {}
MapWriter::~MapWriter() = default;
MapWriter::MapWriter(MapWriter&&) noexcept = default;
MapWriter& MapWriter::operator=(MapWriter&&) noexcept = default;

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

}  // namespace verisq
