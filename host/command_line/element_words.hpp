/// What the summaries and messages call the elements of a map.
#pragma once

#include <string_view>
#include <verisq/map_file.hpp>

namespace verisq::command_line {

[[nodiscard]] constexpr std::string_view singular(MapElements elements) {
  return elements == MapElements::vertices ? "point" : "triangle";
}

[[nodiscard]] constexpr std::string_view plural(MapElements elements) {
  return elements == MapElements::vertices ? "points" : "triangles";
}

}  // namespace verisq::command_line
