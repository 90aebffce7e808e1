/// JSON by nlohmann-json, and the messages around it.
#include "host/files/json_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>
#include <verisq/error.hpp>

#include "host/files/words.hpp"

namespace verisq {
namespace {

using Json = nlohmann::json;

constexpr int deepest_level = 100;

[[noreturn]] void refuse(std::string_view name, std::string_view path, std::string_view what) {
  throw Error(ErrorKind::input,
              path.empty() ? fmt::format("{}: {}", name, what) : fmt::format("{}: {}: {}", name, path, what));
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

/// A value as it fits into a message: whole where it is short, without what is nested.
std::string shown(const Json& value) {
  if (value.is_object()) return value.empty() ? "{}" : "{...}";
  const bool nested = value.is_array() && std::any_of(value.begin(), value.end(),
                                                      [](const Json& element) { return element.is_structured(); });
  return nested ? "[...]" : one_line(value);
}

std::string joined(std::string_view path, std::string_view key) {
  const bool plain = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') || c == '_' || c == '-';
  });
  const std::string shown_key = plain ? shortened(std::string(key), 60) : one_line(Json(key));
  return path.empty() ? shown_key : fmt::format("{}.{}", path, shown_key);
}

std::string joined(std::string_view path, std::size_t index) {
  return fmt::format("{}[{}]", path, index);
}

/// Follows the parser's events to know where it is, and refuses keys that the document's tree would silently merge.
class ParserPosition {
 public:
  explicit ParserPosition(std::string_view name) : name_(name) {}

  void follow(int depth, Json::parse_event_t event, const Json& parsed) {
    switch (event) {
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        if (depth >= deepest_level) refuse(name_, path(), fmt::format("nested deeper than {} levels", deepest_level));
        levels_.push_back({event == Json::parse_event_t::array_start, 0, "", {}});
        break;
      case Json::parse_event_t::key: enter(parsed.get<std::string>()); break;
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end: levels_.pop_back(); [[fallthrough]];
      case Json::parse_event_t::value:
        if (!levels_.empty()) ++levels_.back().index;
        break;
    }
  }

  [[nodiscard]] std::string path() const {
    std::string result;
    for (const Level& level : levels_) result = level.array ? joined(result, level.index) : joined(result, level.key);
    return result;
  }

 private:
  struct Level {
    bool array;
    std::size_t index;  // values completed so far
    std::string key;    // the latest
    std::set<std::string> keys;
  };

  void enter(std::string key) {
    Level& level = levels_.back();
    const bool fresh = level.keys.insert(key).second;
    level.key = std::move(key);
    if (!fresh) refuse(name_, path(), "the key appears twice");
  }

  std::string_view name_;
  std::vector<Level> levels_;
};

/// "[json.exception.parse_error.101] parse error at line 2, column 5: ..." from "line" on.
std::string syntax_error(const Json::parse_error& error) {
  const std::string_view text = error.what();
  const std::size_t start = text.find("line ");
  constexpr std::size_t longest = 300;  // the text quotes what was read, which may be all of the file
  return shortened(printable(text.substr(start == std::string::npos ? 0 : start, longest + 1)), longest);
}

/// The number in "... number overflow parsing '1e999'".
std::string overflowing_number(const Json::out_of_range& error) {
  const std::string text = error.what();
  const std::size_t start = text.find('\'');
  const std::size_t end = text.rfind('\'');
  return start < end ? shortened(text.substr(start + 1, end - start - 1), 60) : text;
}

}  // namespace

Json parse_json(std::string_view text, std::string_view name) {
  if (text.empty()) refuse(name, "", "the file is empty");
  ParserPosition position(name);
  const auto follow = [&](int depth, Json::parse_event_t event, Json& parsed) {
    position.follow(depth, event, parsed);
    return true;
  };
  try {
    return Json::parse(text, follow);
  } catch (const Json::parse_error& error) {
    refuse(name, "", syntax_error(error));
  } catch (const Json::out_of_range& error) {
    refuse(name, fmt::format("{} = {}", position.path(), overflowing_number(error)), "not a finite number");
  }
}

void JsonValue::check_keys(std::initializer_list<std::string_view> known) const {
  if (!value_->is_object()) fail("must be an object");
  for (const auto& [key, value] : value_->items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) member(key, value).fail("unknown key");
  }
}

JsonValue JsonValue::at(std::string_view key) const {
  const std::optional<JsonValue> found = find(key);
  if (!found) refuse(name_, joined(path_, key), "missing");
  return *found;
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return member(key, *found);
}

std::size_t JsonValue::size() const {
  if (!value_->is_array()) fail("must be an array");
  return value_->size();
}

JsonValue JsonValue::element(std::size_t index) const {
  return {(*value_)[index], name_, joined(path_, index)};
}

std::string JsonValue::text() const {
  if (!value_->is_string()) fail("must be a string");
  return value_->get<std::string>();
}

double JsonValue::number() const {
  if (!value_->is_number()) fail("must be a number");
  return value_->get<double>();
}

void JsonValue::fail(std::string_view what) const {
  refuse(name_, fmt::format("{} = {}", path_.empty() ? "the document" : path_, shown(*value_)), what);
}

void JsonValue::fail_key(std::string_view what) const {
  refuse(name_, path_, what);
}

JsonValue JsonValue::member(std::string_view key, const Json& value) const {
  return {value, name_, joined(path_, key)};
}

}  // namespace verisq
