/// Reads and writes landmarks of a femur: `verisq-landmarks/1` (docs/formats.md).
#pragma once

#include <filesystem>
#include <optional>
#include <verisq/features.hpp>

namespace verisq {

struct LandmarkFile {
  FemurLandmarks landmarks;
  std::optional<Side> side;  ///< nothing when the file does not say
};

/// Throws Error(input) naming file, key and value for what the format does not allow.
[[nodiscard]] LandmarkFile read_landmarks(const std::filesystem::path& path);

/// The same landmarks are read again, bit for bit. The file appears when it is complete. Throws Error(failure).
void write_landmarks(const std::filesystem::path& path, const LandmarkFile& file);

}  // namespace verisq
