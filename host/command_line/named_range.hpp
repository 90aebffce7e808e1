/// Options whose value is a name and two ends: "length_change=-2,1".
#pragma once

#include <string>
#include <string_view>
#include <verisq/enclosure.hpp>

namespace verisq::command_line {

struct NamedRange {
  std::string name;
  Enclosure range;
};

/// NAME=LO,HI. Throws Error(input) that begins with `option` for another form, for what is not a finite number, and
/// where LO is above HI.
[[nodiscard]] NamedRange parse_named_range(std::string_view option, const std::string& text);

}  // namespace verisq::command_line
