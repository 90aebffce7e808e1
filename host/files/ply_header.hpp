/// The header of a PLY file: which elements follow, with which properties, in which encoding.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/files/input_file.hpp"

namespace verisq {

enum class PlyEncoding { ascii, little_endian, big_endian };

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

[[nodiscard]] std::size_t bytes_of(PlyType type);
[[nodiscard]] bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;                   ///< any bytes but blanks
  std::string shown;                  ///< the name as messages show it
  PlyType type;                       ///< of the value, or of a list's entries
  std::optional<PlyType> count_type;  ///< of a list's length; nothing for a single value
};

struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;                        ///< at least one where count > 0
  std::map<std::string, std::size_t, std::less<>> positions;  ///< in `properties`, by name

  /// Position in `properties`; nothing when there is none of that name.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding;
  std::vector<PlyElement> elements;  ///< distinct names, in the order of the file
};

/// Reads up to and with the line `end_header`. Throws Error(input) with the line of what is wrong.
[[nodiscard]] PlyHeader read_ply_header(InputFile& file);

}  // namespace verisq
