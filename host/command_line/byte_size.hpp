/// Options whose values are sizes of files: --max-output.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace verisq::command_line {

/// Bytes: "500000", "250MB" or "1.5 GiB"; units kB, MB, GB, TB are powers of 1000, KiB, MiB, GiB, TiB of 1024, in
/// capitals or not. Throws Error(input) that begins with `option` for anything else, and for sizes of 2^63 bytes and
/// more.
[[nodiscard]] std::uint64_t parse_byte_size(std::string_view option, std::string_view text);

/// "2.95 GB": three digits, in powers of 1000.
[[nodiscard]] std::string byte_size_text(std::uint64_t bytes);

}  // namespace verisq::command_line
