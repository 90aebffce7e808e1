/// A column of numbers as text: base64 of its little-endian bytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "host/files/byte_order.hpp"
#include "host/report/base64.hpp"

namespace verisq::report {

template <class Number>
[[nodiscard]] std::string column_text(std::vector<Number> numbers) {
  if constexpr (sizeof(Number) > 1) {
    std::ranges::transform(numbers, numbers.begin(), [](Number number) { return in_little_endian(number); });
  }
  return base64(std::as_bytes(std::span(numbers)));
}

}  // namespace verisq::report
