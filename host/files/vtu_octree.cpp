/// Octrees as VTK XML UnstructuredGrid with appended raw arrays.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/octree_file.hpp>

#include "host/files/output_file.hpp"

namespace verisq {
namespace {

constexpr std::uint64_t corners = 8;
constexpr std::uint8_t vtk_voxel = 11;       // an axis-parallel box; corners with x fastest, then y
constexpr std::size_t buffered_cubes = 512;  // written at a time

bool before(const OctreeCube& a, const OctreeCube& b) {
  const auto& [ax, ay, az] = a.position;
  const auto& [bx, by, bz] = b.position;
  return std::tie(a.colour, a.level, az, ay, ax) < std::tie(b.colour, b.level, bz, by, bx);
}

std::filesystem::path with_known_extension(const std::filesystem::path& file) {
  if (file.extension() != ".vtu")
    throw Error(ErrorKind::input, fmt::format("{}: octrees are written as .vtu", file.string()));
  return file;
}

}  // namespace

struct OctreeWriter::State {
  State(const std::filesystem::path& file, WhiteCubes written_white)
      : output(with_known_extension(file)), white(written_white) {}

  // Each array of the appended part is its size in bytes, a UInt64, and its bytes ("VTK File Formats", appended raw).
  void declare(std::string_view type, std::string_view name, int components, std::uint64_t bytes) {
    output.write(fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type, name, components, next_offset));
    next_offset += sizeof(std::uint64_t) + bytes;
  }

  void write_declarations() {
    const std::uint64_t count = cubes.size();
    output.write(fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "  <UnstructuredGrid>\n"
        "    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
        "      <Points>\n",
        corners * count, count));
    declare("Float64", "Points", 3, corners * count * sizeof(Point));
    output.write("      </Points>\n      <Cells>\n");
    declare("Int64", "connectivity", 1, corners * count * sizeof(std::int64_t));
    declare("Int64", "offsets", 1, count * sizeof(std::int64_t));
    declare("UInt8", "types", 1, count);
    output.write("      </Cells>\n      <CellData Scalars=\"colour\">\n");
    declare("UInt8", "colour", 1, count);
    declare("UInt8", "level", 1, count);
    output.write("      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n");
  }

  /// An array with `per_cube` numbers a cube, which `numbers_of(cube index, out)` fills.
  template <class Number, std::size_t per_cube, class NumbersOf>
  void write_array(const NumbersOf& numbers_of) {
    const std::uint64_t bytes = cubes.size() * per_cube * sizeof(Number);
    output.write_little_endian(std::span<const std::uint64_t>(&bytes, 1));
    std::vector<Number> numbers;
    for (std::size_t begin = 0; begin < cubes.size(); begin += buffered_cubes) {
      const std::size_t end = std::min(cubes.size(), begin + buffered_cubes);
      numbers.resize((end - begin) * per_cube);
      for (std::size_t n = begin; n < end; ++n)
        numbers_of(n, std::span(numbers).subspan((n - begin) * per_cube).template first<per_cube>());
      output.write_little_endian(std::span<const Number>(numbers));
    }
  }

  template <class Number, class NumberOf>
  void write_array(const NumberOf& number_of) {
    write_array<Number, 1>(
        [&](std::size_t n, std::span<Number, 1> out) { out[0] = static_cast<Number>(number_of(n)); });
  }

  void write_corners(const OctreeRoot& root) {
    write_array<double, 3 * corners>([&](std::size_t n, std::span<double, 3 * corners> out) {
      const Point lower = lower_corner(root, cubes[n]);
      const double size = edge(root, cubes[n].level);
      for (std::size_t corner = 0; corner < corners; ++corner)
        for (std::size_t i = 0; i < 3; ++i) out[3 * corner + i] = (corner >> i & 1U) != 0 ? lower[i] + size : lower[i];
    });
  }

  OutputFile output;
  WhiteCubes white;
  std::vector<OctreeCube> cubes;
  std::uint64_t next_offset = 0;
};

OctreeWriter::OctreeWriter(const std::filesystem::path& file, WhiteCubes white)
    : state_(std::make_unique<State>(file, white)) {}
OctreeWriter::~OctreeWriter() = default;
OctreeWriter::OctreeWriter(OctreeWriter&&) noexcept = default;
OctreeWriter& OctreeWriter::operator=(OctreeWriter&&) noexcept = default;

void OctreeWriter::append(std::span<const OctreeCube> cubes) {
  std::ranges::copy_if(cubes, std::back_inserter(state_->cubes), [&](const OctreeCube& cube) {
    return state_->white == WhiteCubes::written || cube.colour != CubeColour::white;
  });
}

void OctreeWriter::finish(const OctreeRoot& root) {
  State& state = *state_;
  std::ranges::sort(state.cubes, before);
  state.write_declarations();
  state.output.write("  <AppendedData encoding=\"raw\">\n_");
  state.write_corners(root);
  state.write_array<std::int64_t, corners>([](std::size_t n, std::span<std::int64_t, corners> out) {
    for (std::size_t corner = 0; corner < corners; ++corner)
      out[corner] = static_cast<std::int64_t>(corners * n + corner);
  });
  state.write_array<std::int64_t>([](std::size_t n) { return corners * (n + 1); });
  state.write_array<std::uint8_t>([](std::size_t) { return vtk_voxel; });
  state.write_array<std::uint8_t>([&](std::size_t n) { return state.cubes[n].colour; });
  state.write_array<std::uint8_t>([&](std::size_t n) { return state.cubes[n].level; });
  state.output.write("\n  </AppendedData>\n</VTKFile>\n");
  state.output.finish();
}

}  // namespace verisq
