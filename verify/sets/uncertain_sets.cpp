/// Brackets of models with set operations: what a tree removes is largest where the solid is smallest.
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "verify/proof/bracketed.hpp"
#include "verify/proof/convex_union.hpp"
#include "verisq/uncertain_model.hpp"

namespace verisq {
namespace {

bool removes(const SetExpression& expression) {
  return (expression.operation == SetOperation::subtract && expression.operands.size() > 1) ||
         std::ranges::any_of(expression.operands, removes);
}

/// The primitives that a tree names, those that it removes apart from those that it keeps: a solid grows where what it
/// keeps grows, and shrinks where what it removes does (docs/mathematics.md §8).
class NamedPrimitives {
 public:
  struct Use {
    std::uint32_t primitive;
    bool removed;
    bool operator==(const Use&) const = default;
  };

  /// The same tree, with indices of uses(). What is removed from something that is removed is kept.
  [[nodiscard]] SetExpression renamed(const SetExpression& expression, bool removed = false) {
    SetExpression result{.operation = expression.operation};
    for (std::size_t i = 0; i < expression.operands.size(); ++i) {
      const bool turns = expression.operation == SetOperation::subtract && i > 0;
      result.operands.push_back(renamed(expression.operands[i], removed != turns));
    }
    if (expression.operands.empty()) result.primitive = index_of({expression.primitive, removed});
    return result;
  }
  [[nodiscard]] const std::vector<Use>& uses() const { return uses_; }

 private:
  [[nodiscard]] std::uint32_t index_of(const Use& use) {
    const auto found = std::ranges::find(uses_, use);
    const auto index = static_cast<std::uint32_t>(found - uses_.begin());
    if (found == uses_.end()) uses_.push_back(use);
    return index;
  }

  std::vector<Use> uses_;
};

/// Of what is removed the other model's: where the one has its smallest the other has its largest.
void exchange_what_is_removed(Bracket& models) {
  NamedPrimitives named;
  const SetExpression csg = named.renamed(*models.smallest.csg);
  Model smallest{models.smallest.units, {}, csg};
  Model largest{models.largest.units, {}, csg};
  for (const auto& [primitive, removed] : named.uses()) {
    smallest.primitives.push_back((removed ? models.largest : models.smallest).primitives[primitive]);
    largest.primitives.push_back((removed ? models.smallest : models.largest).primitives[primitive]);
  }
  models.smallest = std::move(smallest);
  models.largest = std::move(largest);
}

}  // namespace

Bracket bracket(const UncertainModel& model) {
  Bracket result = verify::bracket_of_primitives(model);
  if (is_exact(model)) return result;
  if (result.shift > 0.0) verify::require_union_of_convex(result.largest, "intervals of translations");
  if (model.csg && removes(*model.csg)) exchange_what_is_removed(result);
  return result;
}

}  // namespace verisq
