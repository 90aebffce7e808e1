/// This file implements the streaming of points through the branch and bound of a device.
#include "host/batches/solid_batch.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_queue.hpp"
#include "host/batches/convex_distance.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/model_source.hpp"
#include "host/batches/primitive_parameters.hpp"
#include "host/batches/solid_model.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

// Cubes that are split for a query; then it is left to the host. The hardest that still pay take some hundreds.
constexpr cl_uint round_limit = 4096;

cl::Program solid_program(const Device& device, const Model& model) {
  return build_program(device.context, device.device, solid_vector_width(device),
                       model_source(model, kernels::embedded_solid_distance()), box_primitives_memory(device, model));
}

cl::Buffer uploaded_alone(const Device& device, const Primitive& primitive, int scale) {
  PrimitiveParameters parameters = primitive_parameters(primitive, scale);
  return {device.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof(parameters), &parameters};
}

struct Part {
  bool bent;
  cl::Buffer convex;  // PrimitiveParameters: a primitive on its own is the first of one, in constant memory
};

// What all slots share.
struct SolidModel {
  SolidModel(const Device& device, const Model& model)
      : size(device, model),
        program(solid_program(device, model)),
        box_primitives(uploaded_box_primitives(device, model, size.scale_exponent)),
        root(root_cube(model, size.scale_exponent)) {
    for (const Primitive& primitive : model.primitives)
      parts.push_back({is_bent(primitive), uploaded_alone(device, primitive, size.scale_exponent)});
  }

  DeviceModel size;
  cl::Program program;
  cl::Buffer box_primitives;
  RootCube root;
  std::vector<Part> parts;
};

// One chunk on its way through the device: enclosures for each convex primitive on its own, then the search.
class Slot {
 public:
  Slot(const Device& device, const SolidModel& model, double tolerance)
      : width_(device.vector_width),
        solid_width_(solid_vector_width(device)),
        capacity_(model.size.chunk_size),
        count_(model.size.count),
        scale_(model.size.scale_exponent),
        queue_(device),
        parts_(model.parts),
        box_primitives_(model.box_primitives),
        coordinates_{queue_.numbers(capacity_), queue_.numbers(capacity_), queue_.numbers(capacity_)},
        convex_distance_(device, device.program, queue_, coordinates_, capacity_, scale_.to_device(tolerance)),
        bent_distance_(model.program, "bent_distance"),
        solid_distance_(model.program, "solid_distance"),
        enclosures_(capacity_) {
    views_.resize(count_);
    for (std::size_t i = 0; i < per_primitive_.size(); ++i) {
      per_primitive_[i] = queue_.numbers(capacity_ * count_);
      const std::vector<cl::Buffer> columns = windows(per_primitive_[i], count_, capacity_);
      for (std::size_t index = 0; index < count_; ++index) views_[index][i] = columns[index];
    }
    for (cl::Buffer& end : result_) end = queue_.numbers(capacity_);
    bind_coordinates(bent_distance_, 1);
    bent_distance_.setArg(4, box_primitives_);
    bind_coordinates(solid_distance_, 2);
    solid_distance_.setArg(1, static_cast<cl_ulong>(capacity_));
    solid_distance_.setArg(5, box_primitives_);
    for (cl_uint i = 0; i < 3; ++i) solid_distance_.setArg(6 + i, model.root.centre[i]);
    solid_distance_.setArg(9, model.root.half_width);
    solid_distance_.setArg(10, std::max(scale_.to_device(tolerance), smallest_tolerance));
    solid_distance_.setArg(11, round_limit);
    for (cl_uint i = 0; i < 5; ++i) solid_distance_.setArg(12 + i, per_primitive_[i]);
    for (cl_uint i = 0; i < 2; ++i) solid_distance_.setArg(17 + i, result_[i]);
    for (auto& column : columns_) column.resize(capacity_);
  }

  void start(std::span<const Point> points) {
    size_ = points.size();
    const std::size_t groups = (size_ + width_ - 1) / width_;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t n = 0; n < size_; ++n) columns_[i][n] = scale_.to_device(points[n][i]);
      // Lanes beyond the last point repeat it.
      std::fill(columns_[i].begin() + size_, columns_[i].begin() + groups * width_, columns_[i][size_ - 1]);
      queue_.write(coordinates_[i], std::span(columns_[i]).first(groups * width_));
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].bent ? enqueue_bent(i) : enqueue_convex(i);
    solid_distance_.setArg(0, static_cast<cl_ulong>(size_));
    queue_.launch(solid_distance_, size_, width_ > 1 ? searches_per_group : usual_group_size);
    enclosures_.read(queue_, result_, size_);
    queue_.flush();
  }

  // Returns when kernels ran.
  std::vector<Running> finish(std::vector<Enclosure>& enclosures) {
    std::vector<Running> times = queue_.finish();
    enclosures_.deliver(scale_, enclosures);
    return times;
  }

  void certify(std::span<const Enclosure>, std::vector<Certificate>&) const {}  // searches have none

 private:
  static constexpr double smallest_tolerance = 0x1p-40;  // cubes are not split below
  static constexpr std::size_t searches_per_group = 16;  // long work-items: small groups keep cores busy

  void bind_coordinates(cl::Kernel& kernel, cl_uint first) const {
    for (cl_uint i = 0; i < 3; ++i) kernel.setArg(first + i, coordinates_[i]);
  }

  // On its own: what was found for other primitives says nothing about a tree of set operations.
  void enqueue_convex(std::size_t i) {
    const std::size_t groups = (size_ + width_ - 1) / width_;
    convex_distance_.enqueue(queue_, parts_[i].convex, 0, groups, views_[i]);
  }

  void enqueue_bent(std::size_t i) {
    const std::size_t groups = (size_ + solid_width_ - 1) / solid_width_;
    bent_distance_.setArg(0, static_cast<cl_ulong>(groups));
    bent_distance_.setArg(5, static_cast<cl_uint>(i));
    for (cl_uint k = 0; k < 5; ++k) bent_distance_.setArg(6 + k, views_[i][k]);
    queue_.launch(bent_distance_, groups);
  }

  std::size_t width_;        // of the kernels for single convex primitives
  std::size_t solid_width_;  // of those of the model's own program
  std::size_t capacity_;
  std::size_t count_;
  Scale scale_;
  ChunkQueue queue_;
  // Kernels do not keep the buffers that they are given.
  std::vector<Part> parts_;
  cl::Buffer box_primitives_;
  std::array<cl::Buffer, 3> coordinates_;
  ConvexDistance convex_distance_;
  cl::Kernel bent_distance_;
  cl::Kernel solid_distance_;
  std::array<cl::Buffer, 5> per_primitive_;  // lower ends, upper ends, normals x, y, z: primitive by primitive
  std::array<cl::Buffer, 2> result_;
  std::vector<EvidenceBuffers> views_;  // windows of those, one for each primitive
  std::size_t size_ = 0;
  std::array<std::vector<double>, 3> columns_;
  EnclosureColumns enclosures_;
};

}  // namespace

std::unique_ptr<Batch<Point>> solid_batch(const Device& device, const Model& model, double tolerance) {
  return reporting_failures(device.name, [&] {
    const SolidModel uploaded(device, model);
    std::vector<Slot> slots;
    for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, uploaded, tolerance);
    return std::unique_ptr<Batch<Point>>(
        std::make_unique<ChunkPipeline<Point, Slot>>(device.name, uploaded.size.chunk_size, std::move(slots)));
  });
}

}  // namespace verisq::device
