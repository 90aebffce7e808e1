/// How much a test tries: a number in the environment, for longer runs than the usual one.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <string>

namespace verisq::oracle {

/// The number in the environment's `variable`, or `usual` where it is not set. Throws std::invalid_argument for what is
/// not a number: a long run that silently was a short one would prove nothing.
[[nodiscard]] inline std::size_t requested_count(const char* variable, std::size_t usual) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? usual : static_cast<std::size_t>(std::stoull(text));
}

}  // namespace verisq::oracle
