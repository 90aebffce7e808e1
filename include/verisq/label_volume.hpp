/// Segmented volume images: a label a voxel, and where the voxels lie.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>
#include <verisq/model.hpp>

namespace verisq {

/// Which way x and y of a patient's coordinates grow; z grows to the head in both.
enum class AnatomicalSpace {
  lps,      ///< to the patient's left and back: DICOM, and the meshes that 3D Slicer exports
  ras,      ///< to the right and the front: NIfTI, and what 3D Slicer shows
  unknown,  ///< the file does not say
};

/// Voxel (i, j, k) has its centre at origin + i steps[0] + j steps[1] + k steps[2], in mm where the file says what its
/// numbers are; its label is labels[i + counts[0] (j + counts[1] k)]. Counts are at least 1, steps are linearly
/// independent, every number is finite.
struct LabelVolume {
  std::array<std::size_t, 3> counts;
  Point origin;
  std::array<Point, 3> steps;
  AnatomicalSpace space = AnatomicalSpace::unknown;
  std::vector<std::uint16_t> labels;
};

/// By extension, any case: `.nrrd` (attached, raw or gzip; as 3D Slicer writes label maps and, where segments do not
/// overlap, segmentations), `.nii` and `.nii.gz` (NIfTI-1). Coordinates are in LPS, whatever the file is in, or as they
/// stand where the file does not say. Throws Error(input) for other files, for those that end early or late, for values
/// that are no integer from 0 to 65535, and for axes that span no volume; docs/formats.md, section 3.
[[nodiscard]] LabelVolume read_label_volume(const std::filesystem::path& path);

struct LabelCount {
  std::uint16_t label;
  std::uint64_t voxels;
};

/// The labels but 0, the background, in ascending order.
[[nodiscard]] std::vector<LabelCount> labels_of(const LabelVolume& volume);

/// The same volume in other coordinates. Precondition: neither space is unknown, unless they are the same.
[[nodiscard]] LabelVolume in_space(LabelVolume volume, AnatomicalSpace space);

/// Of one voxel, to nearest.
[[nodiscard]] double voxel_volume(const LabelVolume& volume);

}  // namespace verisq
