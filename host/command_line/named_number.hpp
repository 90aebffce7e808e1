/// Options whose value is a name and a number: "pelvis ty=0.98".
#pragma once

#include <string>
#include <string_view>

namespace verisq::command_line {

struct NamedNumber {
  std::string name;
  double number;
};

/// NAME=NUMBER. Throws Error(input) that begins with `option` for another form and for what is not a finite number.
[[nodiscard]] NamedNumber parse_named_number(std::string_view option, const std::string& text);

}  // namespace verisq::command_line
