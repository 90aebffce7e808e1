/// The kind `insertion` of certificate files: distances along a way in, each with what proves it (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] InsertionAnswer read_insertion(const JsonValue& root);

}  // namespace verisq
