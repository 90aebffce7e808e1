/// A map kept in memory until all of it is known: what the mesh formats write at the end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>

#include "host/files/map_format.hpp"
#include "host/files/output_file.hpp"

namespace verisq {

class CollectedMap {
 public:
  explicit CollectedMap(const MapKind& kind);

  void append(std::span<const Point> points, std::span<const MapResult> results);

  /// Throws Error(failure) naming `output`'s file unless there is exactly one result for each vertex or triangle: a
  /// mesh whose map was ended early has no place for what is unknown.
  void check_complete(const OutputFile& output) const;

  [[nodiscard]] MapElements elements() const { return elements_; }
  [[nodiscard]] std::span<const Point> vertices() const;
  [[nodiscard]] std::span<const std::array<std::uint32_t, 3>> triangles() const;
  [[nodiscard]] std::span<const double> lo() const { return lo_; }
  [[nodiscard]] std::span<const double> hi() const { return hi_; }
  [[nodiscard]] std::span<const std::uint8_t> statuses() const { return statuses_; }

 private:
  /// How many results the map has when it is complete; of a stream of points: so far.
  [[nodiscard]] std::size_t complete_size() const;

  const Mesh* mesh_;
  MapElements elements_;
  std::vector<Point> points_;  // empty where there is a mesh
  std::vector<double> lo_;
  std::vector<double> hi_;
  std::vector<std::uint8_t> statuses_;
};

}  // namespace verisq
