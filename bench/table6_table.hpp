/// Table 6 as one printed table: the paper, our methods, the peers, for points and pairs.
#pragma once

#include <span>
#include <string>

#include "bench/benchmark_rows.hpp"

namespace verisq::bench {

/// `devices` are the names of the devices' rows, such as "verisq_pocl". What did not run shows as a dash.
[[nodiscard]] std::string table6(const Rows& rows, std::span<const std::string> devices);

}  // namespace verisq::bench
