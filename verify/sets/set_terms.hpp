/// Trees of set operations as unions of intersections: the disjunctive normal form (docs/mathematics.md §11).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/sets/set_tree.hpp"

namespace verisq::verify {

/// The intersection of primitives, and of closures of complements of primitives: a bit each.
struct SetTerm {
  std::uint32_t inside = 0;
  std::uint32_t outside = 0;

  friend bool operator==(const SetTerm&, const SetTerm&) = default;
};

/// Terms whose union is the set; none that another one contains. Nothing where a primitive has no bit, or where there
/// are more than `most` terms on the way.
[[nodiscard]] std::optional<std::vector<SetTerm>> terms_of(const SetNode& tree, std::size_t most);

}  // namespace verisq::verify
