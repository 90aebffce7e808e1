/// OBJ (Wavefront): `v` and `f` records; all others (normals, textures, groups, materials, ...) are not geometry.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "host/files/mesh_builder.hpp"
#include "host/files/mesh_formats.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

/// "v x y z", after which a weight or a colour may follow: numbers, not used.
void read_vertex(const InputFile& file, Words words, MeshBuilder& builder) {
  const Point point = coordinates(file, words);
  while (!words.empty()) (void)finite_number(file, words.next(), "weight or colour");
  builder.add_vertex(point);
}

/// A corner "v", "v/vt", "v//vn" or "v/vt/vn"; v counts from 1, or backwards from the latest vertex with -1.
std::uint32_t read_corner(const InputFile& file, std::string_view corner, const MeshBuilder& builder) {
  const std::string_view vertex = corner.substr(0, corner.find('/'));
  if (corner.find_first_not_of("0123456789+-/") != std::string_view::npos ||
      std::count(corner.begin(), corner.end(), '/') > 2) {
    file.fail(fmt::format("face corner {}: not of the form v, v/vt, v//vn or v/vt/vn", in_quotes(corner)));
  }
  const std::int64_t index = integer(file, vertex, "vertex index");
  const auto count = static_cast<std::int64_t>(builder.mesh().vertices.size());
  if (index == 0 || index > count || index < -count) {
    file.fail(fmt::format("vertex index {}: out of range, {} vertices so far, counted from 1", index, count));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
}

}  // namespace

Mesh read_obj(InputFile& file) {
  MeshBuilder builder(file);
  std::vector<std::uint32_t> corners;
  while (const auto line = file.next_line_with_text()) {
    Words words(line->substr(0, line->find('#')));
    const std::string_view record = words.next();
    if (record == "v") {
      read_vertex(file, words, builder);
    } else if (record == "f") {
      corners.clear();
      while (!words.empty()) corners.push_back(read_corner(file, words.next(), builder));
      builder.add_polygon(corners);
    }
  }
  return std::move(builder).finish();
}

}  // namespace verisq
