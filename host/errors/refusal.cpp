/// This file implements refusal.hpp.
#include "host/errors/refusal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace verisq {
namespace {

constexpr std::uint32_t no_character = 0xffffffff;
constexpr std::uint32_t ellipsis = 0x2026;
constexpr std::size_t most_accents = 2;  // Vietnamese has as many on a letter
constexpr std::size_t most_of_a_list = 8;
constexpr std::size_t longest_sentence = 4000;

/// First and last character.
struct Range {
  std::uint32_t first;
  std::uint32_t last;
};

/// Letters, digits and signs that print from left to right and take a place. Excluded are blanks, marks that look like
/// the ones around a quotation, signs that change how others print, and letters that are invisible (Hangul's fillers).
constexpr std::array shown_as_they_are{
    Range{0x21, 0x7e},     Range{0xa1, 0xa7},     Range{0xa9, 0xaa},     Range{0xac, 0xac},     Range{0xae, 0xba},
    Range{0xbc, 0x2af},    Range{0x386, 0x3ff},   Range{0x400, 0x482},   Range{0x48a, 0x52f},   Range{0x1e00, 0x1eff},
    Range{0x2010, 0x2015}, Range{0x2018, 0x2019}, Range{0x2070, 0x2071}, Range{0x2074, 0x208e}, Range{0x2212, 0x2212},
    Range{0x2264, 0x2265}, Range{0x3001, 0x3002}, Range{0x3005, 0x3007}, Range{0x3041, 0x3096}, Range{0x30a1, 0x30fe},
    Range{0x3400, 0x4dbf}, Range{0x4e00, 0x9fff}, Range{0xac00, 0xd7a3},
};

constexpr Range accents{0x300, 0x333};        // above and below a letter; those from 0x334 on strike it out
constexpr std::uint32_t first_wide = 0x1100;  // characters from here on take two columns, or are taken to

constexpr std::array units_of_length{"m", "dm", "cm", "mm", "um", "µm", "μm", "nm", "km", "in", "inch", "ft"};

bool is_within(std::uint32_t character, const Range& range) {
  return range.first <= character && character <= range.last;
}

bool is_shown(std::uint32_t character) {
  return std::ranges::any_of(shown_as_they_are, [&](const Range& range) { return is_within(character, range); });
}

/// A character, or a byte that begins none.
struct Sign {
  std::uint32_t character;  ///< `no_character` of such a byte
  std::string_view bytes;
};

/// RFC 3629: neither overlong forms, nor surrogates, nor numbers above 10FFFF are characters. Precondition: not empty.
Sign first_sign(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const Sign no_sign{no_character, text.substr(0, 1)};
  const std::uint32_t head = byte(0);
  if (head < 0x80) return {head, text.substr(0, 1)};
  const std::size_t length = head < 0xc2 ? 0 : head < 0xe0 ? 2 : head < 0xf0 ? 3 : head < 0xf5 ? 4 : 0;
  if (length == 0 || text.size() < length) return no_sign;
  std::uint32_t character = head & (0x7fU >> length);
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xc0U) != 0x80U) return no_sign;
    character = character << 6U | (byte(k) & 0x3fU);
  }
  constexpr std::array<std::uint32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = is_within(character, {0xd800, 0xdfff});
  if (character < smallest[length] || is_surrogate || character > 0x10ffff) return no_sign;
  return {character, text.substr(0, length)};
}

std::string escaped(const Sign& sign) {
  if (sign.character == no_character) return fmt::format("\\x{:02x}", static_cast<unsigned char>(sign.bytes.front()));
  return sign.character < 0x80 ? fmt::format("\\x{:02x}", sign.character) : fmt::format("\\u{{{:x}}}", sign.character);
}

/// The text that stands for one sign, and how many columns it takes.
struct Piece {
  std::string text;
  std::size_t columns;
};

/// The signs before decide whether a blank or an accent is shown.
class Shown {
 public:
  /// `mark` is that of the quotation; 0 for a sentence, whose marks and blanks are its own.
  explicit Shown(char mark) : mark_(mark) {}

