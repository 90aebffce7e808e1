/// This file implements uploads, launches and their clock.
#include "host/device/chunk_queue.hpp"

#include <limits>

namespace verisq::device {
namespace {

double rounded_down(double x, double factor) {
  const double y = x / factor;
  const double back = y * factor;
  if (back == x || std::isnan(x)) return y;
  if (std::isinf(y)) return y > 0.0 ? std::numeric_limits<double>::max() : y;
  return back > x ? std::nextafter(y, -std::numeric_limits<double>::infinity()) : y;
}

}  // namespace

Enclosure Scale::to_model(const Enclosure& e) const {
  return {rounded_down(e.lo, factor_), -rounded_down(-e.hi, factor_)};
}

ChunkQueue::ChunkQueue(const Device& device)
    : context_(device.context), queue_(device.context, device.device, CL_QUEUE_PROFILING_ENABLE) {}

cl::Buffer ChunkQueue::numbers(std::size_t count) {
  const cl::Buffer buffer(context_, CL_MEM_READ_WRITE, count * sizeof(double));
  queue_.enqueueFillBuffer(buffer, 0.0, 0, count * sizeof(double));
  return buffer;
}

void ChunkQueue::write(const cl::Buffer& buffer, std::span<const double> column) {
  queue_.enqueueWriteBuffer(buffer, CL_FALSE, 0, column.size_bytes(), column.data());
}

void ChunkQueue::read(const cl::Buffer& buffer, std::span<double> column) {
  queue_.enqueueReadBuffer(buffer, CL_FALSE, 0, column.size_bytes(), column.data());
}

void ChunkQueue::launch(const cl::Kernel& kernel, std::size_t work_items, std::size_t local) {
  cl::Event event;
  queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((work_items + local - 1) / local * local),
                              cl::NDRange(local), nullptr, &event);
  kernels_.push_back(std::move(event));
}

double ChunkQueue::finish() {
  queue_.finish();
  double seconds = 0.0;
  for (const cl::Event& kernel : kernels_) {
    seconds += 1e-9 * static_cast<double>(kernel.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                          kernel.getProfilingInfo<CL_PROFILING_COMMAND_START>());
  }
  kernels_.clear();
  return seconds;
}

}  // namespace verisq::device
