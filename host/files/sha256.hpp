/// SHA-256 (FIPS 180-4), by which people and certificates tell which file an answer is about.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace verisq {

/// Own code and no library: a program that checks certificates would otherwise be linked to one that is twenty times
/// its size. No proof rests on it: what is proven is proven of the model that was read, whatever its digest.
class Sha256 {
 public:
  /// Takes the next bytes.
  void add(std::span<const std::byte> bytes);

  /// Of all bytes so far, 64 hexadecimal digits in small letters. Nothing may be added after it.
  [[nodiscard]] std::string digest();

 private:
  static constexpr std::size_t block_size = 64;

  void take_block();

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, block_size> block_{};
  std::uint64_t bytes_ = 0;
};

/// Of all these bytes.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace verisq
