/// The readers of single volume formats.
#pragma once

#include <verisq/label_volume.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

/// Nearly Raw Raster Data (teem): a header of text, a blank line, the voxels. In LPS, unless its space is unknown.
[[nodiscard]] LabelVolume read_nrrd(InputFile& file);

/// NIfTI-1 in one file, packed or not: 348 bytes, then the voxels. Likewise.
[[nodiscard]] LabelVolume read_nifti(InputFile& file);

/// x and y of LPS and RAS are each other's negatives.
void turn_about_z(LabelVolume& volume);

/// Fails unless the axes of the volume span one.
void check_axes(const InputFile& file, const LabelVolume& volume);

}  // namespace verisq
