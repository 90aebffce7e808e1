/// Options whose value is a fixed count of numbers: "x,y,z".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace verisq::command_line {

/// The binary64 numbers nearest to those between the commas of `text`, as many as `names` ("x,y,z") has. Throws
/// Error(input) that begins with `option` for another count and for what is not a finite number.
[[nodiscard]] std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::string_view names);

}  // namespace verisq::command_line
