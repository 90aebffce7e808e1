/// The surface of a label of a volume that a command is given.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <verisq/label_surface.hpp>
#include <verisq/label_volume.hpp>

namespace verisq::command_line {

struct LabelInput {
  std::uint16_t label;
  AnatomicalSpace space;
  double voxel_volume;   ///< of one
  Point voxel_lengths;   ///< of its sides
  LabelSurface surface;  ///< its triangles are small against the voxels
};

/// Throws Error(input), which names the labels of the file where `label` is not one of them or is missing, and there
/// are several; and where `space` is asked for of a file that does not say which one it is in. Without it: LPS.
[[nodiscard]] LabelInput read_label(const std::string& name, std::optional<std::uint16_t> label,
                                    std::optional<AnatomicalSpace> space);

}  // namespace verisq::command_line
