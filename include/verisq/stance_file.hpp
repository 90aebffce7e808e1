/// Reads stance models (XML).
#pragma once

#include <filesystem>
#include <string_view>
#include <verisq/stance_model.hpp>

namespace verisq::stance {

/// Throws Error(input) with one line naming file, line and value for everything that is no such model: XML errors,
/// unknown elements and attributes, missing ones, numbers that are not finite, reversed ranges, names that are used
/// twice or unknown, masses and radii that are not positive.
[[nodiscard]] Model read_model(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Model parse_model(std::string_view xml, std::string_view name);

}  // namespace verisq::stance
