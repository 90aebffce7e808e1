/// A cloud of points that is read whole: a file of points, or the vertices of a mesh.
#pragma once

#include <string>
#include <verisq/mesh.hpp>

namespace verisq::command_line {

/// Without triangles. Throws Error(input).
[[nodiscard]] Mesh read_cloud(const std::string& name);

}  // namespace verisq::command_line
