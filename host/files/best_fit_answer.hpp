/// The kind `best_fit` of certificate files: how good a fit can be at best, with what proves it (docs/formats.md §9).
#pragma once

#include <string>
#include <vector>

#include "host/files/json_document.hpp"
#include "verisq/best_fit_certificate.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] BestFitAnswer read_best_fit(const JsonValue& root);

/// A letter each: x, y, z along an axis, u, v, w about it, a full stop where nothing is halved.
[[nodiscard]] std::string text_of(const std::vector<PoseDivision>& divisions);

}  // namespace verisq
