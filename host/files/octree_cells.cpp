/// Siblings and corners by sorted keys: three coordinates in one number.
#include "host/files/octree_cells.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace verisq {
namespace {

constexpr unsigned coordinate_bits = 21;  // positions have 20, upper corners one more
constexpr std::uint64_t coordinate_mask = (std::uint64_t{1} << coordinate_bits) - 1;
constexpr std::size_t siblings = 8;

// As VTK numbers the corners of a hexahedron.
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

/// Moves what stays of one level to `result`, and appends what it becomes together to `above`.
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

}  // namespace verisq
