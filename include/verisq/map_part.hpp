/// Parts of a map that several processes make, and the whole that they are merged to: bit by bit what one process
/// writes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/closest_points.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>

namespace verisq {

/// Rows `first` ... `first + count - 1`.
struct RowRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;

  [[nodiscard]] bool operator==(const RowRange&) const = default;
};

/// The rows of part `part`, from 1 on, of `parts` of a map of `rows` rows: whole blocks of `rows_per_block`, but for
/// the last one's end, as evenly as that goes. Where there are more parts than blocks some are empty. Precondition: 1
/// <= part
/// <= parts.
[[nodiscard]] RowRange rows_of_part(std::uint64_t part, std::uint64_t parts, std::uint64_t rows);

/// Something that all parts of a map must have in common.
struct PartSetting {
  std::string name;
  std::string value;
};

/// What stands beside a part of a map: what it is a part of, and what its file is.
struct MapPart {
  std::string version = {};  ///< of the library
  std::uint64_t part = 1;
  std::uint64_t parts = 1;
  RowRange rows = {};
  std::uint64_t rows_in_all = 0;
  SubjectFile map = {};                          ///< the part's own file
  std::vector<SubjectFile> models = {};          ///< of poses two
  SubjectFile input = {};                        ///< whose vertices, triangles, points or poses the rows are of
  MapElements elements = MapElements::vertices;  ///< which of them
  std::vector<PartSetting> settings = {};        ///< whatever else rows depend on, and their form
  MapSummary summary = {};                       ///< of its rows
  std::optional<ClosestPointSummary> closest = {};
};

/// The name of the file beside a part: that of the part with ".part.json" added.
[[nodiscard]] std::filesystem::path part_file_of(const std::filesystem::path& map);

/// Of a file of any size, read front to back in constant memory. Throws Error(input) as `subject_file`, and for what is
/// no regular file.
[[nodiscard]] SubjectFile digest_of_file(const std::filesystem::path& path);

/// Writes the file beside `map` (docs/formats.md §10). Throws Error(failure).
void write_map_part(const std::filesystem::path& map, const MapPart& part);

/// Reads the file beside `map`. Throws Error(input) naming file, key and value for what the format does not allow.
[[nodiscard]] MapPart read_map_part(const std::filesystem::path& map);

struct MergeOptions {
  bool mixed_devices = false;  ///< accept rows of several devices: valid, but not what one process writes
};

/// What `merge_maps` made: what the parts have in common, and the summary of all rows. Seconds are added up.
struct MergedMap {
  MapPart whole;                     ///< part 1 of 1
  std::vector<std::string> devices;  ///< each once
};

/// Writes the whole map of these parts, given in any order, `.csv` or `.npy` as they are: in constant memory, and under
/// its name only when it is complete. Throws Error(input), one line, for parts that are missing or there twice, of
/// other models, inputs, settings, devices or versions, whose files are not those that were written, and for an output
/// that is a part. Throws Error(failure) when the output cannot be written.
MergedMap merge_maps(std::span<const std::filesystem::path> paths, const std::filesystem::path& output,
                     const MergeOptions& options = {});

}  // namespace verisq
