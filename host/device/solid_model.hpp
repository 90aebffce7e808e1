/// A model with bends or set operations on a device: its tree as OpenCL C, its terms, gradients of its distances.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/cube.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

// A model's tree of set operations as straight-line OpenCL C (docs/mathematics.md §11).

/// Leaves that a tree of set operations may have for a program of its own. Its compilation takes seconds at this number
/// and grows with it; compilers nest no more than some 250 operands; and kernels remember what is decided of the first
/// 32 primitives alone, so that from about here the host, which simplifies the whole tree, is faster on a processor
/// (120 balls with holes, 2000 points: 8.3 s on the device, 3.8 s on the host).
inline constexpr std::size_t most_compiled_leaves = 100;

/// Why the model has no program of its own; empty where it has one.
[[nodiscard]] std::string why_not_compiled(const Model& model);

/// The text of a program for one model: PRIMITIVES (their number), its terms (`ModelTerms`), the layers, the kernels
/// that are its entry points, and the functions `solid_colour` and `solid_node` that kernels/set_tree.clh declares.
/// Numbers of the model do not enter, only its structure: models that differ by numbers alone share a program.
/// Precondition: the model may be compiled.
[[nodiscard]] std::string model_source(const Model& model, std::string_view entry_points);

/// That with all kernels that signed distances of points take.
[[nodiscard]] std::string solid_source(const Model& model);

// The terms of a model's solid and of the closure of its complement, as kernels/set_bounds.cl takes them.

/// None of a target that has more than `most_terms`: it is left to the search.
struct ModelTerms {
  std::vector<verify::SetTerm> of_solid;
  std::vector<verify::SetTerm> of_complement;
};

inline constexpr std::size_t most_terms = 32;

[[nodiscard]] ModelTerms model_terms(const Model& model);

/// Returns whether set_bounds may ask for balls in the primitive: if it is cut away from others.
[[nodiscard]] bool holds_balls(const ModelTerms& terms, std::size_t primitive);

// A model with bends or set operations in the memory of a device, and the cube that its searches start from.

/// The model's root cube, which contains the solid in its interior, in units of 2^-scale_exponent model units. Centres
/// and corners of its octree are binary64 numbers down to 2^-40 of it. Precondition: within_device_range(model).
[[nodiscard]] verify::Cube root_cube(const Model& model, int scale_exponent);

/// BoxPrimitiveParameters of each primitive.
[[nodiscard]] cl::Buffer uploaded_box_primitives(const Device& device, const Model& model, int scale_exponent);

/// The option of programs that read them (`model_memory_option`).
[[nodiscard]] std::string box_primitives_memory(const Device& device, const Model& model);

/// Children of a cube are the lanes of a vector: vectors of eight, or scalars.
[[nodiscard]] inline int solid_vector_width(const Device& device) {
  return device.vector_width > 1 ? 8 : 1;
}

// About the gradients of signed distances to a model with bends or set operations, from intermediate results of
// kernels: they prove nothing.

/// For a point whose nearest surface point is on the boundary of one primitive: that primitive's normal. If the nearest
/// point is on an edge of two primitives: the vector from it to the point.
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

  /// The direction for point `n`, from its place and distance in the device's numbers; zero if no evidence fits.
  /// Precondition: read and finished.
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
