/// What the user can correct ends a command in one line.
#pragma once

#include <string>
#include <verisq/error.hpp>

namespace verisq::command_line {

/// Throws Error(input).
[[noreturn]] inline void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

}  // namespace verisq::command_line
