/// JSON by nlohmann-json, and the messages around it.
#include "host/files/json_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>

#include "host/files/input_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

using Json = nlohmann::json;

/// An operator of a model's csg takes two levels. Code that reads, copies or destroys such trees recurses: by up to 0.4
/// KiB of stack for each operator, 2 KiB under the address sanitizer (measured). The usual stack has 8 MiB.
constexpr std::size_t deepest_level = 2048;

/// About the memory that nlohmann-json allocates, in bytes: values in their arrays, containers and keys in trees of
/// their own. "{}," has 3 bytes and takes 80; rows of certificates take less than 10 times their text.
constexpr std::size_t of_a_value = 16;
constexpr std::size_t of_an_array = 48;
constexpr std::size_t of_an_object = 64;
constexpr std::size_t of_a_key = 96;
constexpr std::size_t of_a_string = 48;

/// More is refused before the tree is made: a file of 60 MiB must not take gibibytes.
std::size_t most_memory(std::size_t text) {
  return (std::size_t{1} << 24U) + 16 * text;
}

std::string shortened(std::string text, std::size_t longest) {
  if (text.size() <= longest) return text;
  text.resize(longest);
  return text + "...";
}

/// JSON text in ASCII: no line breaks, no control characters.
std::string one_line(const Json& value) {
  return shortened(value.dump(-1, ' ', true), 60);
}

/// A value in the form for a message: whole if it is short, without nested values.
std::string shown(const Json& value) {
  if (value.is_object()) return value.empty() ? "{}" : "{...}";
  const bool nested = value.is_array() && std::any_of(value.begin(), value.end(),
                                                      [](const Json& element) { return element.is_structured(); });
  return nested ? "[...]" : one_line(value);
}

/// A path that is nested deeply keeps its two ends.
std::string shortened_within(std::string text) {
  constexpr std::size_t kept = 100;  // of each end
  if (text.size() <= 2 * kept + 3) return text;
  return text.substr(0, kept) + "..." + text.substr(text.size() - kept);
}

void append_step(std::string& path, std::string_view key) {
  const bool plain = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') || c == '_' || c == '-';
  });
  if (!path.empty()) path += '.';
  path += plain ? shortened(std::string(key), 60) : one_line(Json(key));
}

void append_step(std::string& path, std::size_t index) {
  path += fmt::format("[{}]", index);
}

/// The path that leads from the document to a value in it; empty for the document itself. Searched for, since only
/// messages need it: values that knew their paths would make reading quadratic in how deep they are nested.
std::string path_to(const Json& value, const Json& document) {
  if (&value == &document) return {};
  struct Level {
    const Json* container;
    Json::const_iterator child;
  };
  std::vector<Level> levels{{&document, document.begin()}};
  while (!levels.empty()) {
    const auto [container, child] = levels.back();
    if (child == container->end()) {
      levels.pop_back();
      if (!levels.empty()) ++levels.back().child;
    } else if (&*child == &value) {
      break;
    } else if (child->is_structured()) {
      levels.push_back({&*child, child->begin()});
    } else {
      ++levels.back().child;
    }
  }
  std::string path;
  for (const auto& [container, child] : levels) {
    if (container->is_array()) {
      append_step(path, static_cast<std::size_t>(child - container->begin()));
    } else {
      append_step(path, child.key());
    }
  }
  return path;
}

/// The position of the bracket that opens the first level too deep. Precondition: there is one, and JSON before it.
std::string position_of_too_deep_a_level(std::string_view text) {
  std::size_t line = 1;
  std::size_t line_start = 0;
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '\n') {
      ++line;
      line_start = at + 1;
    } else if (in_string) {
      if (c == '\\') ++at;  // whatever is escaped
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > deepest_level) return fmt::format("line {}, column {}", line, at - line_start + 1);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return fmt::format("line {}", line);
}

