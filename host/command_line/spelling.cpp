/// Optimal string alignment by rows of its table, as in Wagner and Fischer, "The string-to-string correction problem".
#include "host/command_line/spelling.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace verisq::command_line {
namespace {

/// Of the first i letters of `a` and the first j of `b`, row after row.
std::size_t corrections(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// Dashes are no letters.
std::string_view letters_of(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

}  // namespace

std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known) {
  const std::string_view letters = letters_of(word);
  if (letters.size() < 2) return std::nullopt;
  std::optional<std::string> nearest;
  std::size_t fewest = std::max<std::size_t>(letters.size() / 3, 1) + 1;
  std::vector<std::string> begun;
  for (const std::string& candidate : known) {
    const std::string_view other = letters_of(candidate);
    if (other.size() < 2) continue;
    if (const std::size_t count = corrections(letters, other); count < fewest) {
      fewest = count;
      nearest = candidate;
    }
    if (other.starts_with(letters) || letters.starts_with(other)) begun.push_back(candidate);
  }
  if (!nearest && begun.size() == 1) return begun.front();
  return nearest;
}

}  // namespace verisq::command_line
