/// Measures the FP64 FMA rate of an OpenCL device with independent chains of vector FMAs.
#include "bench/peak_rate.hpp"

#include <algorithm>
#include <chrono>
#include <string>

#include "bench/opencl_device.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::bench {
namespace {

// Twelve chains cover latency times throughput of today's cores (4 cycles, 2 a cycle) and leave registers free. A
// work-group of one item keeps PoCL from interleaving items; a GPU gets its parallelism from their number.
constexpr int chains = 12;
constexpr int lanes = 8;
constexpr cl_int steps = 4096;
constexpr int repetitions = 31;

constexpr auto source = R"opencl(
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
kernel void chained_fma(global double* out, double factor, double summand, int steps) {
  const double8 a = (double8)(factor);
  const double8 b = (double8)(summand);
  double8 c0 = (double8)(get_global_id(0));
  double8 c1 = c0 + 1, c2 = c0 + 2, c3 = c0 + 3, c4 = c0 + 4, c5 = c0 + 5, c6 = c0 + 6, c7 = c0 + 7;
  double8 c8 = c0 + 8, c9 = c0 + 9, c10 = c0 + 10, c11 = c0 + 11;
  for (int i = 0; i < steps; ++i) {
    c0 = fma(c0, a, b); c1 = fma(c1, a, b); c2 = fma(c2, a, b); c3 = fma(c3, a, b);
    c4 = fma(c4, a, b); c5 = fma(c5, a, b); c6 = fma(c6, a, b); c7 = fma(c7, a, b);
    c8 = fma(c8, a, b); c9 = fma(c9, a, b); c10 = fma(c10, a, b); c11 = fma(c11, a, b);
  }
  vstore8(c0 + c1 + c2 + c3 + c4 + c5 + c6 + c7 + c8 + c9 + c10 + c11, get_global_id(0), out);
}
)opencl";

double seconds_of(const cl::CommandQueue& queue, const cl::Kernel& kernel, const cl::NDRange& items,
                  const cl::NDRange& group) {
  const auto start = std::chrono::steady_clock::now();
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, items, group);
  queue.finish();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

double measured_peak_rate(std::string_view device_name) {
  const cl::Device device = device_named(device_name);
  const bool is_gpu = device.getInfo<CL_DEVICE_TYPE>() == CL_DEVICE_TYPE_GPU;
  const std::size_t group = is_gpu ? 128 : 1;
  const std::size_t items = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>() * group * 64;

  const cl::Context context(device);
  const cl::CommandQueue queue(context, device);
  cl::Program program(context, std::string(source));
  program.build();
  cl::Kernel kernel(program, "chained_fma");
  const cl::Buffer out(context, CL_MEM_WRITE_ONLY, items * lanes * sizeof(double));
  kernel.setArg(0, out);
  kernel.setArg(1, 0.999);  // the chains converge to 1: no overflow, no subnormal numbers
  kernel.setArg(2, 0.001);
  kernel.setArg(3, steps);

  double best = infinity;
  for (int i = 0; i < repetitions; ++i) best = std::min(best, seconds_of(queue, kernel, items, group));
  return 2.0 * chains * lanes * static_cast<double>(steps) * static_cast<double>(items) / best;
}

}  // namespace verisq::bench
