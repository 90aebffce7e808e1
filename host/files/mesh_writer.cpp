/// One writer for each mesh format.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>

#include "host/files/mesh_file.hpp"
#include "host/files/output_file.hpp"
#include "host/files/words.hpp"

namespace verisq {

/// Preconditions, of all: finite coordinates, indices in range.
void write_ply(OutputFile& file, const Mesh& mesh);
void write_off(OutputFile& file, const Mesh& mesh);
void write_obj(OutputFile& file, const Mesh& mesh);

/// Precondition: each coordinate is a binary32 number.
void write_stl(OutputFile& file, const Mesh& mesh);

namespace {

constexpr std::string_view once_rounded = " once rounded to STL's binary32; write a .ply";

using Writer = void (*)(OutputFile&, const Mesh&);

Writer writer_for(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".ply") return write_ply;
  if (extension == ".stl") return write_stl;
  if (extension == ".off") return write_off;
  if (extension == ".obj") return write_obj;
  throw Error(ErrorKind::input, fmt::format("{}: unknown mesh format {}: written are .ply, .stl, .off, .obj",
                                            path.string(), in_quotes(path.extension().string())));
}

/// The mesh that an STL file represents: the numbers are still binary64, to be checked like those of other formats.
Mesh rounded_to_binary32(Mesh mesh) {
  for (Point& vertex : mesh.vertices) {
    for (double& coordinate : vertex) {
      const bool overflows = std::abs(coordinate) > static_cast<double>(std::numeric_limits<float>::max());
      coordinate = overflows ? infinity : static_cast<float>(coordinate);
    }
  }
  return mesh;
}

/// Refuses a mesh that `read_mesh` would not give again. `rounding` states in the message how the numbers were rounded.
void check(const std::filesystem::path& path, const Mesh& mesh, std::string_view rounding) {
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    for (const double coordinate : mesh.vertices[k]) {
      if (std::isfinite(coordinate)) continue;
      throw Error(ErrorKind::input,
                  fmt::format("{}: vertex {}: a coordinate is not a finite number{}", path.string(), k, rounding));
    }
  }
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& [a, b, c] = mesh.triangles[k];
    if (a != b && b != c && c != a) continue;
    throw Error(ErrorKind::input, fmt::format("{}: triangle {} names a vertex twice", path.string(), k + 1));
  }
}

/// Refuses a mesh of which rounding takes a triangle's area.
void check_areas(const std::filesystem::path& path, const Mesh& mesh, const Mesh& rounded) {
  const auto has_none = [](const Mesh& of, const std::array<std::uint32_t, 3>& corners) {
    return has_zero_area(of.vertices[corners[0]], of.vertices[corners[1]], of.vertices[corners[2]]);
  };
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    if (!has_none(rounded, mesh.triangles[k]) || has_none(mesh, mesh.triangles[k])) continue;
    throw Error(ErrorKind::input, fmt::format("{}: triangle {} has zero area{}", path.string(), k + 1, once_rounded));
  }
}

/// Refuses a mesh whose distinct vertices become one point by rounding: readers of STL would join the surface there.
void check_distinct(const std::filesystem::path& path, const Mesh& mesh, const Mesh& rounded) {
  std::vector<std::size_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return rounded.vertices[k]; });
  const auto joined = std::ranges::adjacent_find(order, [&](std::size_t i, std::size_t j) {
    return rounded.vertices[i] == rounded.vertices[j] && mesh.vertices[i] != mesh.vertices[j];
  });
  if (joined == order.end()) return;
  const auto [low, high] = std::minmax(joined[0], joined[1]);
  throw Error(ErrorKind::input,
              fmt::format("{}: vertices {} and {} are one point{}", path.string(), low, high, once_rounded));
}

/// The normal of unit length; zero if rounding leaves no direction. Readers compute it from the corners anyway.
std::array<float, 3> normal(const Point& a, const Point& b, const Point& c) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const Point v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0.0) || !std::isfinite(length)) return {0.0F, 0.0F, 0.0F};
  return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length)};
}

std::array<float, 3> binary32(const Point& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

}  // namespace

void write_ply(OutputFile& file, const Mesh& mesh) {
  file.write(fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.vertices.size()));
  file.write("property double x\nproperty double y\nproperty double z\n");
  file.write(fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", mesh.triangles.size()));
  file.write("end_header\n");
  for (const Point& vertex : mesh.vertices) file.write_little_endian<double>(vertex);
  for (const auto& triangle : mesh.triangles) {
    file.write(std::string_view("\3", 1));  // corners
    file.write_little_endian<std::uint32_t>(triangle);
  }
}

void write_off(OutputFile& file, const Mesh& mesh) {
  file.write(fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size()));
  for (const auto& [x, y, z] : mesh.vertices) file.write(fmt::format("{} {} {}\n", x, y, z));
  for (const auto& [a, b, c] : mesh.triangles) file.write(fmt::format("3 {} {} {}\n", a, b, c));
}

void write_obj(OutputFile& file, const Mesh& mesh) {
  for (const auto& [x, y, z] : mesh.vertices) file.write(fmt::format("v {} {} {}\n", x, y, z));
  for (const auto& [a, b, c] : mesh.triangles)  // counted from 1; in 64 bits, which have room for one more
    file.write(fmt::format("f {} {} {}\n", a + std::uint64_t{1}, b + std::uint64_t{1}, c + std::uint64_t{1}));
}

void write_stl(OutputFile& file, const Mesh& mesh) {
  std::string header = "binary STL; lengths rounded to binary32";  // must not begin with "solid"
  header.resize(80, ' ');
  file.write(header);
  file.write_little_endian<std::uint32_t>(std::array{static_cast<std::uint32_t>(mesh.triangles.size())});
  for (const auto& [a, b, c] : mesh.triangles) {
    file.write_little_endian<float>(normal(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
    for (const std::uint32_t corner : {a, b, c}) file.write_little_endian<float>(binary32(mesh.vertices[corner]));
    file.write(std::string_view("\0\0", 2));  // attributes
  }
}

void check_mesh_name(const std::filesystem::path& path) {
  (void)writer_for(path);
}

void write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
  const Writer write = writer_for(path);
  const bool rounds = write == write_stl;
  const Mesh& written = rounds ? rounded_to_binary32(mesh) : mesh;
  check(path, written, rounds ? once_rounded : "");
  if (rounds) {
    check_areas(path, mesh, written);
    check_distinct(path, mesh, written);
  }
  OutputFile file(path);
  write(file, written);
  file.finish();
}

}  // namespace verisq
