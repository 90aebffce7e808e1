/// Options that several commands have, with the same words for the same thing.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// A model file by the option `name`.
void require_model(Options& options, const std::string& name, std::string& file);

/// --tol of enclosures, 0 for the tightest; `owner`: whose bounding sphere the default is in proportion to, "the
/// model".
void add_tolerance(Options& options, std::optional<double>& tolerance, std::string_view owner);

/// --device.
void add_device(Options& options, std::string& device);
inline constexpr const char* device_explanation =
    "auto (default), host (no OpenCL), or an index or part of a name from `verisq devices`";
/// Of what has rows.
inline constexpr const char* device_of_map_explanation =
    "auto (default: a device, for at most 128 rows the host), host (no OpenCL), or an index or part of a name\n"
    "from `verisq devices`";

/// What -o says of a map.
inline constexpr const char* map_explanation = "The map, by extension: .csv .npy .vtp .ply .json";

/// --json, of a summary.
void add_json(Options& options, bool& json);
/// --json, of a summary with enclosures, whose ends may be infinite.
void add_json_of_enclosures(Options& options, bool& json);

/// --no-progress.
void add_no_progress(Options& options, bool& no_progress);

}  // namespace verisq::command_line
