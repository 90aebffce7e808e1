/// The pages of interactive reports without their data; generated at build time from report/dist.
#pragma once

#include <string_view>

namespace verisq::report {

/// ASCII. Has one line `<!--verisq-report-data-->`, in whose place the report goes (report/README.md says how).
[[nodiscard]] std::string_view page_template();

/// The same of `verisq stance`.
[[nodiscard]] std::string_view stance_page_template();

/// report/src/theme.css: the colours of all pages.
[[nodiscard]] std::string_view theme_style();

}  // namespace verisq::report
