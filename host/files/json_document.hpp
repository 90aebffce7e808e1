/// Strict reading of JSON: every value can be named in a message, every key appears once, every number is finite.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace verisq {

/// Parses a whole document. Throws Error(input), one line that starts with `name`. Syntax errors, and nesting deeper
/// than 2048 levels (so that readers may recurse), come with line and column. Duplicate keys and numbers beyond
/// binary64 come with the path of the key, as does the value up to which a tree would take more than 16 MiB and 16
/// times the text. Takes time and memory in proportion to the text.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, std::string_view name);

/// A value of a parsed document. Every check throws Error(input): "NAME: PATH = VALUE: what is wrong", where the path
/// is like "primitives[2].superquadric.exponents[0]", a long one without its middle. The document and its name must
/// outlive it.
class JsonValue {
 public:
  JsonValue(const nlohmann::json& document, std::string_view name)
      : value_(&document), document_(&document), name_(name) {}

  [[nodiscard]] const nlohmann::json& json() const { return *value_; }

  /// Fails unless this is an object that has no other keys.
  void check_keys(std::initializer_list<std::string_view> known) const;

  /// The value of a key of this object; fails when it is missing.
  [[nodiscard]] JsonValue at(std::string_view key) const;
  /// Nothing if the key is missing.
  [[nodiscard]] std::optional<JsonValue> find(std::string_view key) const;
  /// The number of elements; fails unless this is an array.
  [[nodiscard]] std::size_t size() const;
  /// Precondition: index < size().
  [[nodiscard]] JsonValue element(std::size_t index) const;

  /// The value at "primitives[2].pose", a path in this one; fails where a step is missing.
  [[nodiscard]] JsonValue at_place(std::string_view place) const;

  [[nodiscard]] std::string text() const;  ///< fails unless this is a string
  /// A string that is displayed: fails unless it is of one line, without control characters.
  [[nodiscard]] std::string line() const;
  [[nodiscard]] std::string name() const;  ///< like `line`, and not empty
  [[nodiscard]] double number() const;     ///< fails unless this is a number
  /// The strings "inf" and "-inf", too: JSON has no infinite numbers.
  [[nodiscard]] double number_or_infinity() const;

  [[noreturn]] void fail(std::string_view what) const;

 private:
  [[nodiscard]] std::string path() const;
  /// Another value of the document.
  [[nodiscard]] JsonValue within(const nlohmann::json& value) const;

  const nlohmann::json* value_;
  const nlohmann::json* document_;
  std::string_view name_;
};

}  // namespace verisq
