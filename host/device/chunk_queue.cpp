/// This file implements chunk_queue.hpp.
#include "host/device/chunk_queue.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

std::vector<Running> united(std::vector<Running> all) {
  std::ranges::sort(all, {}, &Running::start);
  std::vector<Running> apart;
  for (const Running& next : all) {
    if (!apart.empty() && next.start <= apart.back().end) {
      apart.back().end = std::max(apart.back().end, next.end);
    } else if (next.start < next.end) {
      apart.push_back(next);
    }
  }
  return apart;
}

std::uint64_t total(std::span<const Running> apart) {
  std::uint64_t sum = 0;
  for (const auto& [start, end] : apart) sum += end - start;
  return sum;
}

}  // namespace

double seconds_of(std::span<const Running> kernels) {
  return 1e-9 * static_cast<double>(total(kernels));
}

void BusyTime::add(std::span<const Running> chunk) {
  open_.insert(open_.end(), chunk.begin(), chunk.end());
  open_ = united(std::move(open_));
  // The chunks to come start after the last one's end.
  const std::uint64_t all = total(open_);
  for (Running& running : open_)
    running.start = std::clamp(running.start, std::min(last_end_, running.end), running.end);
  std::erase_if(open_, [](const Running& running) { return running.start == running.end; });
  settled_ += all - total(open_);
  for (const Running& running : chunk) last_end_ = std::max(last_end_, running.end);
}

double BusyTime::seconds() const {
  return 1e-9 * static_cast<double>(settled_ + total(open_));
}

namespace {

double rounded_down(double x, double factor) {
  const double y = x / factor;
  const double back = y * factor;
  if (back == x || std::isnan(x)) return y;
  if (std::isinf(y)) return y > 0.0 ? std::numeric_limits<double>::max() : y;
  return back > x ? std::nextafter(y, -infinity) : y;
}

}  // namespace

Enclosure Scale::to_model(const Enclosure& e) const {
  return {rounded_down(e.lo, factor_), -rounded_down(-e.hi, factor_)};
}

void Scale::to_model(std::span<const double> los, std::span<const double> his, std::span<Enclosure> enclosures) const {
  std::size_t inexact = 0;
  for (std::size_t n = 0; n < enclosures.size(); ++n) {
    const Enclosure e{los[n] * inverse_, his[n] * inverse_};
    // A product with a power of two is exact unless it under- or overflows, and then it does not lead back.
    inexact += static_cast<std::size_t>(e.lo * factor_ != los[n]);
    inexact += static_cast<std::size_t>(e.hi * factor_ != his[n]);
    enclosures[n] = e;
  }
  if (inexact == 0) return;
  for (std::size_t n = 0; n < enclosures.size(); ++n) enclosures[n] = to_model(Enclosure{los[n], his[n]});
}

ChunkQueue::ChunkQueue(const Device& device)
    : context_(device.context),
      queue_(device.context, device.device, CL_QUEUE_PROFILING_ENABLE),
      usual_group_size_(usual_group_size(device)) {}

cl::Buffer ChunkQueue::numbers(std::size_t count) {
  const cl::Buffer buffer(context_, CL_MEM_READ_WRITE, count * sizeof(double));
  clear(buffer, count * sizeof(double));
  return buffer;
}

void ChunkQueue::write(const cl::Buffer& buffer, std::span<const double> column, std::size_t offset) {
  queue_.enqueueWriteBuffer(buffer, CL_FALSE, offset * sizeof(double), column.size_bytes(), column.data());
}

void ChunkQueue::read(const cl::Buffer& buffer, std::span<double> column) {
  read_bytes(buffer, std::as_writable_bytes(column));
}

void ChunkQueue::read_bytes(const cl::Buffer& buffer, std::span<std::byte> bytes) {
  queue_.enqueueReadBuffer(buffer, CL_FALSE, 0, bytes.size(), bytes.data());
}

void ChunkQueue::clear(const cl::Buffer& buffer, std::size_t bytes) {
  queue_.enqueueFillBuffer(buffer, cl_uchar{0}, 0, bytes);
}

void ChunkQueue::show(const cl::Buffer& buffer, std::size_t bytes) {
  void* const memory = queue_.enqueueMapBuffer(buffer, CL_FALSE, CL_MAP_READ, 0, bytes);
  queue_.enqueueUnmapMemObject(buffer, memory);
}

void ChunkQueue::launch(const NamedKernel& kernel, std::size_t work_items, std::size_t local) {
  cl::Event event;
  queue_.enqueueNDRangeKernel(kernel.kernel(), cl::NullRange, cl::NDRange((work_items + local - 1) / local * local),
                              cl::NDRange(local), nullptr, &event);
  kernels_.push_back(std::move(event));
}

std::vector<Running> ChunkQueue::finish() {
  const std::vector<cl::Event> kernels = std::exchange(kernels_, {});  // those of a failure are not asked again
  queue_.finish();
  std::vector<Running> times;
  times.reserve(kernels.size());
  for (const cl::Event& kernel : kernels) {
    times.push_back(
        {kernel.getProfilingInfo<CL_PROFILING_COMMAND_START>(), kernel.getProfilingInfo<CL_PROFILING_COMMAND_END>()});
  }
  return times;
}

void EnclosureColumns::read(ChunkQueue& queue, const std::array<cl::Buffer, 2>& ends, std::size_t size) {
  size_ = size;
  queue.read(ends[0], std::span(los_).first(size));
  queue.read(ends[1], std::span(his_).first(size));
}

void EnclosureColumns::deliver(const Scale& scale, std::vector<Enclosure>& enclosures) const {
  enclosures.resize(size_);
  scale.to_model(std::span(los_).first(size_), std::span(his_).first(size_), enclosures);
}

std::vector<cl::Buffer> windows(const cl::Buffer& buffer, std::size_t count, std::size_t length) {
  if (count == 1) return {buffer};
  cl::Buffer whole = buffer;
  std::vector<cl::Buffer> views;
  for (std::size_t index = 0; index < count; ++index) {
    const cl_buffer_region region{index * length * sizeof(double), length * sizeof(double)};
    views.push_back(whole.createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &region));
  }
  return views;
}

}  // namespace verisq::device
