/// A `.pvtp`: names the pieces of a map of points, each a `.vtp`, for ParaView to open as one.
#pragma once

#include <span>
#include <string>

namespace verisq {

/// The whole file. `sources`: the pieces, from where it lies; `closest_points`: whether they have these.
[[nodiscard]] std::string pvtp_document(std::span<const std::string> sources, bool closest_points);

}  // namespace verisq
