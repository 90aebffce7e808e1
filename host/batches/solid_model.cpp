/// This file implements the upload of models with bends or set operations.
#include "host/batches/solid_model.hpp"

#include <cmath>
#include <vector>

#include "host/batches/box_primitive_parameters.hpp"
#include "host/batches/model_memory.hpp"
#include "verify/sets/bounding_box.hpp"
#include "verify/sets/cube_division.hpp"

namespace verisq::device {
namespace {

// Room about the solid for points that are proven to lie outside; it makes up for the scaling's rounding, too.
constexpr double margin = 1.0 / 64.0;
constexpr double farthest = 16.0;

}  // namespace

verify::Cube root_cube(const Model& model, int scale_exponent) {
  verify::Box box = verify::bounding_box(model);
  for (std::size_t i = 0; i < 3; ++i) {
    box.lower[i] = std::ldexp(box.lower[i], scale_exponent);
    box.upper[i] = std::ldexp(box.upper[i], scale_exponent);
  }
  return verify::root_cube(box, {.margin = margin, .farthest = farthest}).value();
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
