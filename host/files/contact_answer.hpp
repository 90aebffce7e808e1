/// The kind `contact` of certificate files: areas in contact, and the distances that prove them (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] ContactAnswer read_contact(const JsonValue& root);

}  // namespace verisq
