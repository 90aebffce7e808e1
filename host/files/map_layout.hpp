/// The layout of maps and their certificates in files, and the rows of maps that are read back.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/map_file.hpp>

namespace verisq {

// The declarations of a `.vtp` map and the order of its arrays: for writers and readers.

struct VtpLayout {
  MapElements elements;
  std::uint64_t points;
  std::uint64_t triangles;
  std::optional<std::uint64_t> further_normals;  ///< number of further normals; nothing without certificates
  bool closest_points = false;
  std::optional<std::uint64_t> cover_bits = {};  ///< number of bits; nothing without covers

  [[nodiscard]] bool has_triangles() const { return elements == MapElements::triangles || triangles > 0; }
  /// Triangles, or a vertex cell for each point: points without cells are invisible.
  [[nodiscard]] std::uint64_t cells() const { return has_triangles() ? triangles : points; }
  [[nodiscard]] std::uint64_t corners() const { return has_triangles() ? 3 : 1; }
  [[nodiscard]] std::uint64_t rows() const { return elements == MapElements::vertices ? points : triangles; }
};

/// The whole file before its arrays: the XML up to the '_' after which they are appended. Each array follows the number
/// of its bytes, a UInt64 ("VTK File Formats", XML, appended raw).
[[nodiscard]] std::string vtp_declarations(const VtpLayout& layout);

/// The whole file behind its arrays.
inline constexpr std::string_view vtp_end = "\n  </AppendedData>\n</VTKFile>\n";

// Covers of certificates as text: hexadecimal digits of four bits each (docs/formats.md §5).

/// The first bit is the highest of the first digit; the last digit is filled up with 0.
[[nodiscard]] std::string digits_of_cover(const std::vector<bool>& cover);

/// Nothing unless the text is the digits of one whole cover; its cells determine where it ends.
[[nodiscard]] std::optional<std::vector<bool>> cover_from(std::string_view text);

/// Returns whether the cells end exactly where the bits do.
[[nodiscard]] bool is_whole_cover(const std::vector<bool>& cover);

// Certificates stored by column: the arrays of a `.vtp`.

/// A row for each certificate. The mesh formats know only arrays of one tuple for each point or cell. So the first
/// normal is a column of its own (to be drawn as glyphs), and all others of all rows follow each other in a separate
/// table.
struct CertificateColumns {
  static constexpr std::int32_t no_primitive = -1;
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  static constexpr Point no_escape{none, none, none};
  static constexpr std::array<double, 2> no_weights{none, none};

  MapElements elements = MapElements::vertices;
  std::vector<std::int32_t> primitive;  ///< primitive of the first normal, or no_primitive: then there are no normals
                                        ///< at all
  std::vector<Point> normal;            ///< zero where there is none: a glyph of no length
  std::vector<Point> escape;            ///< for vertices; empty for triangles
  std::vector<std::array<double, 2>> weights;     ///< for triangles; empty for vertices
  std::vector<std::int64_t> further_normals_end;  ///< after the last of the row's in the table below

  std::vector<std::int32_t> further_primitive;
  std::vector<Point> further_normal;

  bool covered = false;                 ///< whether the following members are set
  std::vector<Point> witness;           ///< or no_escape
  std::vector<std::int64_t> cover_end;  ///< after the last of the row's in the table below
  std::vector<std::uint8_t> cover;      ///< 1 or 0

  /// Precondition: indices of primitives below 2^31 (those of any model in memory are), the escape and the
  /// weights not NaN.
  void append(const Certificate& certificate);

  struct Range {
    std::size_t begin;
    std::size_t end;
  };
  /// The range of the further normals of row `row`. Precondition: the ends ascend from 0 or more.
  [[nodiscard]] Range further_normals(std::size_t row) const;

  /// Overwrites `certificate` with row `row`. Precondition: the columns are as `append` leaves them.
  void read(std::size_t row, Certificate& certificate) const;
};

// The columns of a map as CSV, by their names in the first line.

inline constexpr std::string_view csv_map_header = "index,lo,hi,status";

/// The header with certificates, of points. `primitive` and `normal_*` are the first normal, `further_normals` the
/// others, each as "primitive:x:y:z" with a blank between two. Fields that a certificate does not have are empty.
inline constexpr std::string_view csv_certified_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,escape_y,escape_z";

/// The same with witnesses and covers; covers are hexadecimal digits.
inline constexpr std::string_view csv_covered_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,escape_y,escape_z,"
    "witness_x,witness_y,witness_z,cover";

/// The same for triangles, whose certificates have weights instead of an escape.
inline constexpr std::string_view csv_certified_triangle_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,weight_1,weight_2";
inline constexpr std::string_view csv_covered_triangle_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,weight_1,weight_2,"
    "witness_x,witness_y,witness_z,cover";

/// The header of a map with certificates, or with covers, too.
[[nodiscard]] constexpr std::string_view csv_certified_header(MapElements elements, bool covered) {
  if (elements == MapElements::vertices) return covered ? csv_covered_map_header : csv_certified_map_header;
  return covered ? csv_covered_triangle_map_header : csv_certified_triangle_map_header;
}

// The number by which maps colour a row.

/// A finite number inside the enclosure: the middle; the other end if one end is infinite; 0 if both are. Never NaN.
/// NaN.
[[nodiscard]] inline double finite_middle(double lo, double hi) {
  if (std::isfinite(lo) && std::isfinite(hi)) return std::midpoint(lo, hi);
  if (std::isfinite(lo)) return lo;
  return std::isfinite(hi) ? hi : 0.0;
}

// The largest size of a certificate file, for its reader and its writer.

/// Bytes, as of a model file.
constexpr std::size_t largest_certificate = std::size_t{1} << 26;

// Certified maps read back, by the extension of their file; the reader of CSV maps.

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
