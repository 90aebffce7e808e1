/// nlohmann's library prints.
#include "host/command_line/json_value.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace verisq::command_line {

using Printed = nlohmann::ordered_json;

struct JsonPrinter {
  [[nodiscard]] static Printed printed(const JsonValue& value) { return std::visit(JsonPrinter{}, value.value_); }

  // Names of files and devices are bytes of the system, not always UTF-8: replaced rather than refused.
  [[nodiscard]] static std::string text(const JsonValue& value, int indentation) {
    return printed(value).dump(indentation, ' ', false, Printed::error_handler_t::replace);
  }

  Printed operator()(std::monostate) const { return nullptr; }
  Printed operator()(const auto& value) const { return value; }
  Printed operator()(const JsonValue::Array& values) const {
    Printed array = Printed::array();
    for (const JsonValue& value : values) array.push_back(printed(value));
    return array;
  }
  Printed operator()(const JsonValue::Members& members) const {
    Printed object = Printed::object();
    for (const auto& [name, value] : members) object[name] = printed(value);
    return object;
  }
};

JsonValue::JsonValue(const Enclosure& enclosure) : JsonValue(Members{{"lo", enclosure.lo}, {"hi", enclosure.hi}}) {}

std::string JsonValue::text() const {
  return JsonPrinter::text(*this, -1);
}

std::string JsonValue::indented_text() const {
  return JsonPrinter::text(*this, 2);
}

void JsonObject::set(const std::string& name, JsonValue value) {
  const auto found = std::ranges::find(members(), name, &Members::value_type::first);
  if (found == members().end()) {
    members().emplace_back(name, std::move(value));
  } else {
    found->second = std::move(value);
  }
}

}  // namespace verisq::command_line
