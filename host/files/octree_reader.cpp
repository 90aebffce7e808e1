/// This file implements octree_reader.hpp.
#include "host/files/octree_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <tuple>
#include <verisq/error.hpp>
#include <verisq/octree.hpp>

#include "host/files/input_file.hpp"

namespace verisq {
namespace {

constexpr unsigned coordinate_bits = 21;  // positions have 20, upper corners one more
constexpr std::uint64_t coordinate_mask = (std::uint64_t{1} << coordinate_bits) - 1;
constexpr std::size_t siblings = 8;

// The order in which VTK numbers the corners of a hexahedron.
constexpr std::array<std::array<std::uint32_t, 3>, 8> hexahedron{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

std::uint64_t key_of(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return z << 2 * coordinate_bits | y << coordinate_bits | x;
}

std::uint64_t key_of_parent(const OctreeCube& cube) {
  const auto& [x, y, z] = cube.position;
  return key_of(x / 2, y / 2, z / 2);
}

bool before(const OctreeCube& a, const OctreeCube& b) {
  const auto& [ax, ay, az] = a.position;
  const auto& [bx, by, bz] = b.position;
  return std::tie(a.colour, a.level, az, ay, ax) < std::tie(b.colour, b.level, bz, by, bx);
}

OctreeCube parent_of(const OctreeCube& cube) {
  const auto& [x, y, z] = cube.position;
  return {{x / 2, y / 2, z / 2}, static_cast<std::uint8_t>(cube.level - 1), cube.colour};
}

/// Moves the unmerged cubes of one level to `result`, and appends the merged ones' parents to `above`.
void merge_level(std::vector<OctreeCube>& level, std::vector<OctreeCube>& above, std::vector<OctreeCube>& result) {
  std::ranges::sort(level, {}, key_of_parent);
  for (std::size_t begin = 0; begin < level.size();) {
    const auto is_other = [&](const OctreeCube& cube) {
      return key_of_parent(cube) != key_of_parent(level[begin]) || cube.colour != level[begin].colour;
    };
    const auto end = std::find_if(level.begin() + static_cast<std::ptrdiff_t>(begin), level.end(), is_other);
    const std::size_t next = static_cast<std::size_t>(end - level.begin());
    if (next - begin == siblings) {
      above.push_back(parent_of(level[begin]));
    } else {
      result.insert(result.end(), level.begin() + static_cast<std::ptrdiff_t>(begin), end);
    }
    begin = next;
  }
}

}  // namespace

std::vector<OctreeCube> merged(std::span<const OctreeCube> cubes) {
  std::array<std::vector<OctreeCube>, deepest_octree_level + 1> levels;
  for (const OctreeCube& cube : cubes) levels.at(cube.level).push_back(cube);
  std::vector<OctreeCube> result;
  for (std::size_t level = levels.size(); --level > 0;) {
    merge_level(levels[level], levels[level - 1], result);
    levels[level] = {};
  }
  result.insert(result.end(), levels.front().begin(), levels.front().end());
  std::ranges::sort(result, before);
  return result;
}

SharedCorners::SharedCorners(std::span<const OctreeCube> cubes) {
  for (const OctreeCube& cube : cubes) level_ = std::max<int>(level_, cube.level);
  const auto forget_repeated = [this] {
    std::ranges::sort(keys_);
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
  };
  std::size_t enough = std::size_t{1} << 20U;  // now and then, so that memory holds no more than twice what is left
  for (const OctreeCube& cube : cubes) {
    const auto& [x, y, z] = cube.position;
    const int shift = level_ - cube.level;
    for (const auto& [i, j, k] : hexahedron) {
      keys_.push_back(
          key_of(std::uint64_t{x + i} << shift, std::uint64_t{y + j} << shift, std::uint64_t{z + k} << shift));
    }
    if (keys_.size() < enough) continue;
    forget_repeated();
    enough = std::max(enough, 2 * keys_.size());
  }
  forget_repeated();
  const std::size_t layers = (std::size_t{1} << static_cast<unsigned>(level_)) + 1;
  for (std::uint64_t z = 0; z <= layers; ++z) {
    first_of_z_.push_back(static_cast<std::uint64_t>(std::ranges::lower_bound(keys_, key_of(0, 0, z)) - keys_.begin()));
  }
}

SharedCorners::LatticePoint SharedCorners::operator[](std::size_t index) const {
  const std::uint64_t key = keys_[index];
  return {static_cast<std::uint32_t>(key & coordinate_mask),
          static_cast<std::uint32_t>(key >> coordinate_bits & coordinate_mask),
          static_cast<std::uint32_t>(key >> 2 * coordinate_bits)};
}

std::array<std::uint64_t, 8> SharedCorners::of(const OctreeCube& cube) const {
  const auto& [x, y, z] = cube.position;
  const int shift = level_ - cube.level;
  std::array<std::uint64_t, 8> indices{};
  for (std::size_t corner = 0; corner < hexahedron.size(); ++corner) {
    const auto& [i, j, k] = hexahedron[corner];
    const std::uint64_t layer = std::uint64_t{z + k} << shift;
    const std::uint64_t key = key_of(std::uint64_t{x + i} << shift, std::uint64_t{y + j} << shift, layer);
    const auto begin = keys_.begin() + static_cast<std::ptrdiff_t>(first_of_z_[layer]);
    const auto end = keys_.begin() + static_cast<std::ptrdiff_t>(first_of_z_[layer + 1]);
    indices[corner] = static_cast<std::uint64_t>(std::lower_bound(begin, end, key) - keys_.begin());
  }
  return indices;
}

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

// No operation rounds, as in lower_corner.
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

namespace {

class OctreeReader {
 public:
  explicit OctreeReader(const std::filesystem::path& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) fail("cannot be read");
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
    if (file.bad()) fail("cannot be read");
  }

