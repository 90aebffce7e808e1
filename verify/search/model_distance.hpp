/// The distance of two unions of convex solids, and the points in which they are closest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "verify/proof/pair_checker.hpp"
#include "verisq/distance.hpp"

namespace verisq::verify {

// Proposes the certificate of a pair of superquadrics: closest points and the vector between them.

/// Everything in A's own frame but `on_b`, which is in B's.
struct PairContact {
  Proposal vector;  ///< from A to B
  Proposal on_a;
  Proposal on_b;
  std::optional<Proposal> common;  ///< a point of both solids, if they overlap; then the other members are useless
};

/// Proves nothing. `fast` works in binary64 and, if that does not converge, in long double; `thorough` finds the points
/// to 50 digits. GJK starts both. Then Newton's method minimises
///     ψ(v) = |v|^2/2 - v·c + h_A(v) + h_B(-v),
/// which is strongly convex with the separation vector as its minimiser. Its gradient F(v) = v - (b - a), with the
/// support points a and b, leaves a gap of |F|^2 / 2|v| between the two bounds. If a face's support point is too
/// sensitive to v, the midpoint m of the closest points is sought instead: it minimises d_A(m)^2 + d_B(m)^2.
[[nodiscard]] PairContact fast_pair_contact(const Superquadric& a, const Superquadric& b, const RigidMotion& relative);
[[nodiscard]] PairContact thorough_pair_contact(const Superquadric& a, const Superquadric& b,
                                                const RigidMotion& relative);

/// The same quantities with up to 127 bits, every interval a single number.
struct PreciseContact {
  PreciseVector vector;
  PreciseVector on_a;
  PreciseVector on_b;
};

/// Newton's method in 50 digits on the separation vector; nothing where that shrinks to zero, as for touching solids.
/// Precondition: `start` is not zero; the nearer it is to separating the solids best, the surer the method converges.
/// Exponents of 2 are replaced by nearby ones.
[[nodiscard]] std::optional<PreciseContact> refined_pair_contact(const Superquadric& a, const Superquadric& b,
                                                                 const RigidMotion& relative,
                                                                 const PreciseVector& start);

/// The thorough points, accurate to long double, with three vectors: the vector between them, and the normals of A and
/// of B. The components of each normal are accurate relative to themselves, as the faces of that solid require.
/// Precondition: disjoint solids.
[[nodiscard]] std::array<PreciseContact, 3> projected_pair_contacts(const Superquadric& a, const Superquadric& b,
                                                                    const RigidMotion& relative);

// The pairs of primitives that may be the nearest of two models, found in nanoseconds each.

struct PrimitivePair {
  std::uint32_t a;
  std::uint32_t b;
};

struct NearPairs {
  std::vector<PrimitivePair> pairs;  ///< at least one
  double others;                     ///< proven: all others are at least so far apart
};

// Lower bounds for pairs of primitives in one pose, kept for the poses that follow. Along a path few of many pairs are
// ever the nearest, and the distances of the others change by no more than their primitives move.

/// The place of a primitive of B in A's frame, in binary64.
struct Placement {
  std::array<double, 9> rotation;  ///< row by row
  Point centre;
  double radius;  ///< radius of a sphere about the centre that contains the primitive
  double size;    ///< magnitude of the numbers involved
  double width;   ///< by which the exact numbers may differ, beyond their rounding to binary64
};

[[nodiscard]] Placement placement_of(const PosedPairs& pairs, std::size_t j);

/// Upper bound of the distance of any point of the primitive from its former place. Rounded up.
[[nodiscard]] double displacement_up(const Placement& from, const Placement& to);

/// Lower bounds of the pairs of two models. Not for several threads at once.
class PairMemory {
 public:
  /// Forgets all unless the models have as many primitives as before.
  void look_at(const PosedPairs& pairs);

  /// Lower bound of the distance of a pair at B's present place; 0 if nothing is known. Precondition: `look_at`.
  [[nodiscard]] double lower(PrimitivePair pair) const;
  /// Precondition: `look_at`, and the pair is proven to be at least `lower` apart where B stands now.
  void keep(PrimitivePair pair, double lower);

  /// The last one that decided a distance, which is likely to decide the next.
  [[nodiscard]] std::optional<PrimitivePair> nearest() const { return nearest_; }
  void keep_nearest(PrimitivePair pair) { nearest_ = pair; }

 private:
  struct Known {
    double lower = 0.0;
    Placement at{};  ///< place of B's primitive for that bound
  };

  [[nodiscard]] std::size_t place(PrimitivePair pair) const { return pair.a * now_.size() + pair.b; }

  std::vector<Placement> now_;  // of B's primitives
  std::vector<Known> known_;
  std::optional<PrimitivePair> nearest_;
};

// Boxes that contain every pair of closest points of two models.

/// Two methods for each pair of primitives (A, B) that `found` does not prove to be farther than the nearest:
///
/// By Krawczyk's operator. The support functions are differentiable if both exponents are below 2, and
///     ψ(v) = |v|^2/2 - v·c + h_A(v) + h_B(-v)
/// is strictly convex: its gradient F(v) = v - c + s_A(v) - s_B(-v) has at most one zero v* other than 0. There
/// v* = b - a for the points a = s_A(v*) and b = c + s_B(-v*), which are therefore the closest points. For a maximises
/// v*·x over A, b minimises it over B, so no two points are closer than |v*|. Krawczyk's operator proves that a box V
/// contains a zero of F; then s_A(V) and c + s_B(-V) contain the closest points, the only ones. If (a', b') were a
/// second pair, a strictly convex A would contain a ball about (a + a')/2, a point of which is closer to (b + b')/2.
///
/// By caps. For d* <= hi, every pair of closest points has v·(b - a) <= |v| hi and, with v·b >= v·c - h_B(-v),
/// v·a >= h_A(v) - η where η = |v| hi - (v·c - h_A(v) - h_B(-v)); alike for b. Over that cap of A, for every direction
/// e and every t >= 0, e·x <= h_A(e + t v) - t (h_A(v) - η). It contains every pair, whether there is one or many.
///
/// `unique` is proven if one pair of primitives remains and one of its two solids is strictly convex (both exponents
/// below 2), by the same argument, which needs no computation. Precondition: `found` is the answer for these pairs,
/// separated and complete. Nothing is returned if no pair of `found` remains, or once `interrupted` returns true.
[[nodiscard]] std::optional<ClosestPoints> closest_points(const PosedPairs& pairs, const ModelDistance& found,
                                                          const std::function<bool()>& interrupted);

}  // namespace verisq::verify
