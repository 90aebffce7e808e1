/// This file implements the streaming of triangles through a device.
#include "host/batches/triangle_batch.hpp"

#include <algorithm>
#include <array>

#include "host/batches/certificate_assembly.hpp"
#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_queue.hpp"
#include "host/batches/device_model.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t coordinates = 9;  // of a triangle: x, y, z of each corner

// What triangle_distance tells about one primitive: lower and upper ends, normals x, y, z, weights 1 and 2.
constexpr std::size_t outputs = 7;

// One chunk on its way through the device: its own queue, so that its transfers overlap with the other's kernels.
class Slot {
 public:
  Slot(const Device& device, const cl::Program& program, const DeviceModel& model, bool certificates)
      : width_(device.vector_width),
        capacity_(model.chunk_size),
        count_(model.count),
        scale_(model.scale_exponent),
        queue_(device),
        primitives_(model.primitives),
        triangle_distance_(program, "triangle_distance"),
        union_distance_(program, "triangle_union_distance"),
        corners_(queue_.numbers(coordinates * capacity_)),
        nearest_(queue_.numbers(capacity_)),
        columns_(coordinates * capacity_),
        enclosures_(capacity_) {
    for (cl::Buffer& output : per_primitive_) output = queue_.numbers(capacity_ * count_);
    for (std::size_t i = 0; i < 2; ++i) result_[i] = count_ > 1 ? queue_.numbers(capacity_) : per_primitive_[i];
    triangle_distance_.setArg(1, static_cast<cl_ulong>(capacity_));
    triangle_distance_.setArg(2, corners_);
    triangle_distance_.setArg(3, primitives_);
    triangle_distance_.setArg(5, nearest_);
    union_distance_.setArg(1, static_cast<cl_ulong>(capacity_));
    union_distance_.setArg(2, static_cast<cl_uint>(count_));
    for (cl_uint i = 0; i < 2; ++i) {
      union_distance_.setArg(3 + i, per_primitive_[i]);
      union_distance_.setArg(5 + i, result_[i]);
    }
    if (certificates) evidence_.resize((outputs - 1) * count_ * capacity_);
    for (std::size_t i = 0; i < views_.size(); ++i) views_[i] = windows(per_primitive_[i], count_, capacity_);
  }

  void start(std::span<const Triangle> triangles) {
    size_ = triangles.size();
    const std::size_t groups = (size_ + width_ - 1) / width_;
    upload(triangles, groups * width_);
    for (std::size_t index = 0; index < count_; ++index) launch_primitive(index, groups);
    if (count_ > 1) {
      union_distance_.setArg(0, static_cast<cl_ulong>(groups));
      queue_.launch(union_distance_, groups);
    }
    enclosures_.read(queue_, result_, size_);
    if (!evidence_.empty()) read_evidence();
    queue_.flush();
  }

  // Returns when kernels ran.
  std::vector<Running> finish(std::vector<Enclosure>& enclosures) {
    std::vector<Running> times = queue_.finish();
    enclosures_.deliver(scale_, enclosures);
    return times;
  }

  // Fills `certificates` where they were asked for. Precondition: finished.
  void certify(std::span<const Enclosure> /*enclosures*/, std::vector<Certificate>& certificates) const {
    if (evidence_.empty()) return;
    TriangleEvidence evidence(count_);
    for (std::size_t n = 0; n < size_; ++n) {
      for (std::size_t index = 0; index < count_; ++index) {
        const double* const first = evidence_.data() + index * (outputs - 1) * capacity_ + n;
        const auto column = [&](std::size_t i) { return first[i * capacity_]; };
        const auto length = [&](std::size_t i) { return scale_.to_model(column(i)); };
        evidence[index] = {{length(0), {length(1), length(2), length(3)}}, {column(4), column(5)}};
      }
      certificates.push_back(certificate_of(evidence));
    }
  }

 private:
  [[nodiscard]] double& coordinate(std::size_t column, std::size_t n) { return columns_[column * capacity_ + n]; }

  // Lanes beyond the last triangle, up to `padded`, repeat it.
  void upload(std::span<const Triangle> triangles, std::size_t padded) {
    for (std::size_t c = 0; c < coordinates; ++c) {
      for (std::size_t n = 0; n < padded; ++n) {
        coordinate(c, n) = scale_.to_device(triangles[std::min(n, size_ - 1)][c / 3][c % 3]);
      }
    }
    queue_.write(corners_, columns_);
  }

  void launch_primitive(std::size_t index, std::size_t groups) {
    triangle_distance_.setArg(0, static_cast<cl_ulong>(groups));
    triangle_distance_.setArg(4, static_cast<cl_uint>(index));
    for (cl_uint i = 0; i < outputs; ++i) triangle_distance_.setArg(6 + i, views_[i][index]);
    queue_.launch(triangle_distance_, groups);
  }

  // All outputs but the lower ends.
  void read_evidence() {
    double* column = evidence_.data();
    for (std::size_t index = 0; index < count_; ++index) {
      for (std::size_t i = 1; i < outputs; ++i, column += capacity_) queue_.read(views_[i][index], {column, size_});
    }
  }

  std::size_t width_;
  std::size_t capacity_;
  std::size_t count_;
  Scale scale_;
  ChunkQueue queue_;
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  cl::Kernel triangle_distance_;
  cl::Kernel union_distance_;
  cl::Buffer corners_;
  cl::Buffer nearest_;
  std::array<cl::Buffer, outputs> per_primitive_;
  std::array<cl::Buffer, 2> result_;
  std::array<std::vector<cl::Buffer>, outputs> views_;  // windows of those, one for each primitive
  std::size_t size_ = 0;
  std::vector<double> columns_;
  EnclosureColumns enclosures_;
  std::vector<double> evidence_;  // columns of `capacity` numbers; empty unless certificates are asked for
};

}  // namespace

std::unique_ptr<Batch<Triangle>> triangle_batch(const Device& device, const Model& model, bool certificates) {
  return reporting_failures(device.name, [&] {
    const DeviceModel uploaded(device, model);
    const cl::Program program = build_program(device.context, device.device, device.vector_width,
                                              kernels::embedded_triangle_sources(), uploaded.memory);
    std::vector<Slot> slots;
    for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, program, uploaded, certificates);
    auto pipeline = std::make_unique<ChunkPipeline<Triangle, Slot>>(device.name, uploaded.chunk_size, std::move(slots));
    const double x = far_away(uploaded);
    pipeline->warm_up({Point{x, 0.0, 0.0}, Point{x, x, 0.0}, Point{x, 0.0, x}});
    return std::unique_ptr<Batch<Triangle>>(std::move(pipeline));
  });
}

}  // namespace verisq::device
