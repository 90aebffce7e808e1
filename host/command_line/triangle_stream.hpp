/// The triangles of a mesh, a chunk at a time: what `map --on triangles` encloses and `check` proves again.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <verisq/mesh.hpp>

#include "host/command_line/point_stream.hpp"

namespace verisq::command_line {

/// As PointStream.
class TriangleStream {
 public:
  using Element = Triangle;

  /// Reads the mesh. Throws Error(input), also for a mesh without triangles. Precondition: `inputs` names a mesh.
  explicit TriangleStream(const InputArguments& inputs);

  /// Precondition: a mesh with triangles.
  explicit TriangleStream(Mesh mesh) : mesh_(std::move(mesh)) {}

  /// Fills `triangles` from the front; returns how many, fewer than asked only at the end.
  std::size_t read(std::span<Triangle> triangles);

  /// Goes on at this triangle, counted from 0.
  void go_to(std::uint64_t triangle);

  /// The part of all triangles that `done` finished ones make up.
  [[nodiscard]] double fraction(std::uint64_t done) const;

  [[nodiscard]] std::optional<std::uint64_t> count() const { return mesh_.triangles.size(); }

  [[nodiscard]] const Mesh* mesh() const { return &mesh_; }

 private:
  Mesh mesh_;
  std::size_t triangles_read_ = 0;
};

}  // namespace verisq::command_line
