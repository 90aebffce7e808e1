/// Table 7 as one printed table: the paper's seconds and widths beside ours, and our poses.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "bench/benchmark_rows.hpp"

namespace verisq::bench {

struct SearchGoal {
  std::string_view row;  ///< part of the row's name
  double width;
};

inline constexpr std::array<SearchGoal, 3> table7_goals{
    {{"width_0.1", 0.1}, {"width_0.01", 0.01}, {"width_1e-6", 1e-6}}};
inline constexpr std::string_view table7_tool = "verisq_search";

/// What did not run shows as a dash.
[[nodiscard]] std::string table7(const Rows& rows);

}  // namespace verisq::bench
