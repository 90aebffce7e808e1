/// Runs independent shards of a long test on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <thread>
#include <vector>

namespace verisq::oracle {

/// Calls `work(i)` once for every i in [0, count), from as many threads as there are cores; rethrows the first
/// exception. `work` must be safe to call from several threads at once.
template <class Work>
void in_parallel(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto drain = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::future<void>> threads;
  for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t) {
    threads.push_back(std::async(std::launch::async, drain));
  }
  for (std::future<void>& thread : threads) thread.get();
}

}  // namespace verisq::oracle
