/// A small change to the kernels' text, as a slip of the pen would make it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "tests/mutation/pessimistic_arithmetic.hpp"

namespace verisq::mutation {

struct Mutant {
  std::string_view name;
  std::string_view text;  ///< occurs exactly once in the kernels' sources
  std::string_view replacement;
  Arithmetic shown_on = Arithmetic::usual;  ///< where it is looked for first
};

/// `sources` with the text of the mutant replaced. Throws std::runtime_error unless the text occurs exactly once.
[[nodiscard]] std::string mutated(std::string sources, const Mutant& mutant);

/// The mutants of one file of kernels, or of one part of arithmetic.clh.
struct Layer {
  std::string_view name;
  bool is_arithmetic;  ///< what the device's self-test looks at
  std::span<const Mutant> mutants;
};

/// In the order of the kernels' layers. All of them break a proof; what only costs tightness or time is not listed.
[[nodiscard]] std::span<const Layer> layers();

/// Those of primitive.clh and tapered_enclosure.clh, in the program of tapered points; likewise.
[[nodiscard]] std::span<const Mutant> tapered_mutants();

/// Those of tapered_interior.clh and of what interior_depth.cl does for it, in the same program; likewise.
[[nodiscard]] std::span<const Mutant> tapered_interior_mutants();

/// Those of triangle_distance.cl, of pair_distance.cl and of the layers and kernels for bent and combined solids, in
/// the programs of triangles, of pairs and of solids; likewise. Those of set_bounds.cl in a program of more primitives.
[[nodiscard]] std::span<const Mutant> triangle_mutants();
[[nodiscard]] std::span<const Mutant> pair_mutants();
[[nodiscard]] std::span<const Mutant> solid_mutants();
[[nodiscard]] std::span<const Mutant> set_mutants();

/// Those of tapered_box_gauge.clh, in a program that searches tapered solids; likewise.
[[nodiscard]] std::span<const Mutant> tapered_cube_mutants();

/// Those of tapered_unbent_solid.clh and of what is done with it, in a program of tapered bent solids; likewise.
[[nodiscard]] std::span<const Mutant> tapered_bent_mutants();

/// Those of bent_depth.clh, in a program whose kernels show its lemmas; likewise.
[[nodiscard]] std::span<const Mutant> depth_mutants();
[[nodiscard]] std::span<const Mutant> tapered_depth_mutants();

/// Those of the kernels between the caller's memory and those of distances, in the program of points; likewise, but
/// that a false status, a false sum or a number in the wrong place counts as a false proof.
[[nodiscard]] std::span<const Mutant> row_mutants();
/// Likewise of point_map.cl, in the program of maps in one step.
[[nodiscard]] std::span<const Mutant> point_map_mutants();

}  // namespace verisq::mutation
