/// The kind `features` of certificate files: landmarks, and what is claimed of them (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] FeaturesAnswer read_features(const JsonValue& root);

}  // namespace verisq
