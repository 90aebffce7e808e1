/// Options whose value is a plane: --resection.
#pragma once

#include <string>
#include <string_view>
#include <verisq/plane_cut.hpp>

namespace verisq::command_line {

/// "x,y,z,nx,ny,nz": a point and a normal of any length but zero. Throws Error(input) that begins with `option` for
/// anything else.
[[nodiscard]] Plane parse_plane(std::string_view option, const std::string& text);

}  // namespace verisq::command_line
