/// The readers' common part, and what can be asked of a volume.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <verisq/error.hpp>
#include <verisq/label_volume.hpp>

#include "host/files/volume_formats.hpp"
#include "host/files/words.hpp"
#include "host/mesh/determinant.hpp"

namespace verisq {
namespace {

LabelVolume read(InputFile& file, const std::string& name) {
  if (name.ends_with(".nrrd")) return read_nrrd(file);
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return read_nifti(file);
  file.fail_whole("volumes are read from .nrrd, .nii and .nii.gz");
}

}  // namespace

LabelVolume read_label_volume(const std::filesystem::path& path) {
  InputFile file(path);
  if (file.size() == 0) file.fail_whole("volumes are read from regular files only");
  try {
    return read(file, lower_case(path.filename().string()));
  } catch (const std::bad_alloc&) {
    file.fail_whole("the volume does not fit into memory");
  }
}

void turn_about_z(LabelVolume& volume) {
  const auto turn = [](Point& x) { x = {0.0 - x[0], 0.0 - x[1], x[2]}; };  // 0 stays 0
  turn(volume.origin);
  for (Point& step : volume.steps) turn(step);
}

void check_axes(const InputFile& file, const LabelVolume& volume) {
  // No scanner makes such voxels, and surfaces of them overflow or have no end.
  constexpr double finest = 1e-9;
  constexpr double farthest = 1e9;
  constexpr double most_elongated = 100.0;
  constexpr double flattest = 0.01;  // of a box with the same edges
  std::array<double, 3> lengths{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Point& step = volume.steps[axis];
    lengths[axis] = std::hypot(step[0], step[1], step[2]);
    if (!(lengths[axis] >= finest && lengths[axis] <= farthest)) {
      file.fail_whole(
          fmt::format("a voxel is {} long along axis {}: must be {} to {}", lengths[axis], axis, finest, farthest));
    }
    if (!(std::abs(volume.origin[axis]) <= farthest))
      file.fail_whole(fmt::format("its origin {} is more than {} away", volume.origin[axis], farthest));
  }
  const auto [shortest, longest] = std::ranges::minmax(lengths);
  if (longest > most_elongated * shortest) {
    file.fail_whole(fmt::format("its voxels are {} times as long as wide: at most {} is supported", longest / shortest,
                                most_elongated));
  }
  const double size = voxel_volume(volume);
  if (!(size >= flattest * lengths[0] * lengths[1] * lengths[2]))
    file.fail_whole(fmt::format("its axes span no volume: the size of a voxel is {}", size));
}

std::vector<LabelCount> labels_of(const LabelVolume& volume) {
  std::vector<std::uint64_t> voxels(std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1, 0);
  for (const std::uint16_t label : volume.labels) ++voxels[label];
  std::vector<LabelCount> result;
  for (std::size_t label = 1; label < voxels.size(); ++label)
    if (voxels[label] > 0) result.push_back({static_cast<std::uint16_t>(label), voxels[label]});
  return result;
}

LabelVolume in_space(LabelVolume volume, AnatomicalSpace space) {
  if (volume.space != space) turn_about_z(volume);
  volume.space = space;
  return volume;
}

double voxel_volume(const LabelVolume& volume) {
  return std::abs(determinant(volume.steps));
}

}  // namespace verisq
