/// The kind `insertion` of certificate files: distances along a way in, each with what proves it, and the bone that it
/// takes away (docs/formats.md §9).
#pragma once

#include <string>
#include <vector>

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] InsertionAnswer read_insertion(const JsonValue& root);

/// One letter each, as the format has them.
[[nodiscard]] std::string text_of(const std::vector<CubeDivision>& cubes);
[[nodiscard]] std::string text_of(const std::vector<WayCell>& cells);

}  // namespace verisq
