/// The kind `fit` of certificate files: what a fit says of a bone's distances (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// The keys "criterion", "penetration_limit", "areas" and "area_runs" of the document. Fails at the first value that is
/// not such a one's.
[[nodiscard]] StatedTerms read_terms(const JsonValue& root);

/// Fails likewise.
[[nodiscard]] FitAnswer read_fit(const JsonValue& root);

}  // namespace verisq
