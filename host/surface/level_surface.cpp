/// Surfaces of labels, as level sets of the volume.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/surface.hpp>

#include "host/prepare/mesh_geometry.hpp"
#include "host/surface/surface_steps.hpp"

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

  /// The vertex on the edge between two corners of the cell, of which one is inside: one vertex for all cells that
  /// share the edge.
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

namespace verisq {
namespace {

constexpr double gaussian_width = 0.7;  ///< in voxels
constexpr std::ptrdiff_t reach = 3;     ///< in voxels: beyond four widths
constexpr std::ptrdiff_t margin = reach + 1;

/// Voxels of a label, first and last along each axis.
struct LabelBox {
  std::array<std::ptrdiff_t, 3> first;
  std::array<std::ptrdiff_t, 3> last;
  std::uint64_t voxels = 0;
  std::uint64_t voxels_at_border = 0;
};

LabelBox box_of(const LabelVolume& volume, std::uint16_t label) {
  LabelBox box{};
  const auto& counts = volume.counts;
  std::size_t at = 0;
  for (std::size_t k = 0; k < counts[2]; ++k) {
    for (std::size_t j = 0; j < counts[1]; ++j) {
      for (std::size_t i = 0; i < counts[0]; ++i) {
        if (volume.labels[at++] != label) continue;
        const std::array<std::size_t, 3> place{i, j, k};
        bool at_border = false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto here = static_cast<std::ptrdiff_t>(place[axis]);
          box.first[axis] = box.voxels == 0 ? here : std::min(box.first[axis], here);
          box.last[axis] = box.voxels == 0 ? here : std::max(box.last[axis], here);
          at_border = at_border || place[axis] == 0 || place[axis] + 1 == counts[axis];
        }
        ++box.voxels;
        if (at_border) ++box.voxels_at_border;
      }
    }
  }
  return box;
}

/// 1 in the label, 0 elsewhere, in its box with a margin.
surface::GridSamples indicator(const LabelVolume& volume, std::uint16_t label, const LabelBox& box) {
  surface::GridSamples samples{.counts = {}, .origin = volume.origin, .steps = volume.steps, .values = {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    samples.counts[axis] = static_cast<std::size_t>(box.last[axis] - box.first[axis] + 1 + 2 * margin);
    for (std::size_t row = 0; row < 3; ++row)
      samples.origin[row] += static_cast<double>(box.first[axis] - margin) * volume.steps[axis][row];
  }
  samples.values.assign(samples.counts[0] * samples.counts[1] * samples.counts[2], 0.0F);
  const auto offset = static_cast<std::size_t>(margin);
  for (std::size_t k = offset; k + offset < samples.counts[2]; ++k) {
    for (std::size_t j = offset; j + offset < samples.counts[1]; ++j) {
      const std::size_t row =
          static_cast<std::size_t>(box.first[0]) +
          volume.counts[0] * (j - offset + static_cast<std::size_t>(box.first[1]) +
                              volume.counts[1] * (k - offset + static_cast<std::size_t>(box.first[2])));
      for (std::size_t i = offset; i + offset < samples.counts[0]; ++i)
        if (volume.labels[row + i - offset] == label) samples.values[samples.index(i, j, k)] = 1.0F;
    }
  }
  return samples;
}

std::array<float, 2 * reach + 1> gaussian() {
  std::array<double, 2 * reach + 1> weights{};
  double sum = 0.0;
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    const double x = static_cast<double>(k) / gaussian_width;
    sum += weights[static_cast<std::size_t>(k + reach)] = std::exp(-x * x / 2.0);
  }
  std::array<float, 2 * reach + 1> result{};
  for (std::size_t k = 0; k < weights.size(); ++k) result[k] = static_cast<float>(weights[k] / sum);
  return result;
}

/// Rows along an axis, `stride` between neighbours; beyond the ends there is nothing of the label.
void smooth_row(float* row, std::size_t count, std::size_t stride, std::vector<float>& padded) {
  static const auto weights = gaussian();
  padded.assign(count + 2 * static_cast<std::size_t>(reach), 0.0F);
  for (std::size_t k = 0; k < count; ++k) padded[k + static_cast<std::size_t>(reach)] = row[k * stride];
  for (std::size_t k = 0; k < count; ++k) {
    float sum = 0.0F;
    for (std::size_t w = 0; w < weights.size(); ++w) sum += weights[w] * padded[k + w];
    row[k * stride] = sum;
  }
}

void smooth(surface::GridSamples& samples) {
  const auto& [nx, ny, nz] = samples.counts;
  std::vector<float> padded;
  float* values = samples.values.data();
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t j = 0; j < ny; ++j) smooth_row(values + samples.index(0, j, k), nx, 1, padded);
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t i = 0; i < nx; ++i) smooth_row(values + samples.index(i, 0, k), ny, nx, padded);
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) smooth_row(values + samples.index(i, j, 0), nz, nx * ny, padded);
}

}  // namespace

LabelSurface label_surface(const LabelVolume& volume, std::uint16_t label) {
  const LabelBox box = box_of(volume, label);
  if (box.voxels == 0) throw Error(ErrorKind::input, fmt::format("no voxel has the label {}", label));
  surface::GridSamples samples = indicator(volume, label, box);
  smooth(samples);
  for (float& value : samples.values) value -= 0.5F;
  surface::LargestPart part = surface::largest_part(surface::level_surface(samples));
  if (part.mesh.triangles.empty())
    throw Error(ErrorKind::input, fmt::format("label {}: it is thinner than a voxel everywhere", label));
  return {.mesh = std::move(part.mesh),
          .parts_left_out = part.parts_left_out,
          .voxels = box.voxels,
          .voxels_at_border = box.voxels_at_border};
}

}  // namespace verisq
