/// Options whose value is a pose: --pose, --pose-start.
#pragma once

#include <string>
#include <string_view>
#include <verisq/model.hpp>

namespace verisq::command_line {

/// "tx,ty,tz,qw,qx,qy,qz", each the nearest binary64. Throws Error(input) that begins with `option` for anything else,
/// for numbers that are not finite and for a zero quaternion.
[[nodiscard]] Pose parse_pose(std::string_view option, const std::string& text);

/// What `parse_pose` reads as the same bits.
[[nodiscard]] std::string option_text(const Pose& pose);

}  // namespace verisq::command_line