  Piece operator()(const Sign& sign, bool is_last) {
    const std::uint32_t character = sign.character;
    const bool after_letter = after_letter_;
    const std::size_t accents_before = accents_;
    after_letter_ = false;
    accents_ = 0;
    if (character == ' ' && (mark_ == 0 || (!after_blank_ && !is_last))) return blank();
    after_blank_ = false;
    if (mark_ != 0 && (character == '\\' || character == static_cast<unsigned char>(mark_)))
      return {fmt::format("\\{}", static_cast<char>(character)), 2};
    if (is_within(character, accents) && after_letter && accents_before < most_accents) {
      after_letter_ = true;
      accents_ = accents_before + 1;
      return {std::string(sign.bytes), 0};
    }
    const bool is_own = mark_ == 0 && character == ellipsis;
    if (!is_own && !is_shown(character)) {
      std::string text = escaped(sign);
      const std::size_t columns = text.size();
      return {std::move(text), columns};
    }
    after_letter_ = character >= 'A';
    return {std::string(sign.bytes), character < first_wide || is_within(character, {0x1e00, 0x2fff}) ? 1U : 2U};
  }

 private:
  Piece blank() {
    after_blank_ = true;
    return {" ", 1};
  }

  char mark_;
  bool after_blank_ = true;  // the first sign must be no blank
  bool after_letter_ = false;
  std::size_t accents_ = 0;
};

/// Nothing between the displayable ends is ever read. A column takes at most seven bytes: a letter of three and two
/// accents.
std::string ends_of(std::string_view text, std::size_t longest) {
  const std::size_t kept = 8 * longest;
  if (text.size() <= 2 * kept) return std::string(text);
  return std::string(text.substr(0, kept)).append(text.substr(text.size() - kept));
}

/// Front to back, and how many columns they take in all.
std::pair<std::vector<Piece>, std::size_t> pieces_of(std::string_view text, char mark) {
  std::vector<Piece> pieces;
  std::size_t columns = 0;
  Shown show(mark);
  while (!text.empty()) {
    const Sign sign = first_sign(text);
    text.remove_prefix(sign.bytes.size());
    pieces.push_back(show(sign, text.empty()));
    columns += pieces.back().columns;
  }
  return {std::move(pieces), columns};
}

std::string shown(std::string_view text, char mark, std::size_t longest) {
  const std::string ends = ends_of(text, longest);
  const auto [pieces, columns] = pieces_of(ends, mark);
  std::string front;
  if (columns <= longest) {
    for (const Piece& piece : pieces) front += piece.text;
    return front;
  }
  std::size_t used = 1;  // by the ellipsis
  for (auto piece = pieces.begin(); used + piece->columns <= longest / 3; ++piece) {
    used += piece->columns;
    front += piece->text;
  }
  std::string back;
  for (auto piece = pieces.rbegin(); used + piece->columns <= longest; ++piece) {
    used += piece->columns;
    back.insert(0, piece->text);
  }
  return front + "…" + back;
}

}  // namespace

std::string quotation(std::string_view text, char mark) {
  return mark + shown(text, mark, longest_quotation) + mark;
}

std::string quotation(std::span<const std::string> texts) {
  std::string result;
  for (std::size_t i = 0; i < std::min(texts.size(), most_of_a_list); ++i)
    result += (i == 0 ? "" : ", ") + quotation(texts[i]);
  if (texts.size() > most_of_a_list) result += fmt::format(" and {} more", texts.size() - most_of_a_list);
  return result;
}

bool is_plain(std::string_view text) {
  return text.size() <= 4 * longest_quotation && quotation(text) == fmt::format("\"{}\"", text);
}

std::string on_one_line(std::string_view sentence) {
  return shown(sentence, 0, longest_sentence);
}

std::string units_behind(std::string_view units, int power) {
  if (units.empty()) return {};
  const bool is_length = std::ranges::find(units_of_length, units) != units_of_length.end();
  const std::string words = is_length ? std::string(units) : quotation(units);
  return power == 1 ? " " + words : fmt::format(" {}^{}", words, power);
}

}  // namespace verisq
