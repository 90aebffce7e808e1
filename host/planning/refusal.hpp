/// What the user can correct ends a plan in one line.
#pragma once

#include <string>
#include <verisq/error.hpp>

namespace verisq::planning {

/// Throws Error(input).
[[noreturn]] inline void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

}  // namespace verisq::planning
