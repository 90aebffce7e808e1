/// Models whose numbers are known within bounds only (docs/mathematics.md §8), and the ordinary models that bracket
/// them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Each number is any of its interval; [x, x] is exact. Preconditions as for Superquadric, at both ends.
struct UncertainPrimitive {
  std::string name;
  std::array<Enclosure, 3> semi_axes;
  std::array<Enclosure, 2> exponents;
  std::array<Enclosure, 3> translation;
  std::array<double, 4> quaternion;
  std::optional<Bend> bend = {};
  double taper = 1.0;  ///< where it is not 1, all numbers of the model must be exact
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

/// What every member lies between. The solid grows with its semi-axes and shrinks as exponents rise; the primitives of
/// `smallest` and `largest` stand at the midpoints of their translations, from where none moves farther than `shift`.
/// For every member M, point q and triangle T (and other model in place of T, its own shift added):
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
