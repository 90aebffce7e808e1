/// Pages of a report: their data as text, and the data that they need to prove rows again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/report.hpp>

#include "host/files/input_file.hpp"

namespace verisq::report {

// Bytes as text (RFC 4648, with padding).

[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

// A column of numbers as text: base64 of its little-endian bytes.

template <class Number>
[[nodiscard]] std::string column_text(std::vector<Number> numbers) {
  if constexpr (sizeof(Number) > 1) {
    std::ranges::transform(numbers, numbers.begin(), [](Number number) { return in_little_endian(number); });
  }
  return base64(std::as_bytes(std::span(numbers)));
}

// The data that a page needs to prove its rows again.

/// The key `proof` of the data (report/README.md): null if the report has none. Throws Error(input) if one of its files
/// cannot be read.
[[nodiscard]] nlohmann::ordered_json proof_data(const Report& report);

// A built page with its data, as one file.

/// Puts `json` into the page's place for it (report/README.md), so that no text in it can end the script element around
/// it or open another. Throws Error(failure).
void write_filled_page(const std::filesystem::path& path, std::string_view page, std::string_view json);

}  // namespace verisq::report