  [[nodiscard]] OctreeContents contents() const {
    const std::size_t text_bytes = bytes_.find("\n_") + 2;
    const std::uint64_t points = count("NumberOfPoints=\"");
    const std::uint64_t cells = count("NumberOfCells=\"");
    const OctreeArrays arrays = octree_arrays(text_bytes, points, cells);
    if (arrays.end != bytes_.size()) {
      fail(fmt::format("{} bytes: an octree of {} cells and {} corners has {}", bytes_.size(), cells, points,
                       arrays.end));
    }
    OctreeContents result;
    for (std::size_t i = 0; i < 3; ++i) result.root.centre[i] = number<double>(arrays.root, i);
    result.root.half_width = number<double>(arrays.root, 3);
    for (std::uint64_t n = 0; n < cells; ++n) result.cubes.push_back(cube(result.root, arrays, points, cells, n));
    expect_these(result);
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw Error(ErrorKind::input, fmt::format("{}: {}: not an octree of `verisq octree`", path_.string(), reason));
  }

  /// At most the number of the file's bytes, so that no product overflows.
  [[nodiscard]] std::uint64_t count(std::string_view before) const {
    const std::size_t at = bytes_.find(before);
    if (at == std::string::npos) fail(fmt::format("no {}...\"", before));
    const char* const first = bytes_.data() + at + before.size();
    std::uint64_t result = 0;
    const auto [end, error] = std::from_chars(first, bytes_.data() + bytes_.size(), result);
    if (error != std::errc() || result > bytes_.size()) fail(fmt::format("{}...\": not a number of them", before));
    return result;
  }

  template <class Number>
  [[nodiscard]] Number number(std::uint64_t begin, std::uint64_t index) const {
    return number_from<Number>(bytes_.data() + begin + index * sizeof(Number), std::endian::little);
  }

  [[nodiscard]] OctreeCube cube(const OctreeRoot& root, const OctreeArrays& arrays, std::uint64_t points,
                                std::uint64_t cells, std::uint64_t n) const {
    OctreeCube result{
        {}, number<std::uint8_t>(arrays.level, n), static_cast<CubeColour>(number<std::uint8_t>(arrays.colour, n))};
    const auto corner = has_narrow_indices(cells)
                            ? static_cast<std::uint64_t>(number<std::int32_t>(arrays.connectivity, 8 * n))
                            : static_cast<std::uint64_t>(number<std::int64_t>(arrays.connectivity, 8 * n));
    if (result.level > deepest_octree_level) fail(fmt::format("cell {}: level {}", n, result.level));
    if (result.colour > CubeColour::black) fail(fmt::format("cell {}: no such colour", n));
    if (corner >= points) fail(fmt::format("cell {}: no such corner", n));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto lower = number<double>(arrays.points, 3 * corner + i);
      const double place = (lower - (root.centre[i] - root.half_width)) / std::ldexp(root.half_width, 1 - result.level);
      if (!(place >= 0.0 && place < std::ldexp(1.0, result.level))) fail(fmt::format("cell {}: beyond the root", n));
      result.position[i] = static_cast<std::uint32_t>(place);
    }
    return result;
  }

  /// All else that a viewer shows follows from the cubes.
  void expect_these(const OctreeContents& contents) const {
    std::size_t at = 0;
    const OctreeLayout layout(contents.cubes);
    const auto compare = [&](std::string_view written) {
      const std::string_view here = std::string_view(bytes_).substr(std::min(at, bytes_.size()), written.size());
      const auto [first, second] = std::ranges::mismatch(here, written);
      if (second != written.end()) {
        fail(fmt::format("byte {}: not what its cells say", at + static_cast<std::size_t>(second - written.begin())));
      }
      at += written.size();
    };
    layout.write(compare, contents.root);
  }

  std::filesystem::path path_;
  std::string bytes_;
};

}  // namespace

OctreeContents read_octree(const std::filesystem::path& path) {
  return OctreeReader(path).contents();
}

}  // namespace verisq
