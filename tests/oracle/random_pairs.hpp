/// Reproducible random pairs of posed solids, with extra mass where proofs are hard.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {

/// How B is placed relative to A; most are turned at random, about a contact of two boundary points with opposite
/// normals.
enum class PairFamily : std::uint8_t {
  gap,          ///< the contact opened by 1e-9 to 3 sizes
  far,          ///< by 10 to 1e3 sizes
  touching,     ///< by less than 1e-15 sizes, either way
  overlapping,  ///< closed by 1e-9 to 1 size
  aligned,      ///< both axis-aligned, one beside the other: opposite faces, edges or tips
  anywhere,     ///< any rotation, centres within 4 sizes
};

inline constexpr std::array pair_families{PairFamily::gap,         PairFamily::far,     PairFamily::touching,
                                          PairFamily::overlapping, PairFamily::aligned, PairFamily::anywhere};

[[nodiscard]] std::string_view to_string(PairFamily family);

struct RandomPair {
  Primitive a;
  Primitive b;
  PairFamily family;
};

/// The two superquadrics in random poses.
[[nodiscard]] RandomPair random_pair(RandomCases& random, const Superquadric& a, const Superquadric& b);

/// Random superquadrics of comparable size, at times equal, in random poses.
[[nodiscard]] RandomPair random_pair(RandomCases& random);

}  // namespace verisq::oracle
