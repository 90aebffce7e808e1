/// The kind `equilibrium` of certificate files, docs/formats.md §9.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/files/json_document.hpp"

namespace verisq {

/// Throws Error(input) naming key and value for what the format does not allow.
[[nodiscard]] EquilibriumAnswer read_equilibrium(const JsonValue& root);

}  // namespace verisq
