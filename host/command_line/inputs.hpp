/// The inputs of commands: models in their place, clouds, streams of points, triangles and poses. None of them is
/// overwritten.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

// Output files must not be input files.

/// Throws Error(input) if `output`, the value of `option`, is one of the files `inputs`; empty names stand for no file.
void refuse_to_overwrite(std::string_view option, const std::string& output, const std::vector<std::string>& inputs);

/// Throws Error(input) if two of these outputs would be one file, by links, too; empty names stand for no file.
void refuse_one_file_twice(const std::vector<std::string>& outputs);

// The option --pose: a model file is read, and the model moved before all computations.

/// Adds --pose.
void add_pose(Options& options, std::optional<Pose>& pose);

/// The model, moved (`posed` of verisq/distance.hpp) if there is a pose. Throws Error(input).
[[nodiscard]] Model moved_by(const std::optional<Pose>& pose, const Model& model, const std::string& file);

/// The file's model, moved by the pose.
[[nodiscard]] Model read_model_at(const std::optional<Pose>& pose, const std::string& file);

/// The same. Throws Error(input) also if the pose would move a translation that is an interval.
[[nodiscard]] UncertainModel read_uncertain_model_at(const std::optional<Pose>& pose, const std::string& file);

// The options for the accuracy of a model's place.

/// As typed.
struct PoseUncertaintyArguments {
  std::optional<std::array<double, 3>> translation = {};
  std::optional<double> rotation = {};  ///< in radians, rounded up
  std::optional<Point> centre = {};     ///< in the model's own coordinates
};

/// Adds --translation-error, --rotation-error and --rotation-centre of `whose` place.
void add_pose_uncertainty(Options& options, PoseUncertaintyArguments& arguments, const std::string& whose);

/// Nothing if neither error is given. The centre is in the model's own coordinates. Throws Error(input) for a centre
/// without an error of rotation.
[[nodiscard]] std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments);

/// The same with the centre moved by the pose, rounded to nearest.
[[nodiscard]] std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments,
                                                              const std::optional<Pose>& pose);

/// "its place known to 0.5, 0.5, 0.5 mm along the axes and 0.5 degrees about (0, 0, 40)".
[[nodiscard]] std::string described(const PoseUncertainty& bounds, const std::string& units);

// The progress through a streamed file.

/// About the share of all items of `file` that `done` finished ones of the `read` ones are. The number of items is
/// unknown until the end, and reading runs ahead of `done` by a few chunks. 0 when unknown. `File` is PointFile or
/// PoseFile.
template <class File>
[[nodiscard]] double file_fraction(const File& file, std::uint64_t read, std::uint64_t done) {
  const auto bytes = static_cast<double>(file.bytes_total());  // 0 for a pipe
  if (read == 0 || bytes == 0.0) return 0.0;
  return static_cast<double>(file.bytes_read()) / bytes * (static_cast<double>(done) / static_cast<double>(read));
}

// The common inputs of `map` and `check`: a model, and points from the vertices of a mesh or the lines of a file.

/// Names of files, as typed.
struct InputArguments {
  std::string model;
  std::string mesh;               ///< empty when `points` is given
  std::string points;             ///< empty when `mesh` is given
  std::optional<Pose> pose = {};  ///< moves the model
};

/// Adds --model, --pose, --mesh and --points.
void declare_inputs(Options& options, InputArguments& inputs);

/// All but --model.
void declare_points(Options& options, InputArguments& inputs);

/// Throws Error(input) unless `inputs` has either a mesh or points.
void check_usage(const InputArguments& inputs);

/// The points in order, a chunk at a time.
class PointStream {
 public:
  using Element = Point;

  /// Reads the mesh or opens the file of points. Throws Error(input). Precondition: `check_usage` passed.
  explicit PointStream(const InputArguments& inputs);

  /// Fills `points` from the front; returns the number of points, less than requested only at the end. Throws
  /// Error(input).
  std::size_t read(std::span<Point> points);

  /// Continues at this point, counted from 0.
  void go_to(std::uint64_t point);

