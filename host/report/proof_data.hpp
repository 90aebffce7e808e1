/// What a page needs to prove its rows again.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <verisq/report.hpp>

namespace verisq::report {

/// The key `proof` of the data (report/README.md): null where the report has none. Throws Error(input) where a file of
/// it cannot be read.
[[nodiscard]] nlohmann::ordered_json proof_data(const Report& report);

}  // namespace verisq::report
