/// A model with bends or set operations in the memory of a device, and the cube that its searches start from.
#pragma once

#include <string>

#include "host/device/device.hpp"
#include "verify/sets/cube.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// The model's root cube, which holds the solid in its interior, in units of 2^-scale_exponent model units; centres and
/// corners of its octree are binary64 numbers down to 2^-40 of it. Precondition: within_device_range(model).
[[nodiscard]] verify::Cube root_cube(const Model& model, int scale_exponent);

/// BoxPrimitiveParameters of each primitive.
[[nodiscard]] cl::Buffer uploaded_box_primitives(const Device& device, const Model& model, int scale_exponent);

/// The option of programs that read them (model_memory.hpp).
[[nodiscard]] std::string box_primitives_memory(const Device& device, const Model& model);

/// Children of a cube are the lanes of a vector: vectors of eight, or scalars.
[[nodiscard]] inline int solid_vector_width(const Device& device) {
  return device.vector_width > 1 ? 8 : 1;
}

}  // namespace verisq::device
