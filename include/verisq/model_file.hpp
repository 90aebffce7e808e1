/// Reads and writes the model format `verisq-model/1` (JSON), docs/formats.md §2.
#pragma once

#include <filesystem>
#include <string_view>
#include <verisq/features.hpp>
#include <verisq/model.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

/// Throws Error(input) with one line naming file, key and value for everything the format refuses: syntax
/// errors, unknown keys, non-finite numbers, exponents outside (0, 2], non-positive semi-axes, a zero quaternion, a
/// bend whose curvature is not proven to be small enough (see Bend), duplicate or unknown names, an operator without
/// operands or a difference of one; and for intervals, which an exact model does not have. The keys `areas`
/// (`read_areas`) and `landmarks` (`read_model_landmarks`) are checked likewise and not part of the model.
[[nodiscard]] Model read_model(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Model parse_model(std::string_view json, std::string_view name);

/// The same with intervals [lo, hi] for semi-axes, exponents and elements of translations; what holds for a number must
/// hold at both ends. Refuses them in models that are not is_union_of_convex.
[[nodiscard]] UncertainModel read_uncertain_model(const std::filesystem::path& path);
[[nodiscard]] UncertainModel parse_uncertain_model(std::string_view json, std::string_view name);

/// Writes the file so that `read_model` gives the same bits; it appears under its name when it is complete. Throws
/// Error(failure) when it cannot be written. Precondition: a model that `read_model` accepts; names in UTF-8.
void write_model(const std::filesystem::path& path, const Model& model);
/// With named points (key `landmarks`), which `read_model_landmarks` gives, bit for bit. A head's radius is none.
void write_model(const std::filesystem::path& path, const Model& model, const FemurLandmarks& landmarks);

}  // namespace verisq
