/// This file implements device_model.hpp.
#include "host/device/device_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/primitive_parameters.hpp"
#include "host/device/program_self_test.hpp"
#include "kernels/embedded_sources.hpp"
#include "verify/search/certified_distance.hpp"

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

// For a graphics processor: as much as its memory takes with ease.
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
  if (has_mesh(model)) return "the device's kernels know superquadrics alone: the host does all";
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

namespace {

constexpr std::size_t scratch_per_point = 12;  // SCRATCH_SIZE in kernels/interior_depth.cl

// Lanes of a processor's work-item share a block of points where only some need work, so that none idles; a graphics
// processor's work-item owns one point.
constexpr std::size_t block_points_of_vector_work_item = rows_side_by_side;

// The branch and bound's limit: below this width, relative to the largest semi-axis, it would take ever more cells.
constexpr double smallest_interior_tolerance = 0x1p-30;

}  // namespace

std::vector<EvidenceBuffers> views_of_primitives(const EvidenceBuffers& all, std::size_t count, std::size_t capacity) {
  std::vector<EvidenceBuffers> views(count);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::vector<cl::Buffer> columns = windows(all[i], count, capacity);
    for (std::size_t index = 0; index < count; ++index) views[index][i] = columns[index];
  }
  return views;
}

PointPrograms point_programs(const Device& device, const std::string& memory, bool tapered) {
  const auto program = [&](std::string_view sources) {
    return build_program(device.context, device.device, device.vector_width, sources, memory);
  };
  PointPrograms programs(program(kernels::embedded_point_sources()));
  require_sound(device, programs.untapered, "kernels of points",
                [&] { return first_fault_in_steps(device, programs); });
  if (!tapered) return programs;
  programs.tapered = program(kernels::embedded_tapered_sources());
  require_sound(device, *programs.tapered, "kernels of points about tapered solids",
                [&] { return first_fault_in_steps(device, programs); });
  return programs;
}

ConvexDistance::ConvexDistance(const Device& device, const PointPrograms& programs, ChunkQueue& queue,
                               std::size_t capacity, double tolerance)
    : capacity_(capacity),
      groups_per_block_(device.vector_width > 1 ? block_points_of_vector_work_item / device.vector_width : 1),
      listed_(queue.numbers(capacity / 2 + 1)),  // as 32-bit numbers
      untapered_(kernels_of(programs.untapered, kernels::embedded_point_sources(), tolerance)) {
  if (programs.tapered) tapered_ = kernels_of(*programs.tapered, kernels::embedded_tapered_sources(), tolerance);
}

ConvexDistance::Kernels ConvexDistance::kernels_of(const cl::Program& program, std::string_view sources,
                                                   double tolerance) const {
  Kernels kernels{{program, sources, "point_distance"}, {program, sources, "interior_depth"}};
  for (NamedKernel* const kernel : {&kernels.distance, &kernels.depth})
    kernel->set("groups_per_block", groups_per_block_);
  kernels.distance.set("listed", listed_);
  kernels.depth.set("tolerance", std::max(tolerance, smallest_interior_tolerance));
  return kernels;
}

void ConvexDistance::enqueue_distances(ChunkQueue& queue, const Points& points, const Primitive& primitive,
                                       std::size_t groups, const EvidenceBuffers& evidence) {
  points_ = points;
  of(primitive).distance.set("nearest", points_.nearest);
  enqueue(queue, of(primitive).distance, points, primitive, groups, evidence);
}

void ConvexDistance::enqueue_depths(ChunkQueue& queue, const Points& points, const Primitive& primitive,
                                    std::size_t groups, const EvidenceBuffers& evidence) {
  if (scratch_() == nullptr) scratch_ = queue.numbers(capacity_ * scratch_per_point);
  of(primitive).depth.set("scratch", scratch_);
  enqueue(queue, of(primitive).depth, points, primitive, groups, evidence);
}

void ConvexDistance::enqueue(ChunkQueue& queue, NamedKernel& kernel, const Points& points, const Primitive& primitive,
                             std::size_t groups, const EvidenceBuffers& evidence) {
  points_ = points;
  primitives_ = primitive.primitives;
  kernel.set("groups", groups);
  kernel.set(coordinate_arguments, points_.coordinates);
  kernel.set("primitives", primitives_);
  kernel.set("index", primitive.index);
  kernel.set(evidence_arguments, evidence);
  // A vector work-item with a block is long: one a work-group lets the cores share them evenly.
  const std::size_t blocks = (groups + groups_per_block_ - 1) / groups_per_block_;
  groups_per_block_ > 1 ? queue.launch(kernel, blocks, 1) : queue.launch(kernel, blocks);
}

}  // namespace verisq::device
