/// Triangles and pairs whose distance to a tapered solid is known by how they are made: on the other side of a tangent
/// plane, a step away from it, with a known point nearest. Like tests/oracle/tapered_contact.hpp, shares nothing with
/// verify/.
#pragma once

#include <random>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "tests/oracle/real.hpp"

namespace verisq::oracle {

/// Both bounds hold for the rounded query: the half-space of the tangent plane holds the solid, and two points at hand
/// are `upper` apart, or one is common (0). They differ by the rounding of the query.
struct KnownTriangle {
  Triangle triangle;
  Real lower;
  Real upper;
};

/// The point nearest lies `apart` along the normal of a random point of the surface, on the triangle's face, on an edge
/// or at a corner. With a negative `apart` that point lies inside, unless it has come out again on the other side:
/// `upper` is then above 0, and the bounds far apart.
[[nodiscard]] KnownTriangle random_known_triangle(std::mt19937_64& random, const Primitive& solid, double apart);

/// Two solids in the frame of one model.
struct KnownPair {
  Primitive a;
  Primitive b;
  Real lower;
  Real upper;
};

/// Random solids with ratios of the ends up to `largest_ratio`; a random point of B's surface opposite to one of A's,
/// `apart` times the larger solid's largest semi-axis along the normal, B turned about it at random. The tangent planes
/// differ by the rounding of B's quaternion, which counts against `lower` times B's diameter.
[[nodiscard]] KnownPair random_known_pair(std::mt19937_64& random, double largest_ratio, double apart);

}  // namespace verisq::oracle
