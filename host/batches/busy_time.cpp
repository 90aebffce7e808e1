/// This file implements the union of intervals of time.
#include "host/batches/busy_time.hpp"

#include <algorithm>

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

}  // namespace verisq::device
