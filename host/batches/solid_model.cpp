/// This file implements the upload of models with bends or set operations.
#include "host/batches/solid_model.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/batches/box_primitive_parameters.hpp"
#include "host/batches/model_memory.hpp"
#include "verify/sets/bounding_box.hpp"

namespace verisq::device {
namespace {

// Corners are centre + (odd multiple of 2^-41) half-widths: with a centre that is a multiple of 2^-8 of them, below 2^3
// half-widths, they have 3 + 41 bits.
constexpr double grid_of_centre = 0x1p-8;

}  // namespace

RootCube root_cube(const Model& model, int scale_exponent) {
  const verify::Box box = verify::bounding_box(model);
  RootCube root{};
  double extent = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double lower = std::ldexp(box.lower[i], scale_exponent);
    const double upper = std::ldexp(box.upper[i], scale_exponent);
    root.centre[i] = 0.5 * lower + 0.5 * upper;
    extent = std::max({extent, upper - root.centre[i], root.centre[i] - lower});
  }
  // A fortieth of the half-width makes up for the rounding here and for that of the centre to the grid.
  int exponent = std::ilogb(1.025 * extent) + 1;
  // Far from the origin the grid must not be finer than the numbers there.
  for (const double c : root.centre)
    if (c != 0.0) exponent = std::max(exponent, std::ilogb(c) - 3);
  root.half_width = std::ldexp(1.0, exponent);
  const double grid = root.half_width * grid_of_centre;
  for (double& c : root.centre) c = std::round(c / grid) * grid;
  return root;
}

cl::Buffer uploaded_box_primitives(const Device& device, const Model& model, int scale_exponent) {
  std::vector<BoxPrimitiveParameters> parameters;
  for (const Primitive& primitive : model.primitives)
    parameters.push_back(box_primitive_parameters(primitive, scale_exponent));
  return {device.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, parameters.size() * sizeof(BoxPrimitiveParameters),
          parameters.data()};
}

std::string box_primitives_memory(const Device& device, const Model& model) {
  return model_memory_option(device, model.primitives.size() * sizeof(BoxPrimitiveParameters));
}

}  // namespace verisq::device
