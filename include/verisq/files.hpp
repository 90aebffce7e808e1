/// Readers and writers of models, meshes, points, poses and labelled volumes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/hidden.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Reads and writes the model format `verisq-model/1` (JSON), docs/formats.md §2.

/// Throws Error(input) with one line naming file, key and value for everything the format refuses: syntax
/// errors, unknown keys, non-finite numbers, exponents outside (0, 2], non-positive semi-axes, a zero quaternion, a
/// bend whose curvature is not proven to be small enough (see Bend), duplicate or unknown names, an operator without
/// operands or a difference of one; and for intervals, which an exact model does not have. The keys `areas`
/// (`read_areas`) and `landmarks` (`read_model_landmarks`) are checked likewise and not part of the model. A file that
/// `read_mesh` reads is the model of that one mesh, which must be closed; meshes that a model names are read, too, by
/// names relative to its folder.
[[nodiscard]] Model read_model(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Model parse_model(std::string_view json, std::string_view name);

/// The same with intervals [lo, hi] for semi-axes, exponents and elements of translations; what holds for a number must
/// hold at both ends. Refuses them in models that are not is_union_of_convex.
[[nodiscard]] UncertainModel read_uncertain_model(const std::filesystem::path& path);
[[nodiscard]] UncertainModel parse_uncertain_model(std::string_view json, std::string_view name);

/// Writes the file so that `read_model` gives the same bits; it appears under its name when it is complete. Throws
/// Error(failure) when it cannot be written. Precondition: a model that `read_model` accepts; names in UTF-8.
void write_model(const std::filesystem::path& path, const Model& model);
/// With named points (key `landmarks`), which `read_model_landmarks` gives, bit for bit. A head's radius is none.
void write_model(const std::filesystem::path& path, const Model& model, const FemurLandmarks& landmarks);

// Reads and writes meshes: STL (binary, ASCII), OBJ, PLY (ASCII, binary of both byte orders), OFF. Reads those of VTK,
// too: PolyData in XML (`.vtp`) and in the legacy form (`.vtk`).

/// The format follows the extension (any case). Coordinates: text to the nearest binary64, binary floats exactly.
/// Equal STL corners are merged; polygons of other formats are split into triangles.
/// Throws Error(input) naming file and line or byte position for: NaN, infinity, empty or truncated files, indices
/// out of range, unknown formats, and a triangle that names a vertex twice whose line is no side of another triangle:
/// such sides are left out.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

/// The same of the bytes of the file of that name.
[[nodiscard]] Mesh parse_mesh(std::string_view bytes, const std::filesystem::path& name);

/// Whether `read_mesh` knows the format of that name.
[[nodiscard]] bool is_mesh_name(const std::filesystem::path& path);

/// Throws Error(input) unless `write_mesh` knows the format of that name.
void check_mesh_name(const std::filesystem::path& path);

/// Writes what `read_mesh` reads: PLY (binary little-endian, binary64), OFF and OBJ (text) give the same mesh again;
/// STL (binary) rounds coordinates to binary32 and forgets vertices of no triangle. The file appears when it is
/// complete. Throws Error(input) for an unknown format, coordinates that are not finite (in STL: after rounding),
/// triangles that name a vertex twice and (in STL) those whose area rounding takes, Error(failure) when the file cannot
/// be written. Precondition: indices in range.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

// Streams points from text (`.csv`) or a NumPy array (`.npy`), a chunk at a time, so that memory does not grow with
// the file.

/// Text has a point a line, `x,y,z`, separated by commas or by blanks; the first line tells. It may be a header: then
/// the coordinates are the columns named x, y and z, else the first three; other columns are passed over. An array,
/// which is known by its first bytes whatever its name, is one of shape (N, 3), float64 or float32. Throws Error(input)
/// naming file, line or byte and value for anything else, for coordinates that are not finite, and for a file without
/// points.
class PointFile {
 public:
  /// `-` is the standard input.
  explicit PointFile(const std::filesystem::path& path);

  /// Fills `points` from the front; returns how many, fewer than asked only at the end of the file.
  std::size_t read(std::span<Point> points);

  /// Goes on at this point, counted from 0; an array at once, of text by reading on, or again from the beginning.
  /// Behind the last point nothing is left to read. Throws as above, and Error(input) where that is before what a pipe
  /// has delivered.
  void go_to(std::uint64_t point);

  /// How many points there are in all, where the file says so at its beginning.
  [[nodiscard]] std::optional<std::uint64_t> count() const;

  [[nodiscard]] std::uint64_t bytes_read() const;   ///< about, for progress
  [[nodiscard]] std::uint64_t bytes_total() const;  ///< 0 when unknown (a pipe)

 private:
  struct State;
  Hidden<State> state_;
};

/// The points of such a file, or the vertices of a mesh: all of them, without triangles. Throws Error(input) likewise.
[[nodiscard]] Mesh read_cloud(const std::filesystem::path& path);

// Streams poses from a CSV file `tx,ty,tz,qw,qx,qy,qz`, a chunk at a time, so that memory does not grow with the file.

/// A line is a translation in model units and a quaternion of any length but zero. A header line is optional. Throws
/// Error(input) naming file, line and value for anything but seven finite numbers a line, for a zero quaternion, and
/// for a file without poses.
class PoseFile {
 public:
  explicit PoseFile(const std::filesystem::path& path);

  /// Fills `poses` from the front; returns how many, fewer than asked only at the end of the file.
  std::size_t read(std::span<Pose> poses);

  /// Goes on at this pose, counted from 0: by reading on, or again from the beginning. Behind the last one nothing is
  /// left to read.
  void go_to(std::uint64_t pose);

  [[nodiscard]] std::uint64_t bytes_read() const;  ///< for progress
  [[nodiscard]] std::uint64_t bytes_total() const;

 private:
  struct State;
  Hidden<State> state_;
};

/// All poses of a file, in its order. Throws as PoseFile.
[[nodiscard]] std::vector<Pose> read_poses(const std::filesystem::path& path);

// Segmented volume images: a label a voxel, and where the voxels lie.

/// Which way x and y of a patient's coordinates grow; z grows to the head in both.
enum class AnatomicalSpace {
  lps,      ///< to the patient's left and back: DICOM, and the meshes that 3D Slicer exports
  ras,      ///< to the right and the front: NIfTI, and what 3D Slicer shows
  unknown,  ///< the file does not say
};

/// Voxel (i, j, k) has its centre at origin + i steps[0] + j steps[1] + k steps[2], in mm where the file says what its
/// numbers are; its label is labels[i + counts[0] (j + counts[1] k)]. Counts are at least 1, steps are linearly
/// independent, every number is finite.
struct LabelVolume {
  std::array<std::size_t, 3> counts;
  Point origin;
  std::array<Point, 3> steps;
  AnatomicalSpace space = AnatomicalSpace::unknown;
  std::vector<std::uint16_t> labels;
};

/// By extension, any case: `.nrrd` (attached, raw or gzip; as 3D Slicer writes label maps and, where segments do not
/// overlap, segmentations), `.nii` and `.nii.gz` (NIfTI-1). Coordinates are in LPS, whatever the file is in, or as they
/// stand where the file does not say. Throws Error(input) for other files, for those that end early or late, for values
/// that are no integer from 0 to 65535, and for axes that span no volume; docs/formats.md, section 3.
[[nodiscard]] LabelVolume read_label_volume(const std::filesystem::path& path);

struct LabelCount {
  std::uint16_t label;
  std::uint64_t voxels;
};

/// The labels but 0, the background, in ascending order.
[[nodiscard]] std::vector<LabelCount> labels_of(const LabelVolume& volume);

/// The same volume in other coordinates. Precondition: neither space is unknown, unless they are the same.
[[nodiscard]] LabelVolume in_space(LabelVolume volume, AnatomicalSpace space);

/// The volume of one voxel, to nearest.
[[nodiscard]] double voxel_volume(const LabelVolume& volume);

}  // namespace verisq
