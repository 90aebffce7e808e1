/// Picks the reader of a certified map by the extension of its file.
#include <fmt/format.h>

#include <new>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/files/map_rows.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

std::unique_ptr<MapRows> open_map(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".csv") return open_csv_map(path);
  if (extension == ".vtp") return open_vtp_map(path);
  // What an interrupted map leaves is a map of its own, for the formats that leave anything.
  if (extension == ".partial" && lower_case(path.stem().extension().string()) == ".csv") return open_csv_map(path);
  throw Error(ErrorKind::input,
              fmt::format("{}: a map as {}: check reads .csv and .vtp", path.string(), in_quotes(extension)));
}

}  // namespace

class MapReader::Format {
 public:
  explicit Format(const std::filesystem::path& path) : rows_(open_map(path)) {}
  [[nodiscard]] MapElements elements() const { return rows_->elements(); }
  std::size_t read(std::span<CertifiedRow> rows) { return rows_->read(rows); }

 private:
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
  return format_->elements();
}

std::size_t MapReader::read(std::span<CertifiedRow> rows) {
  return format_->read(rows);
}

}  // namespace verisq
