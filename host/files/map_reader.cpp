/// Picks the reader of a certified map by the extension of its file.
#include <fmt/format.h>

#include <new>
#include <optional>
#include <string_view>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/files/map_rows.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

/// The digits that tell the unfinished files of runs apart, with the dot before them: see OutputFile.
bool is_of_a_run(std::string_view extension) {
  return extension.size() == 9 && extension.find_first_not_of("0123456789abcdef", 1) == std::string_view::npos;
}

/// A map by its name: OUT, or what is left of it by an interrupted run, OUT.partial, or by a killed one,
/// OUT.1a2b3c4d.partial.
struct MapName {
  explicit MapName(std::filesystem::path name) {
    std::string last = lower_case(name.extension().string());
    if (last == ".partial") {
      extent = MapExtent::part;
      name = name.stem();
      killed = is_of_a_run(name.extension().string());
      if (killed) name = name.stem();
      last = lower_case(name.extension().string());
    }
    format = last;
  }

  std::string format;  ///< ".csv"
  MapExtent extent = MapExtent::whole;
  bool killed = false;
};

std::unique_ptr<MapRows> open_map(const std::filesystem::path& path) {
  const auto refuse = [&](std::string_view why) {
    throw Error(ErrorKind::input, fmt::format("{}: {}", path.string(), why));
  };
  const MapName name(path);
  if (name.format == ".csv") return open_csv_map(path, name.extent);
  if (name.format == ".vtp") {
    if (name.extent == MapExtent::whole) return open_vtp_map(path);
    if (name.killed) refuse("what a killed run left of a .vtp, which is written when all is known: map again");
  }
  refuse(fmt::format("a map as {}: check reads .csv and .vtp", in_quotes(lower_case(path.extension().string()))));
  return {};
}

}  // namespace

class MapReader::Format {
 public:
  explicit Format(const std::filesystem::path& path)
      : partial_(MapName(path).extent == MapExtent::part), rows_(open_map(path)) {}
  [[nodiscard]] bool partial() const { return partial_; }
  [[nodiscard]] MapRows& rows() const { return *rows_; }

 private:
  bool partial_;
  std::unique_ptr<MapRows> rows_;
};

MapReader::MapReader(const std::filesystem::path& path) try : format_(std::make_unique<Format>(path)) {
} catch (const std::bad_alloc&) {
  throw Error(ErrorKind::failure, fmt::format("{}: not enough memory for this map", path.string()));
}
MapReader::~MapReader() = default;
MapReader::MapReader(MapReader&&) noexcept = default;
MapReader& MapReader::operator=(MapReader&&) noexcept = default;

MapElements MapReader::elements() const {
  return format_->rows().elements();
}

bool MapReader::partial() const {
  return format_->partial();
}

std::size_t MapReader::read(std::span<CertifiedRow> rows) {
  return format_->rows().read(rows);
}

bool MapReader::draws() const {
  return format_->rows().draws();
}

std::optional<MapDifference> MapReader::difference_from(const Mesh& mesh) const {
  return format_->rows().difference_from(mesh);
}

}  // namespace verisq
