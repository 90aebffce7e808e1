/// Files of maps, of their parts, and the whole of these.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/hidden.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

// Writes a finished map by the extension of the file (`.csv`, `.npy`, `.vtp`, `.ply`, `.json`) and reads certified
// maps back.

enum class MapContents {
  enclosures,
  certified,  ///< with the certificate of each enclosure, but for witness and cover; `.csv` and `.vtp` only
  covered,    ///< of vertices: with all of the certificate; likewise
  /// For vertices, with the closest point of each: `.csv`, `.npy` and `.vtp` only. For poses, with the closest points
  /// of both models: `.csv` and `.npy` only.
  closest_points,
};

/// The elements for which a map has a row.
enum class MapElements {
  vertices,   ///< of a mesh, or points of a stream: `.vtp` has point data, `.ply` properties of the vertices
  triangles,  ///< of a mesh: `.vtp` has cell data, `.ply` properties of the faces
  poses,      ///< of a model: `.csv`, `.npy` and `.json` only, without certificates
};

/// The columns that `.csv` and `.npy` may have.
enum class MapColumn {
  index,
  x,
  y,
  z,
  lo,
  hi,
  mid,
  width,
  status,
  unique,        ///< this and those below: of maps with closest points
  closest_x_lo,  ///< up to `primitive`: of points
  closest_x_hi,
  closest_y_lo,
  closest_y_hi,
  closest_z_lo,
  closest_z_hi,
  normal_x_lo,
  normal_x_hi,
  normal_y_lo,
  normal_y_hi,
  normal_z_lo,
  normal_z_hi,
  primitive,
  on_a_x_lo,  ///< this and those below: of poses
  on_a_x_hi,
  on_a_y_lo,
  on_a_y_hi,
  on_a_z_lo,
  on_a_z_hi,
  on_b_x_lo,
  on_b_x_hi,
  on_b_y_lo,
  on_b_y_hi,
  on_b_z_lo,
  on_b_z_hi
};

/// Whether only a map with closest points has it.
[[nodiscard]] constexpr bool is_of_closest_point(MapColumn column) {
  return column >= MapColumn::unique;
}

/// Whether only a map of poses with closest points has it.
[[nodiscard]] constexpr bool is_of_closest_pair(MapColumn column) {
  return column >= MapColumn::on_a_x_lo;
}

/// The name in the first line of a `.csv`, and of the field in a `.npy`.
[[nodiscard]] constexpr std::string_view to_string(MapColumn column) {
  switch (column) {
    case MapColumn::index: return "index";
    case MapColumn::x: return "x";
    case MapColumn::y: return "y";
    case MapColumn::z: return "z";
    case MapColumn::lo: return "lo";
    case MapColumn::hi: return "hi";
    case MapColumn::mid: return "mid";
    case MapColumn::width: return "width";
    case MapColumn::unique: return "unique";
    case MapColumn::closest_x_lo: return "closest_x_lo";
    case MapColumn::closest_x_hi: return "closest_x_hi";
    case MapColumn::closest_y_lo: return "closest_y_lo";
    case MapColumn::closest_y_hi: return "closest_y_hi";
    case MapColumn::closest_z_lo: return "closest_z_lo";
    case MapColumn::closest_z_hi: return "closest_z_hi";
    case MapColumn::normal_x_lo: return "normal_x_lo";
    case MapColumn::normal_x_hi: return "normal_x_hi";
    case MapColumn::normal_y_lo: return "normal_y_lo";
    case MapColumn::normal_y_hi: return "normal_y_hi";
    case MapColumn::normal_z_lo: return "normal_z_lo";
    case MapColumn::normal_z_hi: return "normal_z_hi";
    case MapColumn::primitive: return "primitive";
    case MapColumn::on_a_x_lo: return "on_a_x_lo";
    case MapColumn::on_a_x_hi: return "on_a_x_hi";
    case MapColumn::on_a_y_lo: return "on_a_y_lo";
    case MapColumn::on_a_y_hi: return "on_a_y_hi";
    case MapColumn::on_a_z_lo: return "on_a_z_lo";
    case MapColumn::on_a_z_hi: return "on_a_z_hi";
    case MapColumn::on_b_x_lo: return "on_b_x_lo";
    case MapColumn::on_b_x_hi: return "on_b_x_hi";
    case MapColumn::on_b_y_lo: return "on_b_y_lo";
    case MapColumn::on_b_y_hi: return "on_b_y_hi";
    case MapColumn::on_b_z_lo: return "on_b_z_lo";
    case MapColumn::on_b_z_hi: return "on_b_z_hi";
    case MapColumn::status: break;
  }
  return "status";
}

