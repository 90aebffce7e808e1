/// Covers of certificates as text: hexadecimal digits of four bits each (docs/formats.md §5).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace verisq {

/// The first bit is the highest of the first digit; the last digit is filled up with 0.
[[nodiscard]] std::string digits_of_cover(const std::vector<bool>& cover);

/// Nothing unless the text is the digits of one whole cover, whose cells say themselves where it ends.
[[nodiscard]] std::optional<std::vector<bool>> cover_from(std::string_view text);

/// Whether the cells end exactly where the bits do.
[[nodiscard]] bool is_whole_cover(const std::vector<bool>& cover);

}  // namespace verisq
