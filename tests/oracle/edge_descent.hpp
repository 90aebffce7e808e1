/// Slides a boundary point along the face, edge or corner it is near to, to where the distance to a query is least.
#pragma once

#include "tests/oracle/placed_model.hpp"

namespace verisq::oracle {

/// A point of the set that is at most as far from q as `start`, which lies in the set. Random search stalls where two
/// boundaries meet, because only a sliver along the edge is nearer; here the boundaries that are near the point hold as
/// equations g_i = 1, each choice of up to three of them, and projected gradients lead down. Proves nothing.
[[nodiscard]] Point slid_along_edges(const PlacedModel& model, Membership set, const Point& q, const Point& start);

}  // namespace verisq::oracle
