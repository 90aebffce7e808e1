/// The map formats: one class and one source file each.
#pragma once

#include <memory>
#include <span>
#include <verisq/certificate.hpp>
#include <verisq/map_file.hpp>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>

#include "host/files/output_file.hpp"

namespace verisq {

/// Writes one map to the output file it was made with. Throws Error(failure).
class MapFormat {
 public:
  MapFormat() = default;
  MapFormat(const MapFormat&) = delete;
  MapFormat& operator=(const MapFormat&) = delete;
  virtual ~MapFormat() = default;

  /// Precondition: as for `MapWriter::append`.
  virtual void append(std::span<const Point> points, std::span<const MapResult> results,
                      std::span<const Certificate> certificates) = 0;
  virtual void finish() = 0;  ///< writes what is left; the file itself stays to be finished
  /// Whether the file is a valid map of its own after any number of rows.
  [[nodiscard]] virtual bool valid_after_any_row() const { return false; }
};

// `output` and `mesh` must outlive the format. `mesh` may be null: then the appended points are the vertices.
// JSON and PLY have no place for certificates.
[[nodiscard]] std::unique_ptr<MapFormat> make_csv_map(OutputFile& output, const Mesh* mesh, MapContents contents);
[[nodiscard]] std::unique_ptr<MapFormat> make_json_map(OutputFile& output, const Mesh* mesh, MapContents contents);
[[nodiscard]] std::unique_ptr<MapFormat> make_vtp_map(OutputFile& output, const Mesh* mesh, MapContents contents);
[[nodiscard]] std::unique_ptr<MapFormat> make_ply_map(OutputFile& output, const Mesh* mesh, MapContents contents);

}  // namespace verisq
