/// What `map` and `check` both begin with: a model, and points from the vertices of a mesh or the lines of a file.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/point_file.hpp>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

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

  /// Fills `points` from the front; returns how many, fewer than asked only at the end. Throws Error(input).
  std::size_t read(std::span<Point> points);

  /// Goes on at this point, counted from 0.
  void go_to(std::uint64_t point);

  /// The part of all points that `done` finished ones make up, about; 0 when unknown.
  [[nodiscard]] double fraction(std::uint64_t done) const;

  /// How many points there are in all; nothing where that is not known before the last.
  [[nodiscard]] std::optional<std::uint64_t> count() const;

  /// Null for a file of points.
  [[nodiscard]] const Mesh* mesh() const { return file_ ? nullptr : &mesh_; }

 private:
  [[nodiscard]] std::size_t copy_vertices(std::span<Point> points) const;

  Mesh mesh_;
  std::optional<PointFile> file_;  ///< instead of the mesh
  std::size_t points_read_ = 0;
};

}  // namespace verisq::command_line