/// The contents of a map and its form.
struct MapForm {
  MapContents contents = MapContents::enclosures;
  MapElements elements = MapElements::vertices;
  /// One of the extensions above, with its dot, for a path that has none; empty: that of the path.
  std::string format = {};
  /// The columns of a `.csv` or `.npy` without certificates, in this order. `mid` is the middle of an enclosure, or its
  /// finite end, `width` is rounded upward, `x`, `y`, `z` are of vertices only. `unique` is 1 or 0, `primitive` -1
  /// where it is not known. Empty: index, lo, hi, status, and those of closest points; of a `.npy` without index.
  std::vector<MapColumn> columns = {};
  /// The index of the first row: of a part of a map.
  std::uint64_t first_row = 0;
  /// How many rows there will be, where that is known: what a `.npy` says at its beginning. Only needed where the file
  /// cannot be rewritten there.
  std::optional<std::uint64_t> rows = {};
};

/// Rows arrive in order through `append`; `.csv`, `.npy`, `.json` and a `.vtp` of a mesh without certificates stream
/// them to the disk, other maps in mesh formats (`.vtp`, `.ply`) keep them until `finish`. Everything goes to a
/// temporary file beside the target (where `path` leads to through symbolic links), which `finish` renames: an
/// interrupted run leaves no half-written map under the target's name. Without `finish` the destructor removes the
/// temporary file. A killed run leaves it: TARGET.*.partial, a name of its own for each run; of a `.csv` or `.npy` it
/// has all rows that were appended. A `path` to something that is no regular file (a pipe, /dev/null) is written to
/// directly, and so is `-`, the standard output.
class MapWriter {
 public:
  /// `mesh` supplies vertices and triangles to the mesh formats; it must outlive the writer. Null for a stream of
  /// points: then `append`'s points become vertices. Precondition: a map of triangles has a mesh.
  /// Throws Error(input) for an unknown extension and for poses, certificates or closest points in a format that has no
  /// place for them,
  /// Error(failure) when the file cannot be written.
  MapWriter(const std::filesystem::path& path, const Mesh* mesh, MapContents contents = MapContents::enclosures,
            MapElements elements = MapElements::vertices);
  /// Likewise, in a form. Throws Error(input) also for columns that there are not, or in a format without columns, and
  /// for a `.npy` of unknown length that is written to directly.
  MapWriter(const std::filesystem::path& path, const Mesh* mesh, const MapForm& form);

  /// Precondition: spans of the same length; `certificates` empty unless the contents are certified or covered, and all
  /// their numbers finite; an escape in a map of vertices only, a witness and a cover, which must be whole, in a
  /// covered one only, weights in a map of triangles only. Indices continue from the last call.
  void append(std::span<const Point> points, std::span<const MapResult> results,
              std::span<const Certificate> certificates = {});
  /// The same where a mesh has the points, and for poses. Precondition: as above, and a mesh or poses.
  void append(std::span<const MapResult> results, std::span<const Certificate> certificates = {});
  /// The same of a map with closest points. Precondition: that are its contents; as many rows of each. `points` may be
  /// empty where a mesh has them.
  void append_closest(std::span<const Point> points, std::span<const MapResult> results,
                      std::span<const ClosestPoint> closest);
  /// The same of a map of poses with closest points.
  void append_closest(std::span<const MapResult> results, std::span<const ClosestPoints> closest);
  /// Throws Error(failure) when the file cannot be written, or when a mesh format has not one row for each element.
  void finish();
  /// Ends an interrupted map instead of `finish`: `.csv` and `.npy` keep the rows appended so far under the target's
  /// name with `.partial` added and return the name that has them; the other formats, and a `.npy` that is written to
  /// directly, keep nothing and return an empty path.
  [[nodiscard]] std::filesystem::path keep_partial();

 private:
  class Format;
  Hidden<Format> format_;
};

/// One row of a certified map.
struct CertifiedRow {
  MapResult result;
  Certificate certificate;
};

/// Something that a map shows and that is not what it should be, for a message.
struct MapDifference {
  std::string array;                   ///< "Points", "NumberOfPolys"
  std::optional<std::uint64_t> index;  ///< of the tuple; nothing for a count
  std::string shown;
  std::string expected;
};

