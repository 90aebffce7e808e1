/// The kind `fit` of certificate files: what a fit says of a bone's distances (docs/formats.md §9).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// The keys "criterion", "penetration_limit", "areas" and "area_runs" of the document. Fails at the first value that is
/// not such a one's.
[[nodiscard]] StatedTerms read_terms(const JsonValue& root);

/// [area, how many]; each area below so many `areas`, in all no more points than a mesh has indices for.
[[nodiscard]] std::vector<AreaRun> read_area_runs(const JsonValue& value, std::size_t areas);

/// The areas one by one. Precondition: `points_of` as many as fit into memory.
[[nodiscard]] std::vector<std::uint32_t> areas_of(std::span<const AreaRun> runs);

/// Fails likewise.
[[nodiscard]] FitAnswer read_fit(const JsonValue& root);

}  // namespace verisq
