/// Models: superquadrics and closed meshes in their place, unions and set operations of them, with exact sizes or
/// intervals.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>

namespace verisq {

// Solids: posed superquadrics, bent or not, and trees of set operations on them, exactly as the user's binary64
// numbers state them.

/// A point or vector in model units: x, y, z.
using Point = std::array<double, 3>;

/// The solid of the paper's Eq. (1), centred at the origin, convex:
/// ((x/a1)^(2/e2) + (y/a2)^(2/e2))^(e2/e1) + (z/a3)^(2/e1) <= 1.
/// A taper t scales the sections along z linearly, by 2/(1 + t) at the lower end z = -a3, 1 in the middle, 2t/(1 + t)
/// at the upper end, so that those of the ends have the ratio t, and moves them along z so that the solid stays convex:
/// with k = (t - 1)/(t + 1), the point (x, y, z) of Eq. (1) goes to ((1 + k z'/a3) x, (1 + k z'/a3) y, z'), where
/// z' = (z - k a3)/(1 - k z/a3) (docs/mathematics.md §18).
/// Precondition everywhere: semi-axes positive and finite, exponents in (0, 2], taper from smallest_taper to
/// largest_taper.
struct Superquadric {
  std::array<double, 3> semi_axes;  ///< a1, a2, a3 in model units
  std::array<double, 2> exponents;  ///< e1 (along z), e2 (in the x-y section)
  double taper = 1.0;               ///< t: section at z = a3 over that at z = -a3
};

/// Rigid motion from a primitive's own frame to the model's: x -> R x + t, where R is the rotation of the
/// quaternion [w, x, y, z] divided by its exact length. Precondition: finite, quaternion not zero.
struct Pose {
  Point translation{0.0, 0.0, 0.0};
  std::array<double, 4> quaternion{1.0, 0.0, 0.0, 0.0};
};

/// Bends a primitive, in its own frame, along the z axis towards the direction at `angle_degrees` from x to y: the axis
/// becomes an arc of curvature k in that plane (paper Eq. (2), docs/mathematics.md §9). With r = x cos a + y sin a,
/// s = y cos a - x sin a, the point (r, s, z) moves to (1/k - (1/k - r) cos kz, s, (1/k - r) sin kz); k = 0 leaves
/// everything in place. Precondition: finite; |k| times the largest |r| of the solid below 1, |k| a3 below pi.
struct Bend {
  double curvature;  ///< k, 1 / model unit
  double angle_degrees;
};

struct Mesh;

struct Primitive {
  std::string name;
  Superquadric superquadric;  ///< all zeros where the solid is a mesh
  Pose pose;
  std::optional<Bend> bend = {};
  /// The solid, instead of a superquadric: the triangles of a closed mesh, and every point about which they wind
  /// (docs/mathematics.md §29). Copies of a model share it. Precondition: not bent.
  std::shared_ptr<const Mesh> mesh = {};
};

/// A closed mesh as a primitive. Throws Error(input) for what is no solid: a mesh without triangles, or one that is not
/// closed, with the number of its open edges. Precondition: indices in range, finite coordinates.
[[nodiscard]] Primitive mesh_primitive(std::string name, Mesh mesh, const Pose& pose = {});

enum class SetOperation : std::uint8_t { unite, intersect, subtract };

/// A tree of set operations on closed sets. A difference removes from its first operand the interiors of all others,
/// so that the cut faces stay. Precondition: no cycles; an operator has at least one operand.
struct SetExpression {
  std::vector<SetExpression> operands = {};  ///< none: the primitive itself
  SetOperation operation = SetOperation::unite;
  std::uint32_t primitive = 0;  ///< index in Model::primitives, where there are no operands
};

struct Model {
  std::string units;                      ///< free text, as in the file ("mm"); empty when not given
  std::vector<Primitive> primitives;      ///< at least one
  std::optional<SetExpression> csg = {};  ///< nothing: the union of all primitives
};

/// Beyond, a solid is a cone but for its point.
inline constexpr double smallest_taper = 0.01;
inline constexpr double largest_taper = 100.0;

/// Whether the taper changes anything.
[[nodiscard]] constexpr bool is_tapered(const Superquadric& superquadric) {
  return superquadric.taper != 1.0;
}

/// True if a primitive is a mesh.
[[nodiscard]] bool has_mesh(const Model& model);

/// True if the primitive has a bend that moves anything: without one a superquadric is convex.
[[nodiscard]] bool is_bent(const Primitive& primitive);

/// The name of a primitive for messages: its own, or "primitives[2]" where it has none. Precondition: it is there.
[[nodiscard]] std::string name_of_primitive(const Model& model, std::size_t primitive);

/// True if the model is the union of all its primitives, none of them bent or a mesh. The certificates of
/// docs/mathematics.md §2 are made for it. Anything else is searched by branch and bound (§9 to §11).
[[nodiscard]] bool is_union_of_convex(const Model& model);

// Models whose numbers are known within bounds only (docs/mathematics.md §8), and the ordinary models that bracket
// them.

/// Each number is any of its interval; [x, x] is exact. Preconditions as for Superquadric, at both ends.
struct UncertainPrimitive {
  std::string name;
  std::array<Enclosure, 3> semi_axes;
  std::array<Enclosure, 2> exponents;
  std::array<Enclosure, 3> translation;
  std::array<double, 4> quaternion;
  std::optional<Bend> bend = {};
  double taper = 1.0;                     ///< where it is not 1, all numbers of the model must be exact
  std::shared_ptr<const Mesh> mesh = {};  ///< as Primitive::mesh; then all numbers of the model must be exact
};

/// The members of the model take their numbers from the intervals independently of each other. Of models with bends, or
/// set operations other than the union of all primitives, translations are exact.
struct UncertainModel {
  UncertainModel() = default;
  /// An ordinary model is an uncertain one with every interval a single number: it may stand wherever one is asked for.
  UncertainModel(const Model& exact);