/// "[json.exception.parse_error.101] parse error at line 2, column 5: ..." from "line" on.
std::string syntax_error(const Json::exception& error) {
  const std::string_view text = error.what();
  const std::size_t start = text.find("line ");
  constexpr std::size_t longest = 300;  // the text quotes what was read, which may be all of the file
  return shortened(printable(text.substr(start == std::string::npos ? 0 : start, longest + 1)), longest);
}

/// The number in "... number overflow parsing '1e999'".
std::string overflowing_number(const Json::exception& error) {
  const std::string text = error.what();
  const std::size_t start = text.find('\'');
  const std::size_t end = text.rfind('\'');
  return start < end ? shortened(text.substr(start + 1, end - start - 1), 60) : text;
}

/// Follows the parser's events to know its position, and refuses two things that the document's tree would not show.
/// These are keys that it would silently merge, and nesting too deep for its readers.
class StrictEvents final : public nlohmann::json_sax<Json> {
 public:
  StrictEvents(std::string_view text, std::string_view name) : text_(text), name_(name) {}

  bool null() override { return end_value(); }
  bool boolean(bool /*value*/) override { return end_value(); }
  bool number_integer(number_integer_t /*value*/) override { return end_value(); }
  bool number_unsigned(number_unsigned_t /*value*/) override { return end_value(); }
  bool number_float(number_float_t /*value*/, const string_t& /*digits*/) override { return end_value(); }
  bool string(string_t& value) override {
    take(of_a_string + value.size());
    return end_value();
  }
  bool binary(binary_t& /*value*/) override { return end_value(); }
  bool start_object(std::size_t /*size*/) override { return start_level(false); }
  bool start_array(std::size_t /*size*/) override { return start_level(true); }
  bool end_object() override { return end_level(); }
  bool end_array() override { return end_level(); }

  bool key(string_t& key) override {
    Level& level = levels_.back();
    level.key = key;
    if (!level.keys.insert(key).second) refuse_file(name_, path() + ": the key appears twice");
    take(of_a_key + key.size());
    return true;
  }

  bool parse_error(std::size_t /*position*/, const std::string& /*token*/, const Json::exception& error) override {
    constexpr int number_overflow = 406;  // as nlohmann-json numbers its exceptions
    if (error.id != number_overflow) refuse_file(name_, syntax_error(error));
    refuse_file(name_, fmt::format("{} = {}: not a finite number", path(), overflowing_number(error)));
  }

 private:
  struct Level {
    bool array;
    std::size_t index = 0;  // values completed so far
    std::string key = {};   // the latest
    std::set<std::string> keys = {};
  };

  bool start_level(bool array) {
    if (levels_.size() == deepest_level) {
      refuse_file(name_,
                  fmt::format("{}: nested deeper than {} levels: give operators of one kind all their operands at once",
                              position_of_too_deep_a_level(text_), deepest_level));
    }
    levels_.push_back({.array = array});
    take(array ? of_an_array : of_an_object);
    return true;
  }

  bool end_level() {
    levels_.pop_back();
    return end_value();
  }

  bool end_value() {
    take(of_a_value);
    if (!levels_.empty()) ++levels_.back().index;
    return true;
  }

  void take(std::size_t memory) {
    memory_ += memory;
    if (memory_ <= most_memory(text_.size())) return;
    refuse_file(name_, fmt::format("{}: too many values that hold next to nothing: those up to here would take {} MiB "
                                   "of memory, and the file has {} bytes",
                                   path(), memory_ >> 20U, text_.size()));
  }

  [[nodiscard]] std::string path() const {
    std::string result;
    for (const Level& level : levels_) level.array ? append_step(result, level.index) : append_step(result, level.key);
    return shortened_within(std::move(result));
  }

  std::string_view text_;
  std::string_view name_;
  std::vector<Level> levels_;
  std::size_t memory_ = 0;  ///< memory that the tree would take
};

