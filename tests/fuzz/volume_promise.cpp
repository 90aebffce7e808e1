/// Checks volumes that were accepted.
#include "tests/fuzz/volume_promise.hpp"

#include <cmath>
#include <verisq/files.hpp>

#include "tests/fuzz/promise.hpp"

namespace verisq::fuzz {
namespace {

void check_volume(const LabelVolume& volume) {
  for (const std::size_t count : volume.counts) check(count > 0, "counts are positive");
  check(volume.labels.size() == volume.counts[0] * volume.counts[1] * volume.counts[2], "every voxel has a label");
  for (const double coordinate : volume.origin) check(std::isfinite(coordinate), "origins are finite");
  for (const Point& step : volume.steps)
    for (const double coordinate : step) check(std::isfinite(coordinate), "steps are finite");
  check(voxel_volume(volume) > 0.0, "axes span a volume");
  std::uint64_t voxels = 0;
  for (const LabelCount& label : labels_of(volume)) voxels += label.voxels;
  check(voxels <= volume.labels.size(), "no voxel counts twice");
}

}  // namespace

void read_as_volume(const MemoryFile& file, Bytes bytes) {
  file.write(bytes);
  read_or_refuse(file.path().string(), [&] { check_volume(read_label_volume(file.path())); });
}

}  // namespace verisq::fuzz
