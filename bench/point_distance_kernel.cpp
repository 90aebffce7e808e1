/// Launches point_distance.cl directly, in both variants.
#include "bench/point_distance_kernel.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/opencl_device.hpp"
#include "host/device/primitive_parameters.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::bench {
namespace {

constexpr int outputs = 5;  // lo, hi, and the direction's x, y, z

cl::Program build(const cl::Context& context, int vector_width, KernelVariant variant) {
  const bool solver_only = variant == KernelVariant::solver_only;
  cl::Program program(context, std::string(kernels::embedded_sources()));
  program.build(fmt::format("-DVECTOR_WIDTH={}{}", vector_width, solver_only ? " -DSOLVER_ONLY" : "").c_str());
  return program;
}

}  // namespace

struct PointDistanceKernel::State {
  State(const DeviceReport& report, KernelVariant variant, std::size_t points)
      : context(device_named(report.name)),
        queue(context),
        kernel(build(context, report.vector_width, variant), "point_distance"),
        vector_width(static_cast<std::size_t>(report.vector_width)),
        groups(points / vector_width) {}

  void add_argument(cl_mem_flags access, std::size_t bytes, const void* data) {
    const cl::Buffer& buffer = buffers.emplace_back(context, access, bytes);
    if (data != nullptr) queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
    kernel.setArg(static_cast<cl_uint>(buffers.size()), buffer);  // argument 0 is the number of groups
  }

  cl::Context context;
  cl::CommandQueue queue;
  cl::Kernel kernel;
  std::size_t vector_width;
  std::size_t groups;
  std::vector<cl::Buffer> buffers;  // a kernel does not keep its arguments alive
};

PointDistanceKernel::PointDistanceKernel(const DeviceReport& device, KernelVariant variant, const Superquadric& solid,
                                         std::span<const Point> points)
    : state_(std::make_unique<State>(device, variant, points.size())) {
  const int scale = device::scale_exponent(Model{"", {{"solid", solid, {}}}});
  const auto parameters = device::primitive_parameters({"solid", solid, {}}, scale);
  std::vector<double> coordinates(this->points());
  const std::size_t bytes = coordinates.size() * sizeof(double);

  state_->kernel.setArg(0, static_cast<cl_ulong>(state_->groups));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < coordinates.size(); ++i) coordinates[i] = std::ldexp(points[i][axis], scale);
    state_->add_argument(CL_MEM_READ_ONLY, bytes, coordinates.data());
  }
  state_->add_argument(CL_MEM_READ_ONLY, sizeof parameters, &parameters);
  for (int i = 0; i < outputs; ++i) state_->add_argument(CL_MEM_WRITE_ONLY, bytes, nullptr);
  run();  // OpenCL may put off the uploads and the end of the build to the first launch
}

PointDistanceKernel::~PointDistanceKernel() = default;
PointDistanceKernel::PointDistanceKernel(PointDistanceKernel&&) noexcept = default;
PointDistanceKernel& PointDistanceKernel::operator=(PointDistanceKernel&&) noexcept = default;

std::size_t PointDistanceKernel::points() const {
  return state_->groups * state_->vector_width;
}

void PointDistanceKernel::run() {
  state_->queue.enqueueNDRangeKernel(state_->kernel, cl::NullRange, cl::NDRange(state_->groups));
  state_->queue.finish();
}

}  // namespace verisq::bench
