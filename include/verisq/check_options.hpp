/// How a certificate of many parts is worked through.
#pragma once

#include <cstddef>
#include <functional>

namespace verisq {

struct CheckOptions {
  /// Calls work(i) once for each i below `count`, in any order, by several threads.
  /// Unless given, one after the other.
  std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)> in_parallel =
      [](std::size_t count, const std::function<void(std::size_t)>& work) {
        for (std::size_t i = 0; i < count; ++i) work(i);
      };
  std::function<bool()> interrupted = [] { return false; };  ///< polled by any thread; once true it stays so
  std::function<void(double)> progress = [](double) {};      ///< how much is done, from 0 to 1
};

}  // namespace verisq
