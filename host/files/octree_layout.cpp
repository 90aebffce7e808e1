/// Declares and writes the arrays of VTK's XML UnstructuredGrid ("VTK File Formats", appended raw).
#include "host/files/octree_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/files/byte_order.hpp"

namespace verisq {
namespace {

constexpr std::uint64_t corners_a_cube = 8;
constexpr std::uint8_t vtk_hexahedron = 12;
constexpr std::size_t buffered = 512;  // cells or points that are written at a time
constexpr std::string_view closing_lines = "\n  </AppendedData>\n</VTKFile>\n";
constexpr std::uint64_t size_bytes = sizeof(std::uint64_t);

std::string text_of(std::uint64_t points, std::uint64_t cells) {
  const OctreeArrays arrays = octree_arrays(0, points, cells);
  const std::string_view index = has_narrow_indices(cells) ? "Int32" : "Int64";
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n";
  const auto declare = [&](int indentation, std::string_view type, std::string_view name, std::string_view components,
                           std::uint64_t begin) {
    text += fmt::format(
        "{:{}}<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", "",
        indentation, type, name, components, begin - size_bytes);
  };
  text += "    <FieldData>\n";
  declare(6, "Float64", "root", "4\" NumberOfTuples=\"1", arrays.root);
  text += fmt::format("    </FieldData>\n    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n      <Points>\n",
                      points, cells);
  declare(8, "Float64", "Points", "3", arrays.points);
  text += "      </Points>\n      <Cells>\n";
  declare(8, index, "connectivity", "1", arrays.connectivity);
  declare(8, index, "offsets", "1", arrays.offsets);
  declare(8, "UInt8", "types", "1", arrays.types);
  text += "      </Cells>\n      <CellData Scalars=\"colour\">\n";
  declare(8, "UInt8", "colour", "1", arrays.colour);
  declare(8, "UInt8", "level", "1", arrays.level);
  text += "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";
  return text;
}

/// An array of `count` times `size` numbers, which `numbers_of(index, out)` fills.
template <class Number, std::size_t size, class NumbersOf>
void write_array(const OctreeLayout::Sink& sink, std::size_t count, const NumbersOf& numbers_of) {
  const auto write = [&](const auto& number) {
    const auto stored = in_little_endian(number);
    sink({reinterpret_cast<const char*>(&stored), sizeof stored});
  };
  write(std::uint64_t{count * size * sizeof(Number)});
  std::vector<Number> numbers;
  for (std::size_t begin = 0; begin < count; begin += buffered) {
    const std::size_t end = std::min(count, begin + buffered);
    numbers.resize((end - begin) * size);
    for (std::size_t n = begin; n < end; ++n)
      numbers_of(n, std::span(numbers).subspan((n - begin) * size).template first<size>());
    for (Number& number : numbers) number = in_little_endian(number);
    sink({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
  }
}

}  // namespace

bool has_narrow_indices(std::uint64_t cells) {
  return corners_a_cube * cells <= std::numeric_limits<std::int32_t>::max();
}

OctreeArrays octree_arrays(std::uint64_t text_bytes, std::uint64_t points, std::uint64_t cells) {
  const std::uint64_t index_bytes = has_narrow_indices(cells) ? sizeof(std::int32_t) : sizeof(std::int64_t);
  std::uint64_t at = text_bytes;
  const auto next = [&](std::uint64_t bytes) {
    const std::uint64_t begin = at + size_bytes;
    at = begin + bytes;
    return begin;
  };
  OctreeArrays arrays{};
  arrays.root = next(4 * sizeof(double));
  arrays.points = next(points * sizeof(Point));
  arrays.connectivity = next(corners_a_cube * cells * index_bytes);
  arrays.offsets = next(cells * index_bytes);
  arrays.types = next(cells);
  arrays.colour = next(cells);
  arrays.level = next(cells);
  arrays.end = at + closing_lines.size();
  return arrays;
}

OctreeLayout::OctreeLayout(std::span<const OctreeCube> cubes)
    : cubes_(merged(cubes)), corners_(cubes_), text_(text_of(corners_.size(), cubes_.size())) {}

std::uint64_t OctreeLayout::bytes() const {
  return octree_arrays(text_.size(), corners_.size(), cubes_.size()).end;
}

void OctreeLayout::write(const Sink& sink, const OctreeRoot& root) const {
  sink(text_);
  write_array<double, 4>(sink, 1, [&](std::size_t, std::span<double, 4> out) {
    std::ranges::copy(root.centre, out.begin());
    out[3] = root.half_width;
  });
  write_points(sink, root);
  has_narrow_indices(cubes_.size()) ? write_cells<std::int32_t>(sink) : write_cells<std::int64_t>(sink);
  write_array<std::uint8_t, 1>(sink, cubes_.size(), [](std::size_t, auto out) { out[0] = vtk_hexahedron; });
  write_array<std::uint8_t, 1>(
      sink, cubes_.size(), [this](std::size_t n, auto out) { out[0] = static_cast<std::uint8_t>(cubes_[n].colour); });
  write_array<std::uint8_t, 1>(sink, cubes_.size(), [this](std::size_t n, auto out) { out[0] = cubes_[n].level; });
  sink(closing_lines);
}

// As lower_corner: no operation rounds.
void OctreeLayout::write_points(const Sink& sink, const OctreeRoot& root) const {
  const double size = std::ldexp(root.half_width, 1 - corners_.level());
  write_array<double, 3>(sink, corners_.size(), [&](std::size_t n, std::span<double, 3> out) {
    const auto at = corners_[n];
    for (std::size_t i = 0; i < 3; ++i) out[i] = root.centre[i] - root.half_width + size * at[i];
  });
}

template <class Index>
void OctreeLayout::write_cells(const Sink& sink) const {
  write_array<Index, corners_a_cube>(sink, cubes_.size(), [this](std::size_t n, std::span<Index, corners_a_cube> out) {
    std::ranges::transform(corners_.of(cubes_[n]), out.begin(), [](std::uint64_t i) { return static_cast<Index>(i); });
  });
  write_array<Index, 1>(sink, cubes_.size(),
                        [](std::size_t n, auto out) { out[0] = static_cast<Index>(corners_a_cube * (n + 1)); });
}

}  // namespace verisq
