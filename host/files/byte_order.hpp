/// Numbers from and to bytes of a stated order, whatever the order of this machine.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace verisq {

template <class Number>
requires std::is_arithmetic_v<Number>
[[nodiscard]] Number reversed_bytes(Number value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(Number)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Number>(bytes);
}

/// The number stored in `order` at `bytes`, which need not be aligned.
template <class Number>
[[nodiscard]] Number number_from(const char* bytes, std::endian order) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return order == std::endian::native ? value : reversed_bytes(value);
}

/// The value whose bytes on this machine are those of `value` in little-endian order.
template <class Number>
[[nodiscard]] Number in_little_endian(Number value) {
  return std::endian::native == std::endian::little ? value : reversed_bytes(value);
}

}  // namespace verisq
