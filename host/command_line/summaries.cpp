/// This file implements summaries.hpp.
#include "host/command_line/summaries.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <verisq/model.hpp>

namespace verisq::command_line {

using Json = nlohmann::ordered_json;

struct JsonValue::Content {
  Json json;

  // Names of files and devices are bytes of the system, not always UTF-8: replaced rather than refused. In ASCII, since
  // a terminal obeys characters that JSON need not escape.
  [[nodiscard]] std::string text(int indentation) const {
    return json.dump(indentation, ' ', true, Json::error_handler_t::replace);
  }
};

JsonValue::JsonValue() : content_(new Content{nullptr}) {}
JsonValue::JsonValue(bool value) : content_(new Content{value}) {}
JsonValue::JsonValue(double value) : content_(new Content{value}) {}
JsonValue::JsonValue(Whole number) : content_(new Content{number.value}) {}
JsonValue::JsonValue(Natural number) : content_(new Content{number.value}) {}
JsonValue::JsonValue(const char* value) : content_(new Content{value}) {}
JsonValue::JsonValue(std::string_view value) : content_(new Content{value}) {}
JsonValue::JsonValue(const std::string& value) : content_(new Content{value}) {}
JsonValue::JsonValue(const Enclosure& enclosure)
    : content_(new Content{{{"lo", enclosure.lo}, {"hi", enclosure.hi}}}) {}
JsonValue::JsonValue(const Pose& pose)
    : content_(new Content{{{"translation", pose.translation}, {"quaternion", pose.quaternion}}}) {}

JsonValue::JsonValue(const Array& values) : content_(new Content{Json::array()}) {
  for (const JsonValue& value : values) content_->json.push_back(value.content_->json);
}

JsonValue::JsonValue(const JsonValue& other) : content_(new Content(*other.content_)) {}
JsonValue::JsonValue(JsonValue&& other) noexcept = default;
JsonValue& JsonValue::operator=(JsonValue&& other) noexcept = default;
JsonValue::~JsonValue() = default;

JsonValue& JsonValue::operator=(const JsonValue& other) {
  content_ = std::make_unique<Content>(*other.content_);
  return *this;
}

std::string JsonValue::text() const {
  return content_->text(-1);
}

std::string JsonValue::indented_text() const {
  return content_->text(2);
}

JsonObject::JsonObject(std::initializer_list<JsonMember> members) {
  content_->json = Json::object();
  for (const auto& [name, value] : members) set(name, value);
}

void JsonObject::set(std::string_view name, const JsonValue& value) {
  content_->json[std::string(name)] = value.content_->json;
}

}  // namespace verisq::command_line

// After <cstdio>, which makes MPFR declare its formatted output.
#include <mpfr.h>

#include <array>

namespace verisq::command_line {
namespace {

std::string formatted(const char* format, int digits, double x) {
  mpfr_t number;
  mpfr_init2(number, 53);
  mpfr_set_d(number, x + 0.0, MPFR_RNDN);  // -0 + 0 is 0
  std::array<char, 64> text{};
  mpfr_snprintf(text.data(), text.size(), format, digits, number);
  mpfr_clear(number);
  return text.data();
}

}  // namespace

std::string outward_digits(const Enclosure& enclosure, int digits) {
  const std::string lower = lower_digits(enclosure.lo, digits);
  const std::string upper = upper_digits(enclosure.hi, digits);
  return lower == upper ? lower : fmt::format("[{}, {}]", lower, upper);
}

std::string lower_digits(double x, int digits) {
  return formatted("%.*RDg", digits, x);
}

std::string upper_digits(double x, int digits) {
  return formatted("%.*RUg", digits, x);
}

}  // namespace verisq::command_line
