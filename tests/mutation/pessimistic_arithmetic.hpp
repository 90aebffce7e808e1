/// The kernels on arithmetics as bad as their proofs allow, so that a flaw in a proof shows in its result.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace verisq::mutation {

/// A bound of thirty rounded operations stays true when one of them is rounded to the wrong side: the slack of the
/// others hides it. Each operation promises its side and, for the proofs, nothing else: it may be off by 2^-24, a
/// billion times what the checker sees. Where all operations that a bound needs are tight and the others are off by
/// that, one of the others in their place leaves the bound wrong beyond doubt.
enum class Arithmetic {
  usual,
  loose_below,     ///< everything rounded down is; the local point is moved by most of what its error bound allows
  loose_above,     ///< everything rounded up is; the local point likewise
  loose_products,  ///< products, quotients and differences rounded up are: a length is then tighter than they
  loose_dot,       ///< dot_up is
  poor_search,     ///< tangent planes seem up to twice as far, and the branch and bound soon lowers its target
};

inline constexpr std::array arithmetics{Arithmetic::usual,          Arithmetic::loose_below, Arithmetic::loose_above,
                                        Arithmetic::loose_products, Arithmetic::loose_dot,   Arithmetic::poor_search};

[[nodiscard]] std::string_view name_of(Arithmetic arithmetic);

/// The kernels' proofs hold on each of them as on the usual one, because they ask no more of it.
[[nodiscard]] std::string on(Arithmetic arithmetic, std::string sources);

}  // namespace verisq::mutation
