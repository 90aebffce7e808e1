/// The name, then one number.
#include "host/command_line/named_number.hpp"

#include <fmt/core.h>

#include "host/command_line/number_list.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

NamedNumber parse_named_number(std::string_view option, const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) refuse(fmt::format("{}: {} is not NAME=NUMBER", option, text));
  const std::string whole = fmt::format("{} {}", option, text);
  return {text.substr(0, equals), parse_numbers(whole, text.substr(equals + 1), "NUMBER").front()};
}

}  // namespace verisq::command_line