/// For UTF-8, the encoding of JSON. Control characters are those that terminals obey, some of which begin with C2, and
/// those that end a line or reverse the following text: U+061C, U+200E, U+200F, U+2028 to U+202E and U+2066 to U+2069.
bool has_control_characters(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = [&](std::size_t k) { return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0U; };
    if (byte(0) < 0x20 || byte(0) == 0x7f) return true;
    if (byte(0) == 0xc2 && byte(1) < 0xa0) return true;
    if (byte(0) == 0xd8 && byte(1) == 0x9c) return true;
    if (byte(0) != 0xe2) continue;
    if (byte(1) == 0x80 && (byte(2) == 0x8e || byte(2) == 0x8f)) return true;
    if (byte(1) == 0x80 && byte(2) >= 0xa8 && byte(2) <= 0xae) return true;
    if (byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9) return true;
  }
  return false;
}

}  // namespace

// Two passes: a single one, by the parser's callback, looks at all elements of an array after each of them.
Json parse_json(std::string_view text, std::string_view name) {
  if (text.empty()) refuse_file(name, "the file is empty");
  // The parser takes a zero byte for the end of the text.
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
    refuse_file(name, fmt::format("byte {} is 0, which is no JSON", zero));
  if (const std::size_t start = text.find_first_not_of(" \t\r\n"); start != std::string_view::npos) {
    constexpr std::string_view beginnings = "{[\"-0123456789tfn";
    const std::string_view first_line = text.substr(start, text.find_first_of("\r\n", start) - start);
    if (beginnings.find(text[start]) == std::string_view::npos)
      refuse_file(name, fmt::format("begins with {}: no JSON, which models, landmarks and certificates are",
                                    in_quotes(Words(first_line).next())));
  }
  StrictEvents events(text, name);
  Json::sax_parse(text, &events);
  return Json::parse(text);
}

void JsonValue::check_keys(std::initializer_list<std::string_view> known) const {
  if (!value_->is_object()) fail("must be an object");
  for (const auto& [key, value] : value_->items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) within(value).fail("unknown key");
  }
}

JsonValue JsonValue::at(std::string_view key) const {
  const std::optional<JsonValue> found = find(key);
  if (found) return *found;
  std::string missing = path();
  append_step(missing, key);
  refuse_file(name_, shortened_within(std::move(missing)) + ": missing");
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return within(*found);
}

std::size_t JsonValue::size() const {
  if (!value_->is_array()) fail("must be an array");
  return value_->size();
}

JsonValue JsonValue::element(std::size_t index) const {
  return within((*value_)[index]);
}

JsonValue JsonValue::at_place(std::string_view place) const {
  const std::size_t end = place.find_first_of(".[", 1);
  const std::string_view step = place.substr(0, end);
  std::size_t index = 0;
  const bool is_index = step.starts_with('[');
  if (is_index) std::from_chars(step.data() + 1, step.data() + step.size(), index);
  const JsonValue found = is_index ? element(index) : at(step.starts_with('.') ? step.substr(1) : step);
  return end == std::string_view::npos ? found : found.at_place(place.substr(end));
}

std::string JsonValue::text() const {
  if (!value_->is_string()) fail("must be a string");
  return value_->get<std::string>();
}

std::string JsonValue::line() const {
  const std::string line = text();
  if (has_control_characters(line)) fail("must have no control characters");
  return line;
}

std::string JsonValue::name() const {
  if (text().empty()) fail("must not be empty");
  return line();
}

double JsonValue::number() const {
  if (!value_->is_number()) fail("must be a number");
  return value_->get<double>();
}

double JsonValue::number_or_infinity() const {
  if (*value_ == "inf") return infinity;
  if (*value_ == "-inf") return -infinity;
  if (!value_->is_number()) fail("must be a number, \"inf\" or \"-inf\"");
  return number();
}

void JsonValue::fail(std::string_view what) const {
  const std::string where = value_ == document_ ? "the document" : shortened_within(path());
  refuse_file(name_, fmt::format("{} = {}: {}", where, shown(*value_), what));
}

std::string JsonValue::path() const {
  return path_to(*value_, *document_);
}

JsonValue JsonValue::within(const Json& value) const {
  JsonValue result = *this;
  result.value_ = &value;
  return result;
}

}  // namespace verisq
