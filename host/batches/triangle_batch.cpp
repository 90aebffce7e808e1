/// This file implements the streaming of triangles through a device.
#include "host/batches/triangle_batch.hpp"

#include <array>
#include <string_view>

#include "host/batches/certificate_assembly.hpp"
#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_slot.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/kernel_arguments.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t coordinates = 9;  // of a triangle: x, y, z of each corner

// What triangle_distance tells about one primitive.
constexpr std::array<std::string_view, 7> output_arguments{"los",       "his",       "normal_xs", "normal_ys",
                                                           "normal_zs", "weights_1", "weights_2"};
constexpr std::size_t outputs = output_arguments.size();
using Outputs = std::array<cl::Buffer, outputs>;

// One chunk on its way through the device.
class TriangleSlot : public ChunkSlot {
 public:
  TriangleSlot(const Device& device, const cl::Program& program, const DeviceModel& model, bool certificates)
      : ChunkSlot(device, model),
        primitives_(model.primitives),
        triangle_distance_(program, kernels::embedded_triangle_sources(), "triangle_distance"),
        union_distance_(program, kernels::embedded_triangle_sources(), "triangle_union_distance"),
        corners_(queue_.numbers(coordinates * capacity_)),
        nearest_(queue_.numbers(capacity_)),
        views_(count_),
        columns_(coordinates * capacity_) {
    for (std::size_t i = 0; i < outputs; ++i) {
      per_primitive_[i] = queue_.numbers(capacity_ * count_);
      const std::vector<cl::Buffer> columns = windows(per_primitive_[i], count_, capacity_);
      for (std::size_t index = 0; index < count_; ++index) views_[index][i] = columns[index];
    }
    for (std::size_t i = 0; i < 2; ++i) result_[i] = count_ > 1 ? queue_.numbers(capacity_) : per_primitive_[i];
    triangle_distance_.set("stride", capacity_);
    triangle_distance_.set("corners", corners_);
    triangle_distance_.set("primitives", primitives_);
    triangle_distance_.set("nearest", nearest_);
    union_distance_.set("stride", capacity_);
    union_distance_.set("count", count_);
    union_distance_.set(enclosure_arguments, std::array{per_primitive_[0], per_primitive_[1]});
    union_distance_.set(union_arguments, result_);
    if (certificates) evidence_.resize((outputs - 1) * count_ * capacity_);
  }

  void start(std::span<const Triangle> triangles) {
    size_ = triangles.size();
    upload(triangles);
    for (std::size_t index = 0; index < count_; ++index) launch_primitive(index);
    if (count_ > 1) {
      union_distance_.set("groups", groups());
      queue_.launch(union_distance_, groups());
    }
    enclosures_.read(queue_, result_, size_);
    if (!evidence_.empty()) read_evidence();
    queue_.flush();
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
  void upload(std::span<const Triangle> triangles) {
    for (std::size_t c = 0; c < coordinates; ++c) {
      const std::span column = std::span(columns_).subspan(c * capacity_, padded());
      fill(column, [&](std::size_t n) { return scale_.to_device(triangles[n][c / 3][c % 3]); });
      queue_.write(corners_, column, c * capacity_);
    }
  }

  void launch_primitive(std::size_t index) {
    triangle_distance_.set("groups", groups());
    triangle_distance_.set("index", index);
    triangle_distance_.set(output_arguments, views_[index]);
    queue_.launch(triangle_distance_, groups());
  }

  // All outputs but the lower ends.
  void read_evidence() {
    double* column = evidence_.data();
    for (const Outputs& view : views_) {
      for (std::size_t i = 1; i < outputs; ++i, column += capacity_) queue_.read(view[i], {column, size_});
    }
  }

  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  NamedKernel triangle_distance_;
  NamedKernel union_distance_;
  cl::Buffer corners_;
  cl::Buffer nearest_;
  Outputs per_primitive_;
  std::array<cl::Buffer, 2> result_;
  std::vector<Outputs> views_;  // windows of those, one for each primitive
  std::vector<double> columns_;
  std::vector<double> evidence_;  // columns of `capacity` numbers; empty unless certificates are asked for
};

}  // namespace

std::unique_ptr<Batch<Triangle>> triangle_batch(const Device& device, const Model& model, bool certificates) {
  return reporting_failures(device.name, [&] {
    const DeviceModel uploaded(device, model);
    const cl::Program program = build_program(device.context, device.device, device.vector_width,
                                              kernels::embedded_triangle_sources(), uploaded.memory);
    std::vector<TriangleSlot> slots;
    slots.reserve(2);
    for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, program, uploaded, certificates);
    auto pipeline =
        std::make_unique<ChunkPipeline<Triangle, TriangleSlot>>(device.name, uploaded.chunk_size, std::move(slots));
    const double x = far_away(uploaded);
    pipeline->warm_up({Point{x, 0.0, 0.0}, Point{x, x, 0.0}, Point{x, 0.0, x}});
    return std::unique_ptr<Batch<Triangle>>(std::move(pipeline));
  });
}

}  // namespace verisq::device
