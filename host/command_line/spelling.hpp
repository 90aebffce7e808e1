/// What somebody who typed an unknown word may have meant.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace verisq::command_line {

/// The known word that is nearest to `word`: fewest letters inserted, left out, replaced or swapped with their
/// neighbours (optimal string alignment), at most one for every three letters of `word`; else the only one that
/// begins with `word`, or that `word` begins with. Nothing where none is so near.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known);

}  // namespace verisq::command_line
