/// Proposes the certificate of a pair of superquadrics: closest points and the vector between them.
#pragma once

#include <array>
#include <optional>

#include "verify/proof/pair_checker.hpp"

namespace verisq::verify {

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

}  // namespace verisq::verify
