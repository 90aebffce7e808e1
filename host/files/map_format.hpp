/// The map formats: one class and one source file each.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>
#include <verisq/certificate.hpp>
#include <verisq/closest_point.hpp>
#include <verisq/map_file.hpp>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model_distance.hpp>

#include "host/files/output_file.hpp"

namespace verisq {

/// As the constructor of `MapWriter` states it.
struct MapKind {
  const Mesh* mesh;  ///< must outlive the format; may be null for vertices: then the appended points are the vertices
  MapContents contents;
  MapElements elements;
  std::vector<MapColumn> columns;     ///< of tables; empty: those that the format has by itself
  std::optional<std::uint64_t> rows;  ///< how many there will be; nothing where that is not known
  std::uint64_t first_row = 0;        ///< its index
};

[[nodiscard]] constexpr bool has_certificates(MapContents contents) {
  return contents == MapContents::certified || contents == MapContents::covered;
}

/// What `MapWriter` was given in one call.
struct MapChunk {
  std::span<const Point> points;  ///< may be left out where there is a mesh
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
  virtual void finish() = 0;  ///< writes what is left; the file itself stays to be finished
  /// Whether the file is a valid map of its own after any number of rows.
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

}  // namespace verisq
