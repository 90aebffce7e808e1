/// What the caller can correct ends the work in one line.
#pragma once

#include <string>
#include <verisq/error.hpp>

namespace verisq {

/// Throws Error(input).
[[noreturn]] inline void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

}  // namespace verisq
