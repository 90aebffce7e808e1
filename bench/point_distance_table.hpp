/// The tables that the point distance benchmark prints at its end: the paper's Table 6 beside ours, peers, costs.
#pragma once

#include <span>
#include <string>

#include "bench/benchmark_rows.hpp"

namespace verisq::bench {

/// `tools` are the names of the devices' rows, such as "verisq_pocl". What did not run shows as nan.
[[nodiscard]] std::string point_distance_tables(const Rows& rows, std::span<const std::string> tools);

}  // namespace verisq::bench
