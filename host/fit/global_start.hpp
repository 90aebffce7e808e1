/// Where to begin: poses sampled evenly, then again around the best of them, cells without prospects left out.
#pragma once

#include <cstdint>
#include <vector>

#include "host/fit/local_refinement.hpp"

namespace verisq::fit_search {

struct Sampling {
  std::size_t samples;  ///< in all
  std::uint64_t seed;
  std::size_t keep;  ///< starts returned, at most
};

/// The best samples, best first, no two of them in one cell. Sizes stay at the middle of their intervals.
[[nodiscard]] std::vector<Ranked> global_start(const CandidateSpace& space, CandidateEvaluator& evaluator,
                                               const Requirements& asked, const Landscape& landscape,
                                               const Sampling& sampling, SearchWatch& watch);

}  // namespace verisq::fit_search
