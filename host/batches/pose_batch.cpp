/// This file implements the streaming of poses through a device.
#include "host/batches/pose_batch.hpp"

#include <array>
#include <vector>

#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_slot.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/kernel_arguments.hpp"
#include "host/batches/rotation.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t numbers_per_pose = 12;  // the rotation row by row, the translation

// One chunk on its way through the device.
class PoseSlot : public ChunkSlot {
 public:
  PoseSlot(const Device& device, const cl::Program& program, const DeviceModel& both, std::size_t primitives_of_a)
      : ChunkSlot(device, both),
        primitives_of_a_(primitives_of_a),
        primitives_(both.primitives),
        pair_distance_(program, kernels::embedded_pair_sources(), "pair_distance"),
        poses_(queue_.numbers(numbers_per_pose * capacity_)),
        result_{queue_.numbers(capacity_), queue_.numbers(capacity_)},
        columns_(numbers_per_pose * capacity_) {
    pair_distance_.set("stride", capacity_);
    pair_distance_.set("poses", poses_);
    pair_distance_.set("primitives", primitives_);
    pair_distance_.set(enclosure_arguments, result_);
  }

  void start(std::span<const Pose> poses) {
    size_ = poses.size();
    upload(poses);
    pair_distance_.set("groups", groups());
    for (std::size_t a = 0; a < primitives_of_a_; ++a) {
      for (std::size_t b = primitives_of_a_; b < count_; ++b) {
        pair_distance_.set("index_a", a);
        pair_distance_.set("index_b", b);
        pair_distance_.set("first", a == 0 && b == primitives_of_a_ ? 1U : 0U);
        queue_.launch(pair_distance_, groups());
      }
    }
    enclosures_.read(queue_, result_, size_);
    queue_.flush();
  }

 private:
  void upload(std::span<const Pose> poses) {
    std::vector<std::array<double, 9>> rotations;
    for (const Pose& pose : poses) rotations.push_back(rotation_matrix(pose.quaternion));
    for (std::size_t i = 0; i < numbers_per_pose; ++i) {
      const std::span column = std::span(columns_).subspan(i * capacity_, padded());
      if (i < 9) {
        fill(column, [&](std::size_t n) { return rotations[n][i]; });
      } else {
        fill(column, [&](std::size_t n) { return scale_.to_device(poses[n].translation[i - 9]); });
      }
      queue_.write(poses_, column, i * capacity_);
    }
  }

  std::size_t primitives_of_a_;
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  NamedKernel pair_distance_;
  cl::Buffer poses_;
  std::array<cl::Buffer, 2> result_;
  std::vector<double> columns_;
};

}  // namespace

std::unique_ptr<Batch<Pose>> pose_batch(const Device& device, const Model& a, const Model& b) {
  return reporting_failures(device.name, [&] {
    const DeviceModel both(device, joined(a, b));
    const cl::Program program = build_program(device.context, device.device, device.vector_width,
                                              kernels::embedded_pair_sources(), both.memory);
    std::vector<PoseSlot> slots;
    slots.reserve(2);
    for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, program, both, a.primitives.size());
    auto pipeline = std::make_unique<ChunkPipeline<Pose, PoseSlot>>(device.name, both.chunk_size, std::move(slots));
    pipeline->warm_up(Pose{{far_away(both), 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
    return std::unique_ptr<Batch<Pose>>(std::move(pipeline));
  });
}

}  // namespace verisq::device
