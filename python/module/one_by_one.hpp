/// Work that the library would share among threads, on the caller's alone.
#pragma once

#include <cstddef>
#include <functional>

namespace verisq::python {

inline void one_by_one(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

}  // namespace verisq::python
