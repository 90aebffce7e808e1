/// Whether a standing body returns after small disturbances, proven (docs/stance.md §8).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>
#include <verisq/stance_equilibrium.hpp>

namespace verisq::stance {

enum class StabilityVerdict : std::uint8_t {
  stable,    ///< proven: small disturbances die out, whatever they are
  unstable,  ///< proven: some grow, however small they are
  open,      ///< neither is proven, or that there is an equilibrium is not
};

/// A key: "stable", "unstable", "open".
[[nodiscard]] constexpr std::string_view to_string(StabilityVerdict verdict) {
  switch (verdict) {
    case StabilityVerdict::stable: return "stable";
    case StabilityVerdict::unstable: return "unstable";
    case StabilityVerdict::open: break;
  }
  return "open";
}

/// A part of the complex plane, in 1/s, and how many eigenvalues lie in it.
struct EigenvalueEnclosure {
  Enclosure real;
  Enclosure imaginary;
  std::size_t count;
};

struct StabilityCell {
  std::vector<Enclosure> ranges;  ///< of the uncertain set, in its order
  StabilityVerdict verdict;
};

struct Stability {
  /// Shares of the box's volume, which add up to 1 but for roundings. `stable` and `unstable` are 1 only where all is.
  double stable = 0.0;
  double unstable = 0.0;
  double open = 0.0;
  /// Contains the greatest real part of an eigenvalue, 1/s, for each parameter that is not open: disturbances grow or
  /// die out no faster, in the end. Reversed infinities where all is open.
  Enclosure growth{infinity, -infinity};
  /// Of the whole box where it was proven in one cell, rightmost first; otherwise none.
  std::vector<EigenvalueEnclosure> eigenvalues;
  std::vector<StabilityCell> cells;
  bool interrupted = false;  ///< what was not looked at is open
};

/// Where joints are `held`, the PID controllers' integral parts hold them where the file has them, and all their parts
/// act on disturbances; where control is `proportional`, the integral parts are absent.
using StabilityOptions = EquilibriumOptions;

/// Of the equilibria of `equilibrium`: by the eigenvalues of the linearised motion of all joints, with masses, inertia,
/// gravity, the cylinders' Hunt-Crossley forces, bristles that stick, and the controllers. The bristles hold the feet
/// where they are: the same body may stand elsewhere on the level ground, too. How large a disturbance may be is not
/// said. Throws Error(input) as `equilibrium`, and for a root that cannot move along each of x, y and z, an applied
/// force that varies with time, cylinders without bristles or static friction and, with `held`, joints without an
/// integral part, which nothing would hold.
[[nodiscard]] Stability stability(const Model& model, UncertainSet uncertain, const StabilityOptions& options);

}  // namespace verisq::stance
