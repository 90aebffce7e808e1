/// The page of `verisq stance --report FILE.html`: equilibrium, stability and motion for people to look at.
#pragma once

#include <string>

#include "host/command_line/stance_summary.hpp"

namespace verisq::command_line {

/// The page's data (report/README.md) as one line of JSON: what --json prints, and the points of the drawn body.
[[nodiscard]] std::string stance_page_data(const StanceSummary& summary);

/// Throws Error(failure).
void write_stance_page(const std::string& file, const StanceSummary& summary);

}  // namespace verisq::command_line
