/// STL, binary and ASCII: three corners a triangle; equal corners are merged.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "host/files/byte_order.hpp"
#include "host/files/mesh_builder.hpp"
#include "host/files/mesh_formats.hpp"
#include "host/files/vertex_merger.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

constexpr std::size_t header_bytes = 84;    // 80 of free text, then the number of triangles
constexpr std::size_t triangle_bytes = 50;  // normal, three corners (binary32 each), two bytes of attributes

std::uint32_t promised_triangles(std::string_view head) {
  return number_from<std::uint32_t>(head.data() + 80, std::endian::little);
}

bool starts_with_solid(std::string_view head) {
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
  return lower_case(head.substr(0, 5)) == "solid";
}

bool looks_like_text(std::string_view head) {
  return head.find('\0') == std::string_view::npos;
}

/// Binary files may start with "solid" too, so the size decides; where it fits neither way, the kind of bytes does.
bool is_binary(InputFile& file) {
  const std::string_view head = file.peek(512);
  if (head.size() >= header_bytes &&
      file.size() == header_bytes + std::uint64_t{triangle_bytes} * promised_triangles(head)) {
    return true;
  }
  if (starts_with_solid(head) && looks_like_text(head)) return false;
  if (looks_like_text(head)) file.fail_whole("not an STL file: text that does not start with 'solid'");
  return true;
}

Point corner(const InputFile& file, const char* bytes) {
  Point point{};
  for (std::size_t k = 0; k < 3; ++k) {
    point[k] = number_from<float>(bytes + sizeof(float) * k, std::endian::little);
    if (!std::isfinite(point[k])) {
      file.fail(fmt::format("triangle {}: coordinate {} = {}: not a finite number",
                            (file.position() - header_bytes) / triangle_bytes, "xyz"[k], point[k]));
    }
  }
  return point;
}

void check_size(const InputFile& file, std::uint32_t triangles) {
  const std::uint64_t needed = header_bytes + std::uint64_t{triangle_bytes} * triangles;
  if (file.size() == needed) return;
  file.fail_whole(fmt::format("{}: the header promises {} triangles, {} bytes; the file has {} bytes",
                              file.size() < needed ? "truncated" : "too long", triangles, needed, file.size()));
}

Mesh read_binary(InputFile& file) {
  const std::uint32_t triangles = promised_triangles(file.take(header_bytes, "the header"));
  check_size(file, triangles);
  if (triangles == 0) file.fail_whole("no triangles");
  MeshBuilder builder(file);
  builder.reserve(triangles / 2 + triangles / 16 + 3, triangles);  // Euler's formula, and some room for rims
  VertexMerger merger(builder);
  for (std::uint32_t k = 0; k < triangles; ++k) {
    const char* bytes = file.take(triangle_bytes, "a triangle").data();
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) corners[c] = merger.index_of(corner(file, bytes + 12 * (c + 1)));
    builder.add_polygon(corners);
  }
  return std::move(builder).finish();
}

/// The words of the next line that has some, which must start with `keywords`.
Words expect(InputFile& file, std::string_view keywords) {
  const auto line = file.next_line_with_text();
  if (!line) file.fail(fmt::format("truncated: the file ends where '{}' should follow", keywords));
  Words found(*line);
  for (Words wanted(keywords); !wanted.empty();) {
    if (lower_case(found.next()) != wanted.next()) {
      file.fail(fmt::format("expected '{}', found {}", keywords, in_quotes(trimmed(*line))));
    }
  }
  return found;
}

Point read_vertex(InputFile& file) {
  Words words = expect(file, "vertex");
  const Point point = coordinates(file, words);
  expect_end(file, words);
  return point;
}

/// After the line "facet ..."; its normal is not read: the corners and their order say it better.
void read_facet(InputFile& file, MeshBuilder& builder, VertexMerger& merger) {
  expect_end(file, expect(file, "outer loop"));
  std::array<std::uint32_t, 3> corners{};
  for (std::uint32_t& index : corners) index = merger.index_of(read_vertex(file));
  builder.add_polygon(corners);
  expect_end(file, expect(file, "endloop"));
  expect_end(file, expect(file, "endfacet"));
}

/// Any number of solids, one after the other.
Mesh read_ascii(InputFile& file) {
  MeshBuilder builder(file);
  VertexMerger merger(builder);
  bool inside_solid = false;
  while (const auto line = file.next_line_with_text()) {
    const std::string keyword = lower_case(Words(*line).next());
    if (keyword == "facet" && inside_solid) {
      read_facet(file, builder, merger);
    } else if (keyword == (inside_solid ? "endsolid" : "solid")) {
      inside_solid = !inside_solid;
    } else {
      file.fail(fmt::format("expected {}, found {}", inside_solid ? "'facet' or 'endsolid'" : "'solid'",
                            in_quotes(trimmed(*line))));
    }
  }
  if (inside_solid) file.fail("truncated: the file ends without 'endsolid'");
  if (builder.mesh().triangles.empty()) file.fail_whole("no triangles");
  return std::move(builder).finish();
}

}  // namespace

Mesh read_stl(InputFile& file) {
  return is_binary(file) ? read_binary(file) : read_ascii(file);
}

}  // namespace verisq
