/// Maps to files: the formats, one class each, their common columns and rows, and the digits of numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>
#include <verisq/mesh.hpp>

#include "host/files/output_file.hpp"

namespace verisq {

// Maps to files: the formats, one class each, their common columns and rows, and PLY.

// The map formats: one class and one source file each.

/// As defined by the constructor of `MapWriter`.
struct MapKind {
  const Mesh* mesh;  ///< must outlive the format; may be null for vertices: then the appended points are the vertices
  MapContents contents;
  MapElements elements;
  std::vector<MapColumn> columns;     ///< columns of tables; empty: the format's own columns
  std::optional<std::uint64_t> rows;  ///< number of rows; nothing if it is not known
  std::uint64_t first_row = 0;        ///< index of the first row
};

[[nodiscard]] constexpr bool has_certificates(MapContents contents) {
  return contents == MapContents::certified || contents == MapContents::covered;
}

/// The arguments of one call of `MapWriter`.
struct MapChunk {
  std::span<const Point> points;  ///< may be absent if there is a mesh
  std::span<const MapResult> results;
  std::span<const Certificate> certificates = {};
  std::span<const ClosestPoint> closest = {};
  std::span<const ClosestPoints> closest_pairs = {};
};

/// Writes one map to the output file it was made with. Throws Error(failure).
class MapFormat {
 public:
  MapFormat() = default;
  MapFormat(const MapFormat&) = delete;
  MapFormat& operator=(const MapFormat&) = delete;
  virtual ~MapFormat() = default;

  /// Precondition: as for `MapWriter::append`.
  virtual void append(const MapChunk& chunk) = 0;
  virtual void finish() = 0;  ///< writes the rest; the file itself must be finished afterwards
  /// Returns whether the file is a valid map of its own after any number of rows.
  [[nodiscard]] virtual bool valid_after_any_row() const { return false; }
};

// `output` must outlive the format. JSON, PLY and NPY have no place for certificates. NPY needs an output that
// can be rewritten, or the number of rows.
[[nodiscard]] std::unique_ptr<MapFormat> make_csv_map(OutputFile& output, const MapKind& kind);
[[nodiscard]] std::unique_ptr<MapFormat> make_json_map(OutputFile& output, const MapKind& kind);
[[nodiscard]] std::unique_ptr<MapFormat> make_npy_map(OutputFile& output, const MapKind& kind);
[[nodiscard]] std::unique_ptr<MapFormat> make_vtp_map(OutputFile& output, const MapKind& kind);
/// The same bytes. Precondition: a mesh, no certificates, an output that can be rewritten.
[[nodiscard]] std::unique_ptr<MapFormat> make_streamed_vtp_map(OutputFile& output, const MapKind& kind);
[[nodiscard]] std::unique_ptr<MapFormat> make_ply_map(OutputFile& output, const MapKind& kind);

// The columns of maps that are tables: their contents, and the default columns of a format.

/// A row of a map that is being written.
struct MapRow {
  std::uint64_t index;
  const Point* point;  ///< null for triangles and poses
  MapResult result;
  const ClosestPoint* closest;  ///< null where the map has none
  const ClosestPoints* pair;    ///< closest points of poses; null without them
};

/// Precondition: a column of numbers that are neither whole numbers nor words; no coordinate if there is no point. The
/// width is rounded upward.
[[nodiscard]] double number_in(MapColumn column, const MapRow& row);

/// Precondition: a row with closest points.
[[nodiscard]] bool is_unique(const MapRow& row);

/// The index of the deciding primitive; -1 if it is not known.
[[nodiscard]] std::int32_t primitive_in(const ClosestPoint& closest);

/// The columns of closest points, in their order.
[[nodiscard]] std::vector<MapColumn> columns_of_closest_points(MapElements elements);

/// The rows of one call of `MapFormat::append`, with the points of a mesh if the call gives none. Views of all parts.
class AppendedRows {
 public:
  /// `first` is the index of the first row.
  AppendedRows(const Mesh* mesh, MapElements elements, std::uint64_t first, const MapChunk& chunk);

  [[nodiscard]] std::size_t size() const { return results_.size(); }
  [[nodiscard]] MapRow operator[](std::size_t k) const {
    return {first_ + k, points_.empty() ? nullptr : &points_[k], results_[k], closest_.empty() ? nullptr : &closest_[k],
            pairs_.empty() ? nullptr : &pairs_[k]};
  }

 private:
  std::uint64_t first_;
  std::span<const Point> points_;
  std::span<const MapResult> results_;
  std::span<const ClosestPoint> closest_;
  std::span<const ClosestPoints> pairs_;
};

// A map kept in memory until it is complete: the mesh formats write it at the end.

class CollectedMap {
 public:
  explicit CollectedMap(const MapKind& kind);

  void append(std::span<const Point> points, std::span<const MapResult> results);

  /// Throws Error(failure) naming `output`'s file unless there is exactly one result for each vertex or triangle. A
  /// mesh whose map was ended early has no representation of unknown results.
  void check_complete(const OutputFile& output) const;

  [[nodiscard]] MapElements elements() const { return elements_; }
  [[nodiscard]] std::span<const Point> vertices() const;
  [[nodiscard]] std::span<const std::array<std::uint32_t, 3>> triangles() const;
  [[nodiscard]] std::span<const double> lo() const { return lo_; }
  [[nodiscard]] std::span<const double> hi() const { return hi_; }
  [[nodiscard]] std::span<const std::uint8_t> statuses() const { return statuses_; }

 private:
  /// The number of results of a complete map; for a stream of points: the number so far.
  [[nodiscard]] std::size_t complete_size() const;

  const Mesh* mesh_;
  MapElements elements_;
  std::vector<Point> points_;  // empty where there is a mesh
  std::vector<double> lo_;
  std::vector<double> hi_;
  std::vector<std::uint8_t> statuses_;
};

// Numbers as the shortest text that gives back the same binary64.

/// Room for the longest: "-2.2250738585072014e-308".
inline constexpr std::size_t most_shortest_digits = 24;

/// Writes the number from `at` on, or "inf", "-inf", "nan"; returns the end of it. Precondition: room for
/// `most_shortest_digits`.
[[nodiscard]] char* put_shortest_digits(double number, char* at);

}  // namespace verisq
