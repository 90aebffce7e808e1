/// The message that names the words.
#include "host/command_line/choice.hpp"

#include <fmt/core.h>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

void refuse_choice(std::string_view option, std::string_view text, const std::vector<std::string_view>& words) {
  std::string list;
  for (const std::string_view word : words) list += fmt::format("{}{}", list.empty() ? "" : ", ", word);
  refuse(fmt::format("{}: {} is not one of {}", option, text, list));
}

}  // namespace verisq::command_line
