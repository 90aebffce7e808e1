/// The soundness question of every proof: does an enclosure contain the reference distance?
#pragma once

#include <optional>
#include <string>
#include <verisq/enclosure.hpp>

#include "tests/oracle/pair_reference.hpp"
#include "tests/oracle/reference_distance.hpp"
#include "tests/oracle/triangle_reference.hpp"

namespace verisq::oracle {

/// The evidence that `enclosure` misses the signed distance of `point`, in one line that reproduces the case; empty
/// when there is none. Inside, an end above the reference first sends the reference to search thoroughly, because its
/// usual search could have missed the nearest boundary point.
[[nodiscard]] std::optional<std::string> escape(const Enclosure& enclosure, const Primitive& primitive,
                                                const Point& point, const ReferenceDistance& reference);

/// The same of the distance of a triangle, and of two solids; those references are proven on both sides.
[[nodiscard]] std::optional<std::string> escape(const Enclosure& enclosure, const Primitive& primitive,
                                                const Triangle& triangle, const TriangleReference& reference);
[[nodiscard]] std::optional<std::string> escape(const Enclosure& enclosure, const Primitive& a, const Primitive& b,
                                                const PairReference& reference);

/// Width of the reference in units of PosedSolid::magnitude; above 1e-30 the reference did not converge.
[[nodiscard]] double relative_gap(const ReferenceDistance& reference, const PosedSolid& solid, const Point& point);

}  // namespace verisq::oracle
