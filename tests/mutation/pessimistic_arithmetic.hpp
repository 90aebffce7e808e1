/// The kernels on arithmetics as bad as their proofs allow, so that a flaw in a proof shows in its result.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace verisq::mutation {

/// A bound of thirty rounded operations stays true when one of them is rounded to the wrong side: the slack of the
/// others hides it. Each operation promises its side and, for the proofs, nothing else: it may be off by 2^-24, a
/// billion times what the checker sees. Where all operations that a bound needs are tight and the others are off by
/// that, one of the others in their place leaves the bound wrong beyond doubt.
enum class Arithmetic {
  usual,
  loose_below,     ///< everything rounded down is
  loose_above,     ///< everything rounded up is
  loose_products,  ///< products, quotients and differences rounded up are: a length is then tighter than they
  loose_dot,       ///< dot_up is
  erratic,         ///< one result in sixteen is, whatever side it is rounded to
  displaced,       ///< what is moved by a pose is off by most of what its error bound allows
  evaluated,       ///< likewise what is evaluated at a contact of points
  poor_search,     ///< proposals are spoilt
};

/// The programs of kernels/embedded_sources.hpp.
/// `solids` are the searches with what bent_distance tells them, `tapered_solids` those of tapered ones; `bent_depths`
/// that kernel alone; `tapered_cubes` the layers of the searches alone, for tapered solids.
enum class Program {
  points,
  tapered_points,
  triangles,
  pairs,
  solids,
  tapered_solids,
  set_bounds,
  bent_depths,
  tapered_cubes
};

/// Those that show the mutants of a program. With points and loose_below or loose_above, results are displaced too.
[[nodiscard]] std::span<const Arithmetic> arithmetics(Program program);

[[nodiscard]] std::string_view name_of(Arithmetic arithmetic);

/// The kernels' proofs hold on each of them as on the usual one, because they ask no more of it. Precondition: the
/// sources are those of the program, changed where no arithmetic changes them.
[[nodiscard]] std::string on(Arithmetic arithmetic, Program program, std::string sources);

}  // namespace verisq::mutation
