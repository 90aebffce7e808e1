/// What a `.vtp` map declares and in which order its arrays follow each other: for who writes and who reads it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <verisq/map_file.hpp>

namespace verisq {

struct VtpLayout {
  MapElements elements;
  std::uint64_t points;
  std::uint64_t triangles;
  std::optional<std::uint64_t> further_normals;  ///< how many; nothing without certificates
  bool closest_points = false;
  std::optional<std::uint64_t> cover_bits = {};  ///< how many; nothing without covers

  [[nodiscard]] bool has_triangles() const { return elements == MapElements::triangles || triangles > 0; }
  /// Triangles, or a vertex cell for each point: points without cells are invisible.
  [[nodiscard]] std::uint64_t cells() const { return has_triangles() ? triangles : points; }
  [[nodiscard]] std::uint64_t corners() const { return has_triangles() ? 3 : 1; }
  [[nodiscard]] std::uint64_t rows() const { return elements == MapElements::vertices ? points : triangles; }
};

/// All of the file that is before its arrays: the XML as far as the '_' from which on they are appended, each after
/// the number of its bytes, a UInt64 ("VTK File Formats", XML, appended raw).
[[nodiscard]] std::string vtp_declarations(const VtpLayout& layout);

/// All that is behind them.
inline constexpr std::string_view vtp_end = "\n  </AppendedData>\n</VTKFile>\n";

}  // namespace verisq
