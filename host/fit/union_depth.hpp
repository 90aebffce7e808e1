/// Depths inside the union of an implant's primitives: in their overlaps it is deeper than each of them. Distances to
/// sets at whose edges the search's are too small.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "host/fit/candidate_evaluation.hpp"
#include "verisq/cavity.hpp"

namespace verisq::fit_search {

struct UnionDepth {
  double objective;            ///< F
  double deepest_penetration;  ///< >= 0
};

/// `distances` are the search's of every point to the posed implant; those of points inside are replaced by the
/// union's, proven to about 1e-9 of the implant's radius. Of bent implants and other sets all points' are, by a map on
/// `device`, to about 1e-6 of it. `interrupted` is polled by many threads in turn; afterwards the search's distances
/// stay.
[[nodiscard]] UnionDepth union_depth(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                                     std::span<const PointDistance> distances, const std::string& device,
                                     const std::function<bool()>& interrupted);

}  // namespace verisq::fit_search
