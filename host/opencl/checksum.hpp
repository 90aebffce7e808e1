/// What tells damaged files, and one device program from another.
#pragma once

#include <cstdint>
#include <string_view>

namespace verisq::device {

/// CRC-64/XZ (the polynomial of ECMA-182), the same in every build. Finds every damage within 64 consecutive bits, all
/// else but for one case in 2^64; against forgery it is of no use.
[[nodiscard]] std::uint64_t checksum(std::string_view bytes);

}  // namespace verisq::device
