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
#include "host/batches/device_model.hpp"
#include "host/batches/point_kernels.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t numbers_per_primitive = 4;  // of its evidence: upper end and normal

// One chunk on its way through the device.
class PointSlot : public ChunkSlot {
 public:
  // `assembly`: nothing unless certificates are asked for.
  PointSlot(const Device& device, const PointPrograms& programs, const DeviceModel& model, double tolerance,
            std::optional<CertificateAssembly> assembly)
      : ChunkSlot(device, model),
        assembly_(std::move(assembly)),
        kernels_(device, programs, model, queue_, scale_.to_device(tolerance)) {
    for (auto& column : columns_) column.resize(capacity_);
    if (assembly_) evidence_.resize(capacity_ * (numbers_per_primitive * count_ + 3));
  }

  void start(std::span<const Point> points) {
    size_ = points.size();
    for (std::size_t i = 0; i < 3; ++i) {
      fill(columns_[i], [&](std::size_t n) { return scale_.to_device(points[n][i]); });
      queue_.write(kernels_.coordinates()[i], std::span(columns_[i]).first(padded()));
    }
    kernels_.enqueue(queue_, groups());
    enclosures_.read(queue_, kernels_.ends(), size_);
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
    for (const EvidenceBuffers& evidence : kernels_.evidence())
      for (std::size_t i = 1; i < evidence.size(); ++i) read(evidence[i]);
    if (count_ > 1)
      for (const cl::Buffer& escape : kernels_.escapes()) read(escape);
  }

  [[nodiscard]] Point in_model_units(const double* x) const {
    return {scale_.to_model(x[0]), scale_.to_model(x[capacity_]), scale_.to_model(x[2 * capacity_])};
  }

  std::optional<CertificateAssembly> assembly_;
  PointKernels kernels_;
  std::array<std::vector<double>, 3> columns_;
  std::vector<double> evidence_;  // columns of `capacity` numbers; empty unless certificates are asked for
};

std::unique_ptr<Batch<Point>> pipeline(const Device& device, const PointPrograms& programs, const Model& model,
                                       const DeviceModel& uploaded, double tolerance, bool certificates) {
  std::optional<CertificateAssembly> assembly;
  if (certificates) assembly.emplace(model);
  std::vector<PointSlot> slots;
  slots.reserve(2);
  for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, programs, uploaded, tolerance, assembly);
  auto batch = std::make_unique<ChunkPipeline<Point, PointSlot>>(device.name, uploaded.chunk_size, std::move(slots));
  batch->warm_up({far_away(uploaded), 0.0, 0.0});
  return batch;
}

}  // namespace

std::unique_ptr<Batch<Point>> point_batch(const Device& device, const Model& model, double tolerance,
                                          bool certificates) {
  return reporting_failures(device.name, [&] {
    const DeviceModel uploaded(device, model);
    return pipeline(device, point_programs(device, uploaded.memory, uploaded.has_tapered()), model, uploaded, tolerance,
                    certificates);
  });
}

std::unique_ptr<Batch<Point>> point_batch(const Device& device, const cl::Program& program, const Model& model,
                                          double tolerance, bool certificates) {
  return reporting_failures(device.name, [&] {
    return pipeline(device, program, model, DeviceModel(device, model), tolerance, certificates);
  });
}

}  // namespace verisq::device
