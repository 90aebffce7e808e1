/// What proves an enclosure of the distance of two models again, without device, solver or search.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// What bounds the distance of two primitives A and B from both sides. From below by (v·c - h_A(v) - h_B(-v)) / |v|,
/// where c leads from A's centre to B's; from above by the distance of the points a / max(1, g_A(a)) of A and b /
/// max(1, g_B(b)) of B. `vector` and `on_a` in A's own frame, `on_b` in B's.
struct Separation {
  std::uint32_t primitive_a;
  std::uint32_t primitive_b;
  Point vector;
  Point on_a;
  Point on_b;
};

/// The first separation decides the upper end; a pair without one is far by its bounding spheres. With `common`, a
/// point of the frame of model A that lies in both models, the distance is 0 and needs nothing else.
struct PairCertificate {
  std::vector<Separation> separations;
  std::optional<Point> common;
};

/// What `certificate` proves about the distance of A and of B moved by `pose`, whatever it holds: an enclosure of the
/// exact distance, [0, infinity] if it proves nothing. By MPFR alone, without any search. Primitives that a model does
/// not have, and vectors and points that are not finite, prove nothing. Throws Error(input) unless both models are
/// is_union_of_convex.
[[nodiscard]] Enclosure prove(const Model& a, const Model& b, const Pose& pose, const PairCertificate& certificate);

/// What that says of a claim about this distance: never `proved` of an enclosure that does not contain it. Throws
/// likewise. Precondition: `claimed` holds no NaN.
[[nodiscard]] Finding check(const Model& a, const Model& b, const Pose& pose, const Enclosure& claimed,
                            const PairCertificate& certificate);

}  // namespace verisq
