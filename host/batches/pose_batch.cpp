/// This file implements the streaming of poses through a device.
#include "host/batches/pose_batch.hpp"

#include <algorithm>

#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_queue.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/rotation.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t numbers_per_pose = 12;  // the rotation row by row, the translation

// One chunk on its way through the device: its own queue, so that its transfers overlap with the other's kernels.
class Slot {
 public:
  Slot(const Device& device, const cl::Program& program, const DeviceModel& both, std::size_t primitives_of_a)
      : width_(device.vector_width),
        capacity_(both.chunk_size),
        primitives_of_a_(primitives_of_a),
        primitives_of_both_(both.count),
        scale_(both.scale_exponent),
        queue_(device),
        primitives_(both.primitives),
        pair_distance_(program, "pair_distance"),
        poses_(queue_.numbers(numbers_per_pose * capacity_)),
        result_{queue_.numbers(capacity_), queue_.numbers(capacity_)},
        columns_(numbers_per_pose * capacity_),
        enclosures_(capacity_) {
    pair_distance_.setArg(1, static_cast<cl_ulong>(capacity_));
    pair_distance_.setArg(2, poses_);
    pair_distance_.setArg(3, primitives_);
    pair_distance_.setArg(7, result_[0]);
    pair_distance_.setArg(8, result_[1]);
  }

  void start(std::span<const Pose> poses) {
    size_ = poses.size();
    const std::size_t groups = (size_ + width_ - 1) / width_;
    upload(poses, groups * width_);
    pair_distance_.setArg(0, static_cast<cl_ulong>(groups));
    for (std::size_t a = 0; a < primitives_of_a_; ++a) {
      for (std::size_t b = primitives_of_a_; b < primitives_of_both_; ++b) {
        pair_distance_.setArg(4, static_cast<cl_uint>(a));
        pair_distance_.setArg(5, static_cast<cl_uint>(b));
        pair_distance_.setArg(6, static_cast<cl_uint>(a == 0 && b == primitives_of_a_ ? 1 : 0));
        queue_.launch(pair_distance_, groups);
      }
    }
    enclosures_.read(queue_, result_, size_);
    queue_.flush();
  }

  // Returns when kernels ran.
  std::vector<Running> finish(std::vector<Enclosure>& enclosures) {
    std::vector<Running> times = queue_.finish();
    enclosures_.deliver(scale_, enclosures);
    return times;
  }

  void certify(std::span<const Enclosure> /*enclosures*/, std::vector<Certificate>& /*certificates*/) const {}

 private:
  // Lanes beyond the last pose, up to `padded`, repeat it.
  void upload(std::span<const Pose> poses, std::size_t padded) {
    for (std::size_t n = 0; n < padded; ++n) {
      const Pose& pose = poses[std::min(n, size_ - 1)];
      const auto rotation = rotation_matrix(pose.quaternion);
      for (std::size_t i = 0; i < rotation.size(); ++i) columns_[i * capacity_ + n] = rotation[i];
      for (std::size_t i = 0; i < 3; ++i) {
        columns_[(rotation.size() + i) * capacity_ + n] = scale_.to_device(pose.translation[i]);
      }
    }
    queue_.write(poses_, columns_);
  }

  std::size_t width_;
  std::size_t capacity_;
  std::size_t primitives_of_a_;
  std::size_t primitives_of_both_;
  Scale scale_;
  ChunkQueue queue_;
  // A kernel does not keep the buffers that it is given.
  cl::Buffer primitives_;
  cl::Kernel pair_distance_;
  cl::Buffer poses_;
  std::array<cl::Buffer, 2> result_;
  std::size_t size_ = 0;
  std::vector<double> columns_;
  EnclosureColumns enclosures_;
};

}  // namespace

std::unique_ptr<Batch<Pose>> pose_batch(const Device& device, const Model& a, const Model& b) {
  return reporting_failures(device.name, [&] {
    const DeviceModel both(device, joined(a, b));
    const cl::Program program = build_program(device.context, device.device, device.vector_width,
                                              kernels::embedded_pair_sources(), both.memory);
    std::vector<Slot> slots;
    for (int slot = 0; slot < 2; ++slot) slots.emplace_back(device, program, both, a.primitives.size());
    auto pipeline = std::make_unique<ChunkPipeline<Pose, Slot>>(device.name, both.chunk_size, std::move(slots));
    pipeline->warm_up(Pose{{far_away(both), 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}});
    return std::unique_ptr<Batch<Pose>>(std::move(pipeline));
  });
}

}  // namespace verisq::device
