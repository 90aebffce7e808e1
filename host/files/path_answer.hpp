/// The kind `path` of certificate files: two models, one of which moves, with what proves how near they come
/// (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] PathAnswer read_path_answer(const JsonValue& root);

}  // namespace verisq
