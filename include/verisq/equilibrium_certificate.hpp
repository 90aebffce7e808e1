/// What proves where a body stands still on the ground again, without a search: boxes of parameters and of postures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/check_options.hpp>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/equilibrium_claims.hpp>
#include <verisq/model.hpp>
#include <verisq/stance_equilibrium.hpp>

namespace verisq::stance {

/// A part of the box, with all of its own parts in preorder.
struct EquilibriumPart {
  /// Index in `uncertain`: cut at the middle of this range, to nearest; the lower half comes first.
  std::optional<std::uint32_t> halved = {};
  /// Of a part that is not: of the reference point's height and of the joints sought (`positions` that an equilibrium
  /// leaves open, in order), ranges that hold exactly one equilibrium on all cylinders for each parameter. Empty:
  /// nothing is said of it.
  std::vector<Enclosure> postures = {};
};

/// Where a range is halved.
[[nodiscard]] constexpr double middle_of(const Enclosure& range) {
  const double middle = 0.5 * range.lo + 0.5 * range.hi;
  return middle < range.lo ? range.lo : middle > range.hi ? range.hi : middle;
}

struct EquilibriumCertificate {
  Point reference;  ///< of the root, in its frame: by its height the root's is told
  std::vector<EquilibriumPart> parts;
};

struct ProvenEquilibrium {
  double stands = 0.0;               ///< at least this share, 1 only where all of the box does
  std::optional<Standing> standing;  ///< over all parts that are said to stand; infinite where one is not proven
  /// Of single parameters that stand: the least value of each number is at most `hi`, the greatest at least `lo`.
  std::optional<Standing> of_some;
  std::uint64_t parts = 0;           ///< that are said to stand
  std::uint64_t unproved_parts = 0;  ///< of these
  bool interrupted = false;          ///< nothing is said then
};

/// What the certificate proves, whatever it holds, by MPFR alone and by other formulas than `equilibrium`. Throws
/// Error(input) as that. Preconditions: parameters of the model, each once, with finite ranges; a finite reference
/// point; no posture holds a NaN.
[[nodiscard]] ProvenEquilibrium prove(const Model& model, const EquilibriumClaims& claims,
                                      const EquilibriumCertificate& certificate, const CheckOptions& options);

/// Of each claim: that so much of the box stands, then of `numbers_of` what is claimed to stand. Precondition: as many
/// numbers as `proven` has, no NaN.
[[nodiscard]] std::vector<Finding> check(const EquilibriumClaims& claims, const ProvenEquilibrium& proven);

}  // namespace verisq::stance
