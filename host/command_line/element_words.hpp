/// What the summaries and messages call the elements of a map.
#pragma once

#include <string_view>
#include <verisq/map_file.hpp>

namespace verisq::command_line {

[[nodiscard]] constexpr std::string_view singular(MapElements elements) {
  switch (elements) {
    case MapElements::vertices: return "point";
    case MapElements::triangles: return "triangle";
    case MapElements::poses: break;
  }
  return "pose";
}

[[nodiscard]] constexpr std::string_view plural(MapElements elements) {
  switch (elements) {
    case MapElements::vertices: return "points";
    case MapElements::triangles: return "triangles";
    case MapElements::poses: break;
  }
  return "poses";
}

}  // namespace verisq::command_line
