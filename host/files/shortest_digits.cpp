/// Digits by Dragonbox as {fmt} has it, with its table of powers whole: host/CMakeLists.txt asks for that.
#include "host/files/shortest_digits.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

namespace verisq {

char* put_shortest_digits(double number, char* at) {
  return fmt::format_to(at, FMT_COMPILE("{}"), number);
}

}  // namespace verisq
