/// What messages of maps say about triangles.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "verisq/error.hpp"
#include "verisq/mesh.hpp"

namespace verisq {

/// Its corners.
[[nodiscard]] inline std::string text_of(const Triangle& triangle) {
  std::string text;
  for (const Point& p : triangle) text += fmt::format("{}({}, {}, {})", text.empty() ? "" : " ", p[0], p[1], p[2]);
  return text;
}

/// Throws Error(input) for a triangle that is not finite.
inline void require_finite(const Triangle& triangle) {
  const auto finite = [](double c) { return std::isfinite(c); };
  if (!std::ranges::all_of(triangle, [&](const Point& corner) { return std::ranges::all_of(corner, finite); }))
    throw Error(ErrorKind::input, fmt::format("triangle {} is not finite", text_of(triangle)));
}

}  // namespace verisq
