/// Reads the model format `verisq-model/1` (JSON) of the contract.
#pragma once

#include <filesystem>
#include <string_view>
#include <verisq/model.hpp>

namespace verisq {

/// Throws Error(input) with one line naming file, key and value for everything the contract refuses: syntax
/// errors, unknown keys, non-finite numbers, exponents outside (0, 2], non-positive semi-axes, a zero quaternion,
/// duplicate or unknown names; also for what is valid but not supported yet (`bend`, intervals, `csg` other than
/// a union of all primitives).
[[nodiscard]] Model read_model(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Model parse_model(std::string_view json, std::string_view name);

}  // namespace verisq