/// Reads a certified map (`.csv`, `.vtp`; also what an ended run left of a `.csv`, under the names that `MapWriter`
/// gives it), in the order of its points or triangles. A `.csv` is streamed, a `.vtp` is kept in memory.
class MapReader {
 public:
  /// Throws Error(input) naming file, line or byte position and value: for other formats, for maps written without
  /// certificates, for anything that is not such a map. Error(failure) when the file or the memory fails.
  explicit MapReader(const std::filesystem::path& path);

  [[nodiscard]] MapElements elements() const;

  /// Whether the map is by its name what an ended run left: rows may be missing at its end. One that was being written
  /// when the run was killed is not read.
  [[nodiscard]] bool partial() const;

  /// Fills `rows` from the front; returns how many, fewer than asked only at the end of the map. Throws as above; ends
  /// are any binary64 numbers but NaN.
  std::size_t read(std::span<CertifiedRow> rows);

  /// Whether viewers draw a picture of the map: a `.vtp`.
  [[nodiscard]] bool draws() const;

  /// The first number, bit for bit, by which that picture differs from the one of `mesh` (points are a mesh without
  /// triangles) coloured by the map's rows: points, cells and `dist_mid`. Nothing where the map draws none.
  [[nodiscard]] std::optional<MapDifference> difference_from(const Mesh& mesh) const;

 private:
  class Format;
  Hidden<Format> format_;
};

// Parts of a map that several processes make, and the whole that they are merged to: bit by bit what one process
// writes.

/// Rows `first` ... `first + count - 1`.
struct RowRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;

  [[nodiscard]] bool operator==(const RowRange&) const = default;
};

/// The rows of part `part`, from 1 on, of `parts` of a map of `rows` rows: whole blocks of `rows_per_block`, but for
/// the last one's end, as evenly as that goes. Where there are more parts than blocks some are empty. Precondition: 1
/// <= part
/// <= parts.
[[nodiscard]] RowRange rows_of_part(std::uint64_t part, std::uint64_t parts, std::uint64_t rows);

/// Something that all parts of a map must have in common.
struct PartSetting {
  std::string name;
  std::string value;
};

/// The description that stands beside a part of a map: the whole that it belongs to, and its file.
struct MapPart {
  std::string version = {};  ///< of the library
  std::uint64_t part = 1;
  std::uint64_t parts = 1;
  RowRange rows = {};
  std::uint64_t rows_in_all = 0;
  SubjectFile map = {};                          ///< the part's own file
  std::vector<SubjectFile> models = {};          ///< of poses two
  SubjectFile input = {};                        ///< whose vertices, triangles, points or poses the rows are of
  MapElements elements = MapElements::vertices;  ///< which of them
  std::vector<PartSetting> settings = {};        ///< whatever else rows depend on, and their form
  MapSummary summary = {};                       ///< of its rows
  std::optional<ClosestPointSummary> closest = {};
};

/// The name of the file beside a part: that of the part with ".part.json" added.
[[nodiscard]] std::filesystem::path part_file_of(const std::filesystem::path& map);

/// The digest of a file of any size, read front to back in constant memory. Throws Error(input) as `subject_file`, and
/// for what is no regular file.
[[nodiscard]] SubjectFile digest_of_file(const std::filesystem::path& path);

/// Writes the file beside `map` (docs/formats.md §10). Throws Error(failure).
void write_map_part(const std::filesystem::path& map, const MapPart& part);

/// Reads the file beside `map`. Throws Error(input) naming file, key and value for what the format does not allow.
[[nodiscard]] MapPart read_map_part(const std::filesystem::path& map);

struct MergeOptions {
  bool mixed_devices = false;  ///< accept rows of several devices: valid, but not what one process writes
};

/// The result of `merge_maps`: what the parts have in common, and the summary of all rows. Seconds are added up.
struct MergedMap {
  MapPart whole;                     ///< part 1 of 1
  std::vector<std::string> devices;  ///< each once
};

/// Writes the whole map of these parts, given in any order, `.csv` or `.npy` as they are: in constant memory, and under
/// its name only when it is complete. Throws Error(input), one line, for parts that are missing or there twice, of
/// other models, inputs, settings, devices or versions, whose files are not those that were written, and for an output
/// that is a part. Throws Error(failure) when the output cannot be written.
MergedMap merge_maps(std::span<const std::filesystem::path> paths, const std::filesystem::path& output,
                     const MergeOptions& options = {});

}  // namespace verisq
