/// Tells by the extension which of both it is.
#include "host/command_line/cloud_input.hpp"

#include <array>
#include <verisq/mesh_file.hpp>
#include <verisq/point_file.hpp>

namespace verisq::command_line {

Mesh read_cloud(const std::string& name) {
  if (is_mesh_name(name)) return {.vertices = read_mesh(name).vertices, .triangles = {}};
  PointFile file(name);
  Mesh cloud;
  std::array<Point, 4096> chunk{};
  for (std::size_t count = chunk.size(); count == chunk.size();) {
    count = file.read(chunk);
    cloud.vertices.insert(cloud.vertices.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return cloud;
}

}  // namespace verisq::command_line
