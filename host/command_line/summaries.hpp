/// The parts of summaries: JSON, digits rounded outward, words for the elements of maps.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/map_file.hpp>

namespace verisq {

// The JSON of summaries: values as the commands state them, and their text. Only summaries.cpp prints it.

struct Pose;  // all of model.hpp would bring its Model beside that of the stance
}  // namespace verisq

namespace verisq::command_line {

/// Null, a truth value, a number, a text, an array or an object (below).
class JsonValue {
 public:
  using Array = std::vector<JsonValue>;

  JsonValue();
  JsonValue(bool value);
  JsonValue(double value);
  template <std::signed_integral Number>
  JsonValue(Number value) : JsonValue(Whole{value}) {}
  template <std::unsigned_integral Number>
  JsonValue(Number value) : JsonValue(Natural{value}) {}
  JsonValue(const char* value);
  JsonValue(std::string_view value);
  JsonValue(const std::string& value);
  /// {"lo": ..., "hi": ...}.
  JsonValue(const Enclosure& enclosure);
  /// {"translation": [...], "quaternion": [...]}.
  JsonValue(const Pose& pose);
  JsonValue(const Array& values);
  /// An array of the container's elements.
  template <class Container>
  requires requires(const Container& container) { JsonValue(*container.begin()); }
  JsonValue(const Container& values) : JsonValue(Array(values.begin(), values.end())) {}
  /// Null if there is no value.
  template <class Value>
  JsonValue(const std::optional<Value>& value) : JsonValue(value ? JsonValue(*value) : JsonValue()) {}

  JsonValue(const JsonValue& other);
  JsonValue(JsonValue&& other) noexcept;
  JsonValue& operator=(const JsonValue& other);
  JsonValue& operator=(JsonValue&& other) noexcept;
  ~JsonValue();

  /// One line; numbers that JSON has not are null, bytes that are no UTF-8 are replaced.
  [[nodiscard]] std::string text() const;
  /// The same in indented lines.
  [[nodiscard]] std::string indented_text() const;

 private:
  friend class JsonObject;

  struct Content;
  struct Whole {
    std::int64_t value;
  };
  struct Natural {
    std::uint64_t value;
  };

  explicit JsonValue(Whole number);
  explicit JsonValue(Natural number);

  std::unique_ptr<Content> content_;
};

struct JsonMember {
  std::string_view name;
  JsonValue value;
};

/// Its members keep their order: JsonObject{{"points", 3}, {"distance", Enclosure{1.0, 2.0}}}.
class JsonObject : public JsonValue {
 public:
  JsonObject() : JsonObject(std::initializer_list<JsonMember>{}) {}
  JsonObject(std::initializer_list<JsonMember> members);

  /// Behind the others, or in place of the member of this name.
  void set(std::string_view name, const JsonValue& value);
};

// Decimal digits of enclosures, rounded outward: the printed interval contains the proven one.

/// "[lo, hi]" with so many significant digits each, lo rounded down and hi up; a single number if the digits represent
/// it.
[[nodiscard]] std::string outward_digits(const Enclosure& enclosure, int digits = 10);

/// Significant digits of a number that is no larger.
[[nodiscard]] std::string lower_digits(double x, int digits = 10);

/// Significant digits of a number that is no smaller.
[[nodiscard]] std::string upper_digits(double x, int digits = 10);

// The names, in summaries and messages, of the elements of a map.

[[nodiscard]] constexpr std::string_view singular(MapElements elements) {
  switch (elements) {
    case MapElements::vertices: return "point";
    case MapElements::triangles: return "triangle";
    case MapElements::poses: break;
  }
  return "pose";
}

[[nodiscard]] constexpr std::string_view plural(MapElements elements) {
  switch (elements) {
    case MapElements::vertices: return "points";
    case MapElements::triangles: return "triangles";
    case MapElements::poses: break;
  }
  return "poses";
}

/// Behind the smallest distance of a map: between points the surface may be nearer.
[[nodiscard]] constexpr std::string_view whose_distance(MapElements elements) {
  return elements == MapElements::vertices ? " of these points, not of what lies between" : "";
}

}  // namespace verisq::command_line
