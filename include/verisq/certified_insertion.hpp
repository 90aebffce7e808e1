/// The smallest distances along an implant's way in, with what proves them again.
#pragma once

#include <span>
#include <vector>
#include <verisq/insertion.hpp>
#include <verisq/insertion_certificate.hpp>

namespace verisq {

struct CertifiedInsertion {
  std::vector<MapResult> rows;  ///< what the certificates prove, each an enclosure of the smallest distance
  std::vector<InsertionCertificate> certificates;
  MapSummary summary;  ///< as of the rows that were found
};

/// Of what `smallest_distance_along` found with the same arguments. Rows are about as tight as those, and wide where a
/// certificate would have too many parts. Interrupted, it has the rows that are proven by then, the first ones; no
/// device is used. Throws Error(input) unless the implant is is_union_of_convex. Precondition: `found` has a row for
/// each point of the bone.
[[nodiscard]] CertifiedInsertion certified_insertion(std::span<const Pose> path, const Model& implant,
                                                     std::span<const Point> bone, const Insertion& found,
                                                     const InsertionOptions& options);

}  // namespace verisq
