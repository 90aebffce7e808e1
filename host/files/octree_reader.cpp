/// Reads what OctreeWriter writes, to the byte: the cubes, written again, have to be the file.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <verisq/error.hpp>
#include <verisq/octree_file.hpp>

#include "host/files/byte_order.hpp"
#include "host/files/octree_layout.hpp"

namespace verisq {
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

  /// At most the bytes of the file, so that no product overflows.
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
