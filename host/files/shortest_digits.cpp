/// Digits by the Dragonbox of {fmt}, with its whole table of powers: host/CMakeLists.txt requests that.
#include <fmt/compile.h>
#include <fmt/format.h>

#include "host/files/map_file.hpp"

namespace verisq {

char* put_shortest_digits(double number, char* at) {
  return fmt::format_to(at, FMT_COMPILE("{}"), number);
}

}  // namespace verisq
