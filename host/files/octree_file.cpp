/// Octrees as VTK XML UnstructuredGrid with appended raw arrays.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/octree_file.hpp>

#include "host/files/octree_cells.hpp"
#include "host/files/output_file.hpp"

namespace verisq {
namespace {

constexpr std::uint64_t corners = 8;
constexpr std::uint8_t vtk_hexahedron = 12;
constexpr std::size_t buffered = 512;  // cells or points that are written at a time
constexpr std::string_view closing_lines = "\n  </AppendedData>\n</VTKFile>\n";

std::filesystem::path with_known_extension(const std::filesystem::path& file) {
  if (file.extension() != ".vtu")
    throw Error(ErrorKind::input, fmt::format("{}: octrees are written as .vtu", file.string()));
  return file;
}

// Text and arrays of a file, whose sizes are known before anything is written.
class Layout {
 public:
  explicit Layout(std::span<const OctreeCube> appended)
      : cubes_(merged(appended)),
        corners_(cubes_),
        narrow_(corners * cubes_.size() <= std::numeric_limits<std::int32_t>::max()) {
    write_declarations();
  }

  [[nodiscard]] std::uint64_t bytes() const { return text_.size() + array_bytes_ + closing_lines.size(); }

  void write(OutputFile& output, const OctreeRoot& root) const {
    output.write(text_);
    write_points(output, root);
    narrow_ ? write_cells<std::int32_t>(output) : write_cells<std::int64_t>(output);
    write_array<std::uint8_t, 1>(output, cubes_.size(), [](std::size_t, auto out) { out[0] = vtk_hexahedron; });
    write_array<std::uint8_t, 1>(output, cubes_.size(), [this](std::size_t n, auto out) {
      out[0] = static_cast<std::uint8_t>(cubes_[n].colour);
    });
    write_array<std::uint8_t, 1>(output, cubes_.size(), [this](std::size_t n, auto out) { out[0] = cubes_[n].level; });
    output.write(closing_lines);
  }

 private:
  // Each array of the appended part is its size in bytes, a UInt64, and its bytes ("VTK File Formats", appended raw).
  void declare(std::string_view type, std::string_view name, int components, std::uint64_t bytes) {
    text_ += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type, name, components, array_bytes_);
    array_bytes_ += sizeof(std::uint64_t) + bytes;
  }

  void write_declarations() {
    const std::uint64_t count = cubes_.size();
    const std::string_view index = narrow_ ? "Int32" : "Int64";
    const std::uint64_t index_bytes = narrow_ ? sizeof(std::int32_t) : sizeof(std::int64_t);
    text_ = fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "  <UnstructuredGrid>\n"
        "    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
        "      <Points>\n",
        corners_.size(), count);
    declare("Float64", "Points", 3, corners_.size() * sizeof(Point));
    text_ += "      </Points>\n      <Cells>\n";
    declare(index, "connectivity", 1, corners * count * index_bytes);
    declare(index, "offsets", 1, count * index_bytes);
    declare("UInt8", "types", 1, count);
    text_ += "      </Cells>\n      <CellData Scalars=\"colour\">\n";
    declare("UInt8", "colour", 1, count);
    declare("UInt8", "level", 1, count);
    text_ += "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";
  }

  /// An array of `count` times `size` numbers, which `numbers_of(index, out)` fills.
  template <class Number, std::size_t size, class NumbersOf>
  static void write_array(OutputFile& output, std::size_t count, const NumbersOf& numbers_of) {
    const std::uint64_t bytes = count * size * sizeof(Number);
    output.write_little_endian(std::span<const std::uint64_t>(&bytes, 1));
    std::vector<Number> numbers;
    for (std::size_t begin = 0; begin < count; begin += buffered) {
      const std::size_t end = std::min(count, begin + buffered);
      numbers.resize((end - begin) * size);
      for (std::size_t n = begin; n < end; ++n)
        numbers_of(n, std::span(numbers).subspan((n - begin) * size).template first<size>());
      output.write_little_endian(std::span<const Number>(numbers));
    }
  }

  // As lower_corner: no operation rounds.
  void write_points(OutputFile& output, const OctreeRoot& root) const {
    const double size = edge(root, corners_.level());
    write_array<double, 3>(output, corners_.size(), [&](std::size_t n, std::span<double, 3> out) {
      const auto at = corners_[n];
      for (std::size_t i = 0; i < 3; ++i) out[i] = root.centre[i] - root.half_width + size * at[i];
    });
  }

  template <class Index>
  void write_cells(OutputFile& output) const {
    write_array<Index, corners>(output, cubes_.size(), [this](std::size_t n, std::span<Index, corners> out) {
      std::ranges::transform(corners_.of(cubes_[n]), out.begin(),
                             [](std::uint64_t i) { return static_cast<Index>(i); });
    });
    write_array<Index, 1>(output, cubes_.size(),
                          [](std::size_t n, auto out) { out[0] = static_cast<Index>(corners * (n + 1)); });
  }

  std::vector<OctreeCube> cubes_;
  SharedCorners corners_;
  bool narrow_;  // indices of corners, and the offsets behind them
  std::string text_;
  std::uint64_t array_bytes_ = 0;
};

}  // namespace

struct OctreeWriter::State {
  State(const std::filesystem::path& file, WhiteCubes written_white)
      : output(with_known_extension(file)), white(written_white) {}

  const Layout& finished_layout() {
    if (!layout) layout.emplace(cubes);
    return *layout;
  }

  OutputFile output;
  WhiteCubes white;
  std::vector<OctreeCube> cubes;
  std::optional<Layout> layout;  // once no cubes are appended any more
};

OctreeWriter::OctreeWriter(const std::filesystem::path& file, WhiteCubes white)
    : state_(std::make_unique<State>(file, white)) {}
OctreeWriter::~OctreeWriter() = default;
OctreeWriter::OctreeWriter(OctreeWriter&&) noexcept = default;
OctreeWriter& OctreeWriter::operator=(OctreeWriter&&) noexcept = default;

void OctreeWriter::append(std::span<const OctreeCube> cubes) {
  state_->layout.reset();
  std::ranges::copy_if(cubes, std::back_inserter(state_->cubes), [&](const OctreeCube& cube) {
    return state_->white == WhiteCubes::written || cube.colour != CubeColour::white;
  });
}

std::uint64_t OctreeWriter::bytes() {
  return state_->finished_layout().bytes();
}

void OctreeWriter::finish(const OctreeRoot& root) {
  state_->finished_layout().write(state_->output, root);
  state_->output.finish();
}

}  // namespace verisq
