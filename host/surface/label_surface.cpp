/// The box of a label, smoothed along one axis after the other, and its surface.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/label_surface.hpp>

#include "host/surface/grid_samples.hpp"
#include "host/surface/largest_part.hpp"
#include "host/surface/level_surface.hpp"

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
