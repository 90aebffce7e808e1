/// The kind `deviation` of certificate files: claims, and the distances that prove them (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] DeviationAnswer read_deviation(const JsonValue& root);

/// One letter each, as the format has them.
[[nodiscard]] std::string text_of(const std::vector<PieceProof>& pieces);
[[nodiscard]] std::string text_of(const std::vector<PatchProof>& patches);

}  // namespace verisq
