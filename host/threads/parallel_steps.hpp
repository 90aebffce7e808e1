/// Independent work on all processors in steps, between which progress is told.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "host/threads/parallel.hpp"
#include "host/threads/seen_interruption.hpp"

namespace verisq {

/// Calls work(i) once for each i below `count`, `step` of them at a time and in any order, and after each step
/// progress(which part of all is done). Once interrupted no further call begins. Returns how many are done: those of
/// all whole steps.
template <class Work, class Progress>
std::size_t in_parallel_steps(std::size_t count, std::size_t step, const SeenInterruption& interrupted,
                              const Progress& progress, const Work& work) {
  std::size_t done = 0;
  std::atomic<bool> is_whole{true};
  while (done < count) {
    const std::size_t now = std::min(step, count - done);
    in_parallel(now, [&](std::size_t i) {
      if (interrupted()) {
        is_whole = false;
      } else {
        work(done + i);
      }
    });
    if (!is_whole) break;
    done += now;
    progress(static_cast<double>(done) / static_cast<double>(count));
  }
  return done;
}

}  // namespace verisq
