/// The page of an interactive report without its data; generated at build time from report/dist/page.html.
#pragma once

#include <string_view>

namespace verisq::report {

/// ASCII. Has one line `<!--verisq-report-data-->`, in whose place the report goes (report/README.md says how).
[[nodiscard]] std::string_view page_template();

}  // namespace verisq::report
