/// Certified maps read back, by the extension of their file; the reader of CSV maps.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <verisq/map_file.hpp>

namespace verisq {

/// The rows of a certified map, front to back. Throws Error as `MapReader` does.
class MapRows {
 public:
  MapRows() = default;
  MapRows(const MapRows&) = delete;
  MapRows& operator=(const MapRows&) = delete;
  virtual ~MapRows() = default;

  [[nodiscard]] virtual MapElements elements() const = 0;

  /// Fills `rows` from the front; returns the number of rows, less than requested only at the end of the map.
  virtual std::size_t read(std::span<CertifiedRow> rows) = 0;

  // Like those of `MapReader`.
  [[nodiscard]] virtual bool draws() const { return false; }
  [[nodiscard]] virtual std::optional<MapDifference> difference_from(const Mesh& /*mesh*/) const { return {}; }
};

/// The extent of the map that a file contains, by its name.
enum class MapExtent {
  whole,
  part,  ///< the rows before an early end, the last of them perhaps not whole
};

[[nodiscard]] std::unique_ptr<MapRows> open_csv_map(const std::filesystem::path& path, MapExtent extent);
[[nodiscard]] std::unique_ptr<MapRows> open_vtp_map(const std::filesystem::path& path);

/// The defect of a sound map that has nothing to check, and its remedy.
inline constexpr std::string_view without_certificates =
    "written without `certificates`: map again with `certificates`";

}  // namespace verisq
