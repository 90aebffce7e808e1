/// This file implements the upload of a model.
#include "host/batches/device_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "host/batches/model_memory.hpp"
#include "host/batches/primitive_parameters.hpp"
#include "host/batches/rows_side_by_side.hpp"
#include "verify/search/has_taper.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t queries_per_chunk = 1U << 20U;  // of devices that want more work-items at a time than processors
constexpr std::size_t smallest_full_chunk = 1U << 16U;
constexpr std::size_t bytes_per_query = 2048;  // two chunks of points around eight primitives, rounded up
constexpr std::size_t part_of_memory = 8;
constexpr std::size_t primitives_per_full_chunk = 8;  // larger models take smaller chunks: memory stays bounded
constexpr std::size_t smallest_chunk = rows_side_by_side;
// Keeps windows of device buffers aligned for any device, and blocks whole.
constexpr std::size_t chunk_alignment = rows_side_by_side;
static_assert(rows_side_by_side % (1U << 10U) == 0);

constexpr int largest_scaled_exponent = 300;
constexpr double far_from_unit_model = 0x1p20;

// Of a graphics processor: as much as its memory takes with ease.
std::size_t full_chunk(const Device& device) {
  const std::size_t memory = device.device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>() / part_of_memory;
  return std::clamp(std::bit_floor(memory / bytes_per_query), smallest_full_chunk, queries_per_chunk);
}

std::size_t chunk_size(const Device& device, std::size_t primitives, std::size_t processor_chunk) {
  const std::size_t full = device.vector_width > 1 ? processor_chunk : full_chunk(device);
  const std::size_t wanted =
      std::max(smallest_chunk, full * primitives_per_full_chunk / std::max(primitives, primitives_per_full_chunk));
  return wanted - wanted % chunk_alignment;
}

cl::Buffer uploaded(const Device& device, const Model& model, int scale) {
  std::vector<PrimitiveParameters> parameters;
  for (const Primitive& primitive : model.primitives) parameters.push_back(primitive_parameters(primitive, scale));
  return {device.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, parameters.size() * sizeof(PrimitiveParameters),
          parameters.data()};
}

std::vector<bool> which_are_tapered(const Model& model) {
  std::vector<bool> result;
  for (const Primitive& primitive : model.primitives) result.push_back(is_tapered(primitive.superquadric));
  return result;
}

}  // namespace

std::string why_not_on_devices(const Model& model) {
  return within_device_range(model) ? std::string()
                                    : "the model's sizes span more than the device's kernels are made for";
}

std::string why_not_as_triangles_or_pairs(const Model& model) {
  return verify::has_taper(model) ? "the device's kernels know points about tapered solids alone: the host does all"
                                  : std::string();
}

bool within_device_range(const Model& model) {
  const int scale = scale_exponent(model);
  if (std::abs(scale) > 1000) return false;
  const auto in_range = [scale](double x, int lowest) {
    return x == 0.0 || (std::ilogb(x) + scale <= largest_scaled_exponent && std::ilogb(x) + scale >= lowest);
  };
  return std::all_of(model.primitives.begin(), model.primitives.end(), [&](const Primitive& primitive) {
    const auto& axes = primitive.superquadric.semi_axes;
    const auto& shift = primitive.pose.translation;
    const auto& exponents = primitive.superquadric.exponents;
    return std::all_of(axes.begin(), axes.end(), [&](double a) { return in_range(a, -largest_scaled_exponent); }) &&
           std::all_of(shift.begin(), shift.end(), [&](double t) { return in_range(t, -2000); }) &&
           std::all_of(exponents.begin(), exponents.end(), [](double e) { return e >= 0x1p-30; });
  });
}

Model joined(const Model& a, const Model& b) {
  Model both = a;
  both.primitives.insert(both.primitives.end(), b.primitives.begin(), b.primitives.end());
  return both;
}

DeviceModel::DeviceModel(const Device& device, const Model& model, std::size_t processor_chunk)
    : scale_exponent(device::scale_exponent(model)),
      primitives(uploaded(device, model, scale_exponent)),
      count(model.primitives.size()),
      tapered(which_are_tapered(model)),
      memory(model_memory_option(device, count * sizeof(PrimitiveParameters))),
      chunk_size(device::chunk_size(device, count, processor_chunk)) {}

double far_away(const DeviceModel& model) {
  return std::ldexp(far_from_unit_model, -model.scale_exponent);
}

}  // namespace verisq::device
