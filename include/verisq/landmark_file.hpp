/// Reads and writes landmarks of a femur: `verisq-landmarks/1` (docs/formats.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <verisq/features.hpp>

namespace verisq {

struct LandmarkFile {
  FemurLandmarks landmarks;
  std::optional<Side> side;  ///< nothing when the file does not say
};

/// Throws Error(input) naming file, key and value for what the format does not allow.
[[nodiscard]] LandmarkFile read_landmarks(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] LandmarkFile parse_landmarks(std::string_view json, std::string_view name);

/// The same landmarks are read again, bit for bit. The file appears when it is complete. Throws Error(failure).
void write_landmarks(const std::filesystem::path& path, const LandmarkFile& file);

/// The points that a model file names (key `landmarks`), in the model's coordinates: of an implant its head's centre
/// and points on the axes of neck and shaft. None where it has no such key. Throws Error(input) as
/// `read_uncertain_model`.
[[nodiscard]] FemurLandmarks read_model_landmarks(const std::filesystem::path& model);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] FemurLandmarks parse_model_landmarks(std::string_view json, std::string_view name);

}  // namespace verisq
