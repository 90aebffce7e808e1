/// A built page with its data, as one file.
#pragma once

#include <filesystem>
#include <string_view>

namespace verisq::report {

/// Puts `json` into the page's place for it (report/README.md), so that no text in it can end the script element around
/// it or open another. Throws Error(failure).
void write_filled_page(const std::filesystem::path& path, std::string_view page, std::string_view json);

}  // namespace verisq::report