  std::string units;
  std::vector<UncertainPrimitive> primitives;
  std::optional<SetExpression> csg;
};

/// Whether the model is an ordinary one.
[[nodiscard]] bool is_exact(const UncertainModel& model);

/// The smallest and the largest solid, between which every member lies. The solid grows with its semi-axes and shrinks
/// as exponents rise; the primitives of `smallest` and `largest` stand at the midpoints of their translations, from
/// where none moves farther than `shift`. For every member M, point q and triangle T (and other model in place of T,
/// its own shift added):
///
///   sd(q, M) <= min over the primitives K of `smallest` of sd(q, K), plus shift
///   sd(q, M) >= sd(q, largest) - shift    where that is positive, and always if M has one primitive
///   sd(q, M) >= sd(q, inflated)
///   d(T, largest) - shift <= d(T, M) <= d(T, smallest) + shift
///
/// Elsewhere sd(q, largest) - shift is no lower bound: solids on either side of a narrow gap may move together, and a
/// point in the gap then lies deep in their union.
/// Obligation: the upper end asks for the minimum over primitives, not for sd(q, smallest), which is less where solids
/// overlap and which a small motion may raise by any amount. A proof by several primitives together must not be
/// combined with `shift`: the upper ends of certificates are each proven by one primitive, others need not be.
struct Bracket {
  Model smallest;
  Model largest;
  std::optional<Model> inflated;  ///< contains every member, wherever it moved; only where `largest` does not serve:
                                  ///< in unions, if shift > 0
  double shift;                   ///< rounded up
};

/// An exact model is its own bracket. Where a difference removes solids that are uncertain, `smallest` has the largest
/// of these and `largest` the smallest: what is removed shrinks where the solid grows. Both models then list the
/// primitives that the tree names, those removed apart from those kept, in the order in which it does. Throws
/// Error(input) if the translation of a primitive is so uncertain that sizes overflow, for a model that is not exact
/// where a primitive is tapered, and for uncertain translations unless the model is the union of all its primitives,
/// none bent.
[[nodiscard]] Bracket bracket(const UncertainModel& model);

}  // namespace verisq
