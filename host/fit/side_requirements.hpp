/// On which side of the cavity's surface the parts of an implant have to be, as the search sees it: by sample points.
#pragma once

#include <cstddef>
#include <span>
#include <vector>
#include <verisq/sides.hpp>

#include "host/fit/candidate_evaluation.hpp"
#include "host/fit/inside_test.hpp"

namespace verisq::fit_search {

class SideRequirements {
 public:
  /// Of an implant that may be anywhere.
  SideRequirements() = default;
  /// One a primitive. `inside` must outlive it.
  SideRequirements(const InsideTest& inside, std::span<const SurfaceSide> required);

  /// How many samples lie on the wrong side: the centres of primitives and the ends of their axes, drawn in a little.
  [[nodiscard]] std::size_t misplaced(const Candidate& candidate) const;

 private:
  const InsideTest* inside_ = nullptr;
  std::vector<SurfaceSide> required_;
};

}  // namespace verisq::fit_search
