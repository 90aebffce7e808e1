/// About the gradients of signed distances to a model with bends or set operations, from what kernels found on their
/// way: they prove nothing.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "host/batches/chunk_queue.hpp"
#include "host/batches/convex_distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// Of a point whose nearest one is on the boundary of one primitive, that primitive's normal; where it is on an edge of
/// two, the way from there.
class SolidDirections {
 public:
  SolidDirections(const Model& model, int scale_exponent, std::size_t capacity);

  /// Edges and their feet (kernels/set_bounds.cl).
  struct Edges {
    cl::Buffer names;
    std::array<cl::Buffer, 3> feet;
  };

  /// Enqueues the reading of the first `size` points' evidence, primitive by primitive, and of their edges.
  void read(ChunkQueue& queue, std::span<const EvidenceBuffers> primitives, const Edges& edges, std::size_t size);

  /// Of point `n`, its place and distance in the device's numbers; zero where nothing fits. Precondition: read and
  /// finished.
  [[nodiscard]] Point operator()(std::size_t n, const Point& at, const Enclosure& distance) const;

 private:
  using Rotation = std::array<double, 9>;  // to the axes that normals come in, row by row

  static constexpr std::size_t columns_of_primitive = 5;

  [[nodiscard]] std::span<double> column(std::size_t primitive, std::size_t index);
  [[nodiscard]] double number(std::size_t primitive, std::size_t index, std::size_t n) const;

  std::vector<Rotation> frames_;
  std::size_t capacity_;
  std::vector<double> evidence_;
  std::array<std::vector<double>, 4> edges_;  // names, feet
};

}  // namespace verisq::device
