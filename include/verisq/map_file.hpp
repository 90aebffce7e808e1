/// Writes a finished map by the extension of the file: `.csv`, `.vtp`, `.ply`, `.json`.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

/// Rows arrive in order through `append`; `.csv` and `.json` stream them to the disk, the mesh formats (`.vtp`, `.ply`)
/// keep them until `finish`. Everything goes to a temporary file beside the target, which `finish` renames: an
/// interrupted run leaves no half-written map under the target's name. Without `finish` the destructor removes the
/// temporary file.
class MapWriter {
 public:
  /// `mesh` supplies vertices and triangles to the mesh formats; it must outlive the writer. Null for a stream of
  /// points: then `append`'s points become vertices.
  /// Throws Error(input) for an unknown extension, Error(failure) when the file cannot be written.
  MapWriter(const std::filesystem::path& path, const Mesh* mesh);
  ~MapWriter();
  MapWriter(MapWriter&&) noexcept;
  MapWriter& operator=(MapWriter&&) noexcept;

  /// Precondition: both spans of the same length; indices continue from the last call.
  void append(std::span<const Point> points, std::span<const MapResult> results);
  /// Throws Error(failure) when the file cannot be written, or when a mesh format has not one row for each vertex.
  void finish();
  /// Ends an interrupted map instead of `finish`: `.csv` keeps the rows appended so far under the target's name with
  /// `.partial` added and returns that path; the other formats keep nothing and return an empty path.
  [[nodiscard]] std::filesystem::path keep_partial();

 private:
  class Format;
  std::unique_ptr<Format> format_;
};

}  // namespace verisq
