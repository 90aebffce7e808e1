/// Launches point_distance.cl directly, in both variants.
#include "bench/point_distance_kernel.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/primitive_parameters.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::bench {
namespace {

// As host/device/device_model.cpp launches it.
constexpr std::size_t points_of_vector_work_item = 2048;
constexpr std::size_t scalar_group_size = 32;

device::Device selected(const DeviceReport& report) {
  auto selection = device::select_device(std::to_string(report.index));
  if (!selection.device) throw std::runtime_error(report.name + " cannot be used: " + selection.notice);
  return *selection.device;
}

cl::Program program_of(const device::Device& device, KernelVariant variant, bool tapered) {
  const auto sources = tapered ? kernels::embedded_tapered_sources() : kernels::embedded_point_sources();
  return device::build_program(device.context, device.device, device.vector_width, sources,
                               variant == KernelVariant::verified ? "" : "-DSOLVER_ONLY");
}

}  // namespace

struct PointDistanceKernel::State {
  State(const device::Device& device, KernelVariant variant, bool tapered, std::size_t points)
      : context(device.context),
        queue(device.context, device.device),
        kernel(program_of(device, variant, tapered), "point_distance"),
        vector_width(static_cast<std::size_t>(device.vector_width)),
        groups(points / vector_width),
        groups_per_block(vector_width > 1 ? points_of_vector_work_item / vector_width : 1) {}

  template <class Value>
  void add_value(Value value) {
    kernel.setArg(next_argument++, value);
  }

  void add_array(std::size_t bytes, const void* data = nullptr) {
    const cl::Buffer& buffer = buffers.emplace_back(context, CL_MEM_READ_WRITE, bytes);
    if (data != nullptr) queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
    kernel.setArg(next_argument++, buffer);
  }

  cl::Context context;
  cl::CommandQueue queue;
  cl::Kernel kernel;
  std::size_t vector_width;
  std::size_t groups;
  std::size_t groups_per_block;
  cl_uint next_argument = 0;
  std::vector<cl::Buffer> buffers;  // a kernel does not keep its arguments alive
};

PointDistanceKernel::PointDistanceKernel(const DeviceReport& device, KernelVariant variant, const Superquadric& solid,
                                         std::span<const Point> points)
    : state_(std::make_unique<State>(selected(device), variant, is_tapered(solid), points.size())) {
  const int scale = device::scale_exponent(Model{"", {{"solid", solid, {}}}});
  const auto parameters = device::primitive_parameters({"solid", solid, {}}, scale);
  std::vector<double> coordinates(this->points());
  const std::size_t bytes = coordinates.size() * sizeof(double);

  state_->add_value(static_cast<cl_ulong>(state_->groups));
  state_->add_value(static_cast<cl_uint>(state_->groups_per_block));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < coordinates.size(); ++i) coordinates[i] = std::ldexp(points[i][axis], scale);
    state_->add_array(bytes, coordinates.data());
  }
  state_->add_array(sizeof parameters, &parameters);
  state_->add_value(cl_uint{0});                         // the only primitive
  state_->add_array(sizeof(cl_uint));                    // lists are of further primitives
  for (int i = 0; i < 6; ++i) state_->add_array(bytes);  // nearest, lo, hi, and the direction's x, y, z
  run();  // OpenCL may put off the uploads and the end of the build to the first launch
}

PointDistanceKernel::~PointDistanceKernel() = default;
PointDistanceKernel::PointDistanceKernel(PointDistanceKernel&&) noexcept = default;
PointDistanceKernel& PointDistanceKernel::operator=(PointDistanceKernel&&) noexcept = default;

std::size_t PointDistanceKernel::points() const {
  return state_->groups * state_->vector_width;
}

void PointDistanceKernel::run() {
  const std::size_t blocks = (state_->groups + state_->groups_per_block - 1) / state_->groups_per_block;
  const std::size_t group_size = state_->vector_width > 1 ? 1 : scalar_group_size;
  const std::size_t work_items = (blocks + group_size - 1) / group_size * group_size;
  state_->queue.enqueueNDRangeKernel(state_->kernel, cl::NullRange, cl::NDRange(work_items), cl::NDRange(group_size));
  state_->queue.finish();
}

}  // namespace verisq::bench
