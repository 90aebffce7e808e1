/// Tetrahedra meet face to face, in all cells alike, so that the surface has no cracks.
#include "host/surface/level_surface.hpp"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "host/mesh/determinant.hpp"

namespace verisq::surface {
namespace {

/// Keeps triangles from having sides of no length.
constexpr double nearest_to_sample = 0.02;

/// Corners of a cell by bits: 1 along the first axis, 2 along the second, 4 along the third. Each tetrahedron ascends
/// from corner 0 to corner 7 by one axis after the other; the first, third and fifth keep the order of the axes (are
/// even permutations), so that they are positively oriented where the axes are.
constexpr std::array<std::array<std::size_t, 4>, 6> tetrahedra{
    {{0, 1, 3, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 6, 7}, {0, 4, 5, 7}, {0, 1, 5, 7}}};

class Marcher {
 public:
  explicit Marcher(const GridSamples& samples) : samples_(samples), right_handed_(determinant(samples.steps) > 0.0) {}

  Mesh operator()() {
    const auto& [nx, ny, nz] = samples_.counts;
    for (std::size_t k = 0; k + 1 < nz; ++k)
      for (std::size_t j = 0; j + 1 < ny; ++j)
        for (std::size_t i = 0; i + 1 < nx; ++i) march({i, j, k});
    return std::move(mesh_);
  }

 private:
  using Place = std::array<std::size_t, 3>;

  [[nodiscard]] static Place corner(const Place& cell, std::size_t bits) {
    return {cell[0] + (bits & 1U), cell[1] + (bits >> 1U & 1U), cell[2] + (bits >> 2U)};
  }
  [[nodiscard]] double value(const Place& at) const {
    return static_cast<double>(samples_.values[samples_.index(at[0], at[1], at[2])]);
  }

  void march(const Place& cell) {
    std::array<bool, 8> inside{};
    for (std::size_t bits = 0; bits < 8; ++bits) inside[bits] = value(corner(cell, bits)) > 0.0;
    if (std::ranges::all_of(inside, [&](bool is) { return is == inside[0]; })) return;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
      march(cell, inside, tetrahedra[t], (t % 2 == 0) == right_handed_);
  }

  /// Corners inside come first: so many exchanges of neighbours turn the tetrahedron over so many times.
  void march(const Place& cell, const std::array<bool, 8>& inside, std::array<std::size_t, 4> corners, bool positive) {
    std::size_t count = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      if (!inside[corners[c]]) continue;
      for (std::size_t at = c; at > count; --at) {
        std::swap(corners[at], corners[at - 1]);
        positive = !positive;
      }
      ++count;
    }
    const auto [a, b, c, d] = corners;
    if (count == 1) add(vertex(cell, a, b), vertex(cell, a, c), vertex(cell, a, d), positive);
    if (count == 3) add(vertex(cell, a, d), vertex(cell, c, d), vertex(cell, b, d), !positive);
    if (count == 2) {
      const std::uint32_t ac = vertex(cell, a, c);
      const std::uint32_t bd = vertex(cell, b, d);
      add(ac, vertex(cell, a, d), bd, positive);
      add(ac, bd, vertex(cell, b, c), positive);
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool positive) {
    mesh_.triangles.push_back(positive ? std::array{a, b, c} : std::array{a, c, b});
  }

  /// On the edge between two corners of the cell, of which one is inside: one vertex for all cells that share it.
  std::uint32_t vertex(const Place& cell, std::size_t one, std::size_t other) {
    const std::size_t low = std::min(one, other);
    const Place from = corner(cell, low);
    const Place to = corner(cell, std::max(one, other));
    // An edge ascends: it is known by its lower end and its direction, which is no less than 1.
    const std::uint64_t key = 8 * samples_.index(from[0], from[1], from[2]) + (std::max(one, other) - low);
    const auto [at, is_new] = vertices_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (!is_new) return at->second;
    const double here = value(from);
    const double share = std::clamp(here / (here - value(to)), nearest_to_sample, 1.0 - nearest_to_sample);
    const Point a = samples_.point(from[0], from[1], from[2]);
    const Point b = samples_.point(to[0], to[1], to[2]);
    Point x{};
    for (std::size_t axis = 0; axis < 3; ++axis) x[axis] = a[axis] + share * (b[axis] - a[axis]);
    mesh_.vertices.push_back(x);
    return at->second;
  }

  const GridSamples& samples_;
  bool right_handed_;
  std::unordered_map<std::uint64_t, std::uint32_t> vertices_;
  Mesh mesh_;
};

}  // namespace

Mesh level_surface(const GridSamples& samples) {
  return Marcher(samples)();
}

}  // namespace verisq::surface
