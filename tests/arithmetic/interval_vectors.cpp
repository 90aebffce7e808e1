/// Tokens first, then statements: `testcase name { statement... }` with comments of C++.
#include "tests/arithmetic/interval_vectors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "verisq/enclosure.hpp"

namespace verisq::testing {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A token ends before these and before white space; each is a token of its own.
constexpr std::string_view punctuation = "{}=;,";

class Reader {
 public:
  Reader(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {}

  [[nodiscard]] std::vector<IntervalVector> vectors() {
    std::vector<IntervalVector> result;
    while (!token().empty()) {
      expect("testcase");
      advance();  // its name
      expect("{");
      while (token() != "}") result.push_back(statement());
      advance();
    }
    return result;
  }

 private:
  [[nodiscard]] IntervalVector statement() {
    IntervalVector vector{fmt::format("{}:{}", name_, line()), advance(), {}, {}};
    while (token() != "=") vector.operands.push_back(literal());
    advance();
    while (token() != ";" && token() != "signal") vector.results.push_back(literal());
    if (token() == "signal") {
      advance();
      advance();  // the exception's name
    }
    expect(";");
    if (vector.operands.empty() || vector.results.empty()) fail("a vector without operands or results");
    return vector;
  }

  [[nodiscard]] Literal literal() {
    const std::string text = advance();
    if (text.empty() || text == "}" || text == "testcase") fail("an unfinished vector");
    if (text == "{") {
      while (token() != "}" && !token().empty()) advance();
      expect("}");
      return {Literal::Kind::other, nan, nan, false};
    }
    if (text.front() == '[') return interval(text);
    if (const auto value = number(text)) return {Literal::Kind::number, *value, *value, false};
    return {Literal::Kind::other, nan, nan, false};
  }

  /// "[lower, upper]", "[empty]", "[entire]" or "[nai]", and maybe "_decoration".
  [[nodiscard]] Literal interval(const std::string& text) const {
    const std::size_t closing = text.find(']');
    const std::string inside = without_spaces(text.substr(1, closing - 1));
    const bool decorated = closing + 1 < text.size();
    if (decorated && text[closing + 1] != '_') fail("a decoration without _: " + text);
    if (inside == "nai") return {Literal::Kind::not_an_interval, nan, nan, decorated};
    if (inside == "empty") return {Literal::Kind::interval, nan, nan, decorated};
    if (inside == "entire") return {Literal::Kind::interval, -infinity, infinity, decorated};
    const std::size_t comma = inside.find(',');
    if (comma == std::string::npos) fail("not an interval: " + text);
    const auto lower = number(inside.substr(0, comma));
    const auto upper = number(inside.substr(comma + 1));
    if (!lower || !upper || !(*lower <= *upper)) fail("not an interval: " + text);
    return {Literal::Kind::interval, *lower, *upper, decorated};
  }

  [[nodiscard]] static std::optional<double> number(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || end != text.c_str() + text.size()) return std::nullopt;
    return value;
  }

  [[nodiscard]] static std::string without_spaces(std::string text) {
    std::erase_if(text, [](unsigned char c) { return std::isspace(c) != 0; });
    return text;
  }

  // ---------------------------------------------------------------- tokens

  /// The next one, left in place; empty at the end.
  [[nodiscard]] std::string token() {
    skip_space_and_comments();
    if (position_ == text_.size()) return {};
    return text_.substr(position_, length_of_token());
  }

  std::string advance() {
    std::string result = token();
    position_ += result.size();
    return result;
  }

  void expect(std::string_view expected) {
    const std::string found = advance();
    if (found != expected) fail(fmt::format(R"("{}" expected, found "{}")", expected, found));
  }

  [[nodiscard]] std::size_t length_of_token() const {
    const char first = text_[position_];
    if (punctuation.find(first) != std::string_view::npos) return 1;
    if (first == '"') return through('"', position_ + 1) - position_;
    std::size_t end = first == '[' ? through(']', position_) : position_;
    while (end < text_.size() && std::isspace(static_cast<unsigned char>(text_[end])) == 0 &&
           punctuation.find(text_[end]) == std::string_view::npos) {
      ++end;
    }
    return end - position_;
  }

  /// The place behind the next `closing`.
  [[nodiscard]] std::size_t through(char closing, std::size_t from) const {
    const std::size_t found = text_.find(closing, from);
    if (found == std::string::npos) fail(fmt::format("{} is missing", closing));
    return found + 1;
  }

  void skip_space_and_comments() {
    const auto starts = [this](std::string_view what) { return text_.compare(position_, what.size(), what) == 0; };
    while (position_ < text_.size()) {
      if (starts("//")) {
        position_ = std::min(text_.find('\n', position_), text_.size());
      } else if (starts("/*")) {
        const std::size_t end = text_.find("*/", position_);
        if (end == std::string::npos) fail("*/ is missing");
        position_ = end + 2;
      } else if (std::isspace(static_cast<unsigned char>(text_[position_])) != 0) {
        ++position_;
      } else {
        return;
      }
    }
  }

  /// Of the next token.
  [[nodiscard]] std::ptrdiff_t line() {
    skip_space_and_comments();
    return 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(position_), '\n');
  }

  [[noreturn]] void fail(const std::string& what) const {
    const auto here = text_.begin() + static_cast<std::ptrdiff_t>(position_);
    throw std::runtime_error(fmt::format("{}:{}: {}", name_, 1 + std::count(text_.begin(), here, '\n'), what));
  }

  std::string text_;
  std::string name_;
  std::size_t position_ = 0;
};

}  // namespace

bool Literal::is_empty() const {
  return kind == Kind::interval && std::isnan(lower);
}

std::vector<IntervalVector> read_interval_vectors(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  return Reader({std::istreambuf_iterator<char>(stream), {}}, file.filename().string()).vectors();
}

}  // namespace verisq::testing
