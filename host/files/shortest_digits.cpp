/// Digits by Dragonbox as {fmt} has it, with its table of powers whole: host/CMakeLists.txt asks for that.
#include <fmt/compile.h>
#include <fmt/format.h>

#include "host/files/map_file.hpp"

namespace verisq {

char* put_shortest_digits(double number, char* at) {
  return fmt::format_to(at, FMT_COMPILE("{}"), number);
}

}  // namespace verisq
