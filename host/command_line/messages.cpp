/// Lines that begin with the program's name.
#include "host/command_line/messages.hpp"

#include <fmt/core.h>

#include <cstdio>

namespace verisq::command_line {

void tell(std::string_view message) {
  fmt::print(stderr, "verisq: {}\n", message);
}

void tell_notice(const std::string& notice) {
  if (!notice.empty()) tell(notice);
}

}  // namespace verisq::command_line
