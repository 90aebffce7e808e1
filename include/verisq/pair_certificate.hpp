/// What proves an enclosure of the distance of two models again, without device, solver or search.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/certificate.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// What bounds the distance of two convex primitives A and B from both sides. From below by
/// (v·c - h_A(v) - h_B(-v)) / |v|, where c leads from A's centre to B's; from above by the distance of the points
/// a / max(1, g_A(a)) of A and b / max(1, g_B(b)) of B. `vector` and `on_a` in A's own frame, `on_b` in B's.
struct Separation {
  std::uint32_t primitive_a;
  std::uint32_t primitive_b;
  Point vector;
  Point on_a;
  Point on_b;
};

/// A section of a primitive is its part between two heights of its own axis, before the bend.
enum class SectionCut : std::uint8_t {
  none,  ///< a plane separates the two sections
  a,     ///< that of A is halved: first what both cuts of the lower half, then what those of the upper half say
  b,     ///< that of B
};

/// Separates a section of A from one of B (docs/mathematics.md §9).
struct SectionPlane {
  Point normal;    ///< from A to B, in the frame of model A; of any length
  double slope_a;  ///< the number v of §9 that belongs to A's section; of no matter without a bend
  double slope_b;
};

/// Bounds the distance of two primitives from below, bent or not: by the least of their sections'.
struct DividedSeparation {
  std::uint32_t primitive_a;
  std::uint32_t primitive_b;
  std::vector<SectionCut> cuts;      ///< in preorder, first of both whole primitives
  std::vector<SectionPlane> planes;  ///< of each SectionCut::none, in this order
};

/// A ball that holds a primitive of one model, and how far the other model is from its centre.
struct EnclosingBall {
  std::uint32_t primitive;
  Point centre;       ///< in the frame of the other model
  double multiplier;  ///< μ of verify/pairs/enclosing_radius.hpp: of no matter where the primitive is a ball
  double distance;    ///< what `proof` proves of the signed distance of the centre to the other model
  Certificate proof;
};

/// A primitive of one model that is not bent, and how far it is from the other model, all of it.
struct SurroundedPrimitive {
  std::uint32_t primitive;
  double distance;          ///< what is proven: the other model has nothing as near
  std::vector<bool> cover;  ///< as Certificate::cover, of the primitive's neighbourhood (docs/mathematics.md §28)
};

/// Of models that both are is_union_of_convex `separations` count: the first decides the upper end, a pair without one
/// is far by its bounding spheres. Of all others `divisions`, balls, covers and `near_points` do.
struct PairCertificate {
  std::vector<Separation> separations = {};
  std::vector<DividedSeparation> divisions = {};
  std::vector<EnclosingBall> balls_a = {};  ///< about primitives of A
  std::vector<EnclosingBall> balls_b = {};
  std::vector<SurroundedPrimitive> covers_a = {};  ///< primitives of A
  std::vector<SurroundedPrimitive> covers_b = {};  ///< primitives of B
  /// A point of A in its frame, and one of B in its own: the distance is no more than theirs.
  std::optional<std::array<Point, 2>> near_points = {};
  /// A point of A's frame in both models: the distance is 0 and needs nothing else.
  std::optional<Point> common = {};
};

/// An enclosure that its certificate proves.
struct CertifiedDistance {
  Enclosure distance;
  PairCertificate certificate;
};

}  // namespace verisq