  /// The part of all points that `done` finished ones make up, about; 0 when unknown.
  [[nodiscard]] double fraction(std::uint64_t done) const;

  /// The number of all points; nothing if it is not known before the last.
  [[nodiscard]] std::optional<std::uint64_t> count() const;

  /// Null for a file of points.
  [[nodiscard]] const Mesh* mesh() const { return file_ ? nullptr : &mesh_; }

 private:
  [[nodiscard]] std::size_t copy_vertices(std::span<Point> points) const;

  Mesh mesh_;
  std::optional<PointFile> file_;  ///< instead of the mesh
  std::size_t points_read_ = 0;
};

// The triangles of a mesh, a chunk at a time: the elements of `map --on triangles` and its `check`.

/// Has the functions of PointStream.
class TriangleStream {
 public:
  using Element = Triangle;

  /// Reads the mesh. Throws Error(input), also for a mesh without triangles. Precondition: `inputs` names a mesh.
  explicit TriangleStream(const InputArguments& inputs);

  /// Precondition: a mesh with triangles.
  explicit TriangleStream(Mesh mesh) : mesh_(std::move(mesh)) {}

  /// Fills `triangles` from the front; returns the number of triangles, less than requested only at the end.
  std::size_t read(std::span<Triangle> triangles);

  /// Continues at this triangle, counted from 0.
  void go_to(std::uint64_t triangle);

  /// The part of all triangles that `done` finished ones make up.
  [[nodiscard]] double fraction(std::uint64_t done) const;

  [[nodiscard]] std::optional<std::uint64_t> count() const { return mesh_.triangles.size(); }

  [[nodiscard]] const Mesh* mesh() const { return &mesh_; }

 private:
  Mesh mesh_;
  std::size_t triangles_read_ = 0;
};

// The poses of a file, a chunk at a time: the elements of `distance --poses`.

/// Has the functions of PointStream.
class PoseStream {
 public:
  using Element = Pose;

  explicit PoseStream(const std::string& path) : file_(path) {}

  std::size_t read(std::span<Pose> poses) {
    const std::size_t count = file_.read(poses);
    poses_read_ += count;
    return count;
  }

  void go_to(std::uint64_t pose) {
    file_.go_to(pose);
    poses_read_ = pose;
  }

  /// The number is not known before the last pose.
  [[nodiscard]] static std::optional<std::uint64_t> count() { return std::nullopt; }

  [[nodiscard]] double fraction(std::uint64_t done) const { return file_fraction(file_, poses_read_, done); }

 private:
  PoseFile file_;
  std::uint64_t poses_read_ = 0;
};

// A stream whose first elements are read before a device is chosen: a map of few rows is not worth a device's start.

/// Has the functions of `Stream` (see PointStream), which must outlive this.
template <class Stream>
class PeekedStream {
 public:
  using Element = typename Stream::Element;

  /// Reads one element more than are few. Throws as `Stream`.
  explicit PeekedStream(Stream& stream) : stream_(stream), peeked_(few_rows + 1) {
    peeked_.resize(stream_.read(peeked_));
  }

  [[nodiscard]] bool has_few() const { return peeked_.size() <= few_rows; }

  /// Fills `elements` from the front; returns the number of elements, less than requested only at the end. Throws like
  /// `Stream`.
  std::size_t read(std::span<Element> elements) {
    const std::size_t count = std::min(elements.size(), peeked_.size() - delivered_);
    std::copy_n(peeked_.begin() + static_cast<std::ptrdiff_t>(delivered_), count, elements.begin());
    delivered_ += count;
    return has_few() ? count : count + stream_.read(elements.subspan(count));
  }

  [[nodiscard]] double fraction(std::uint64_t done) const { return stream_.fraction(done); }

 private:
  Stream& stream_;
  std::vector<Element> peeked_;
  std::size_t delivered_ = 0;
};

/// The device that `--device` stands for: "auto" leaves few rows to the host.
template <class Stream>
[[nodiscard]] std::string device_for(const PeekedStream<Stream>& stream, const std::string& requested) {
  return requested == "auto" && stream.has_few() ? "host" : requested;
}

}  // namespace verisq::command_line
