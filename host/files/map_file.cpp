/// Picks the format of a map to write by the extension of its file.
#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/files/map_format.hpp"
#include "host/files/output_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

using Maker = std::unique_ptr<MapFormat> (*)(OutputFile&, const MapKind&);

Maker maker_for(const std::filesystem::path& path, const MapKind& kind) {
  const auto refuse = [&path](std::string_view why) {
    throw Error(ErrorKind::input, fmt::format("{}: {}", path.string(), why));
  };
  const std::string extension = lower_case(path.extension().string());
  const Maker make = extension == ".csv"    ? make_csv_map
                     : extension == ".vtp"  ? make_vtp_map
                     : extension == ".ply"  ? make_ply_map
                     : extension == ".json" ? make_json_map
                                            : nullptr;
  if (make == nullptr) {
    refuse(
        fmt::format("unknown map format {}: known are .csv, .vtp, .ply, .json", in_quotes(path.extension().string())));
  }
  const bool certified = kind.contents == MapContents::certified;
  if (kind.elements == MapElements::poses) {
    if (make == make_vtp_map || make == make_ply_map) refuse("maps of poses are written to .csv and .json only");
    if (certified) refuse("maps of poses have no certificates");
  }
  if (certified && make != make_csv_map && make != make_vtp_map) {
    refuse("certificates are written to .csv and .vtp only");
  }
  return make;
}

}  // namespace

/// The file and the format that fills it.
class MapWriter::Format {
 public:
  Format(const std::filesystem::path& path, const MapKind& kind)
      : make_(maker_for(path, kind)), output_(path), rows_(make_(output_, kind)) {}

  void append(std::span<const Point> points, std::span<const MapResult> results,
              std::span<const Certificate> certificates) {
    rows_->append(points, results, certificates);
  }
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
    : format_(std::make_unique<Format>(path, MapKind{mesh, contents, elements})) {}
MapWriter::~MapWriter() = default;
MapWriter::MapWriter(MapWriter&&) noexcept = default;
MapWriter& MapWriter::operator=(MapWriter&&) noexcept = default;

void MapWriter::append(std::span<const Point> points, std::span<const MapResult> results,
                       std::span<const Certificate> certificates) {
  format_->append(points, results, certificates);
}

void MapWriter::append(std::span<const MapResult> results, std::span<const Certificate> certificates) {
  format_->append({}, results, certificates);
}

void MapWriter::finish() {
  format_->finish();
}

std::filesystem::path MapWriter::keep_partial() {
  return format_->keep_partial();
}

}  // namespace verisq
