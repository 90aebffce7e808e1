/// This file implements the streaming of points through a device.
#include "host/batches/point_batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "host/batches/certificate_assembly.hpp"
#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_slot.hpp"
#include "host/batches/convex_distance.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/kernel_arguments.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t numbers_per_primitive = 4;  // of its evidence: upper end and normal
constexpr std::array<std::string_view, 3> escape_arguments{"escape_xs", "escape_ys", "escape_zs"};

// One chunk on its way through the device.
class PointSlot : public ChunkSlot {
 public:
  // `assembly`: nothing unless certificates are asked for.
  PointSlot(const Device& device, const cl::Program& program, const DeviceModel& model, double tolerance,
            std::optional<CertificateAssembly> assembly)
      : ChunkSlot(device, model),
        assembly_(std::move(assembly)),
        primitives_(model.primitives),
        coordinates_{queue_.numbers(capacity_), queue_.numbers(capacity_), queue_.numbers(capacity_)},
        convex_distance_(device, program, queue_, coordinates_, capacity_, scale_.to_device(tolerance)),
        union_distance_(program, kernels::embedded_point_sources(), "union_distance") {
    for (cl::Buffer& evidence : per_primitive_) evidence = queue_.numbers(capacity_ * count_);
    result_[0] = count_ > 1 ? queue_.numbers(capacity_) : per_primitive_[0];
    result_[1] = count_ > 1 ? queue_.numbers(capacity_) : per_primitive_[1];
    for (cl::Buffer& escape : escape_) escape = queue_.numbers(count_ > 1 ? capacity_ : 1);

    union_distance_.set("stride", capacity_);
    union_distance_.set(coordinate_arguments, coordinates_);
    union_distance_.set("primitives", primitives_);
    union_distance_.set("count", count_);
    union_distance_.set(evidence_arguments, per_primitive_);
    union_distance_.set(union_arguments, result_);
    union_distance_.set(escape_arguments, escape_);
    for (auto& column : columns_) column.resize(capacity_);
    if (assembly_) evidence_.resize(capacity_ * (numbers_per_primitive * count_ + 3));
    views_ = views_of_primitives(per_primitive_, count_, capacity_);
  }

  void start(std::span<const Point> points) {
    size_ = points.size();
    for (std::size_t i = 0; i < 3; ++i) {
      fill(columns_[i], [&](std::size_t n) { return scale_.to_device(points[n][i]); });
      queue_.write(coordinates_[i], std::span(columns_[i]).first(padded()));
    }
    for (std::size_t index = 0; index < count_; ++index)
      convex_distance_.enqueue(queue_, primitives_, index, groups(), views_[index]);
    if (count_ > 1) {
      union_distance_.set("groups", groups());
      queue_.launch(union_distance_, groups());
    }
    enclosures_.read(queue_, result_, size_);
    if (!evidence_.empty()) read_evidence();
    queue_.flush();
  }

  // Fills `certificates` where they were asked for. Precondition: finished.
  void certify(std::span<const Enclosure> enclosures, std::vector<Certificate>& certificates) const {
    if (!assembly_) return;
    Evidence evidence;
    evidence.primitives.resize(count_);
    for (std::size_t n = 0; n < size_; ++n) {
      for (std::size_t index = 0; index < count_; ++index) {
        const double* const column = evidence_.data() + index * numbers_per_primitive * capacity_ + n;
        evidence.primitives[index] = {scale_.to_model(column[0]), in_model_units(column + capacity_)};
      }
      evidence.escape = in_model_units(evidence_.data() + count_ * numbers_per_primitive * capacity_ + n);
      const Point point{scale_.to_model(columns_[0][n]), scale_.to_model(columns_[1][n]),
                        scale_.to_model(columns_[2][n])};
      certificates.push_back((*assembly_)(point, enclosures[n], evidence));
    }
  }

 private:
  // Upper ends and normals of every primitive, then the escapes.
  void read_evidence() {
    double* column = evidence_.data();
    const auto read = [&](const cl::Buffer& buffer) {
      queue_.read(buffer, {column, size_});
      column += capacity_;
    };
    for (std::size_t index = 0; index < count_; ++index)
      for (std::size_t i = 1; i < views_[index].size(); ++i) read(views_[index][i]);
    if (count_ > 1)
      for (const cl::Buffer& escape : escape_) read(escape);
  }

  [[nodiscard]] Point in_model_units(const double* x) const {
    return {scale_.to_model(x[0]), scale_.to_model(x[capacity_]), scale_.to_model(x[2 * capacity_])};
  }

  std::optional<CertificateAssembly> assembly_;
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  std::array<cl::Buffer, 3> coordinates_;
  ConvexDistance convex_distance_;
  NamedKernel union_distance_;
  EvidenceBuffers per_primitive_;  // primitive by primitive
  std::array<cl::Buffer, 2> result_;
  std::array<cl::Buffer, 3> escape_;
  std::vector<EvidenceBuffers> views_;  // windows of those, one for each primitive
  std::array<std::vector<double>, 3> columns_;
  std::vector<double> evidence_;  // columns of `capacity` numbers; empty unless certificates are asked for
};

std::unique_ptr<Batch<Point>> pipeline(const Device& device, const cl::Program& program, const Model& model,
                                       const DeviceModel& uploaded, double tolerance, bool certificates) {
  std::optional<CertificateAssembly> assembly;
  if (certificates) assembly.emplace(model);
  std::vector<PointSlot> slots;
  slots.reserve(2);
  for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, program, uploaded, tolerance, assembly);
  auto batch = std::make_unique<ChunkPipeline<Point, PointSlot>>(device.name, uploaded.chunk_size, std::move(slots));
  batch->warm_up({far_away(uploaded), 0.0, 0.0});
  return batch;
}

}  // namespace

std::unique_ptr<Batch<Point>> point_batch(const Device& device, const Model& model, double tolerance,
                                          bool certificates) {
  return reporting_failures(device.name, [&] {
    const DeviceModel uploaded(device, model);
    return pipeline(device, point_program(device, uploaded.memory), model, uploaded, tolerance, certificates);
  });
}

std::unique_ptr<Batch<Point>> point_batch(const Device& device, const cl::Program& program, const Model& model,
                                          double tolerance, bool certificates) {
  return reporting_failures(device.name, [&] {
    return pipeline(device, program, model, DeviceModel(device, model), tolerance, certificates);
  });
}

}  // namespace verisq::device
