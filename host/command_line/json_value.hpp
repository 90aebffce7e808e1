/// The JSON of summaries: values as the commands state them, and their text. What prints it is in json_value.cpp alone.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>
#include <verisq/enclosure.hpp>

namespace verisq::command_line {

/// Null, a truth value, a number, a text, an array, or an object whose members keep their order:
/// JsonObject{{"points", 3}, {"distance", Enclosure{1.0, 2.0}}}.
class JsonValue {
 public:
  using Array = std::vector<JsonValue>;
  using Members = std::vector<std::pair<std::string, JsonValue>>;

  JsonValue() = default;
  JsonValue(bool value) : value_(value) {}
  JsonValue(double value) : value_(value) {}
  template <std::signed_integral Number>
  JsonValue(Number value) : value_(std::int64_t{value}) {}
  template <std::unsigned_integral Number>
  requires(!std::same_as<Number, bool>) JsonValue(Number value) : value_(std::uint64_t{value}) {}
  JsonValue(const char* value) : value_(std::string(value)) {}
  JsonValue(std::string_view value) : value_(std::string(value)) {}
  JsonValue(const std::string& value) : value_(value) {}
  /// Null where there is none.
  template <class Value>
  JsonValue(const std::optional<Value>& value) : JsonValue(value ? JsonValue(*value) : JsonValue()) {}
  /// {"lo": ..., "hi": ...}.
  JsonValue(const Enclosure& enclosure);
  JsonValue(Array values) : value_(std::move(values)) {}
  /// An array of what these are.
  template <std::ranges::input_range Range>
  requires(!std::convertible_to<const Range&, std::string_view> && !std::same_as<Range, Array>)
      JsonValue(const Range& values)
      : value_(Array(std::ranges::begin(values), std::ranges::end(values))) {}

  /// One line; numbers that JSON has not are null, bytes that are no UTF-8 are replaced.
  [[nodiscard]] std::string text() const;
  /// The same in indented lines.
  [[nodiscard]] std::string indented_text() const;

 protected:
  explicit JsonValue(Members members) : value_(std::move(members)) {}
  [[nodiscard]] Members& members() { return std::get<Members>(value_); }

 private:
  friend struct JsonPrinter;

  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Array, Members> value_;
};

class JsonObject : public JsonValue {
 public:
  JsonObject() : JsonValue(Members{}) {}
  JsonObject(std::initializer_list<Members::value_type> members) : JsonValue(Members(members)) {}

  /// Behind the others, or in place of the member of this name.
  void set(const std::string& name, JsonValue value);
};

}  // namespace verisq::command_line
