/// A model with bends or set operations in the memory of a device, and the cube that its searches start from.
#pragma once

#include <string>

#include "host/device/device.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// A cube that contains the solid in its interior. Its half-width is a power of two and its centre lies on a grid so
/// coarse that all centres and corners of its octree are binary64 numbers down to 2^-40 of it.
struct RootCube {
  Point centre;
  double half_width;
};

/// In units of 2^-scale_exponent model units. Precondition: within_device_range(model).
[[nodiscard]] RootCube root_cube(const Model& model, int scale_exponent);

/// BoxPrimitiveParameters of each primitive.
[[nodiscard]] cl::Buffer uploaded_box_primitives(const Device& device, const Model& model, int scale_exponent);

/// The option of programs that read them (model_memory.hpp).
[[nodiscard]] std::string box_primitives_memory(const Device& device, const Model& model);

/// Children of a cube are the lanes of a vector: vectors of eight, or scalars.
[[nodiscard]] inline int solid_vector_width(const Device& device) {
  return device.vector_width > 1 ? 8 : 1;
}

}  // namespace verisq::device
