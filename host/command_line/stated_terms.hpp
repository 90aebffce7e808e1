/// Which distances serve and what vertices weigh, as a certificate states it: for its reader to see.
#pragma once

#include <string>
#include <verisq/certificate_file.hpp>

#include "host/command_line/json_value.hpp"

namespace verisq::command_line {

/// "0.5 mm", or "0.5".
[[nodiscard]] std::string with_units(const std::string& number, const std::string& units);

/// The criterion, and each area: a line each.
[[nodiscard]] std::string criterion_in_words(const StatedTerms& terms, const std::string& units);

/// Objects with "name", "weight" and "points".
[[nodiscard]] JsonValue areas_of(const StatedTerms& terms);

}  // namespace verisq::command_line
