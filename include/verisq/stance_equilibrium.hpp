/// Where a body stands still, whether it is stable, and what proves it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/stance.hpp>

namespace verisq::stance {

// Where a model of stance stands still on the ground, proven (docs/stance.md §7).

/// How the joints are controlled while the body stands.
enum class JointControl : std::uint8_t {
  held,          ///< they are where the file has them: what integral action leads to in the end
  proportional,  ///< those with a controller give way until proportional times the error is the torque, others freely
};

struct CylinderLoad {
  Enclosure force;        ///< of the ground on it, upward, N
  Enclosure penetration;  ///< of both of its points, m
};

/// A static equilibrium for every parameter of a box, in which each cylinder presses the ground at both contact points
/// of its axis. An end of the axis may be above the ground.
struct Standing {
  std::vector<Enclosure> positions;  ///< of all joints, bodies in order, m or rad
  std::vector<Enclosure> torques;    ///< that hold the joints, N m or N; those of the root enclose 0
  std::vector<CylinderLoad> loads;   ///< of the model's cylinders
  Enclosure centre_of_pressure_x;    ///< in the world, m
  Enclosure centre_of_pressure_z;
  Enclosure least_penetration;  ///< of all points of contact, m: what is left until one lifts off
};

enum class StandingVerdict : std::uint8_t {
  stands,      ///< proven: there is an equilibrium on all cylinders, and no other next to it; stable or not
  not_on_all,  ///< proven: none within reach presses all cylinders
  open,        ///< neither is proven
};

/// A key: "stands", "not_on_all", "open".
[[nodiscard]] constexpr std::string_view to_string(StandingVerdict verdict) {
  switch (verdict) {
    case StandingVerdict::stands: return "stands";
    case StandingVerdict::not_on_all: return "not_on_all";
    case StandingVerdict::open: break;
  }
  return "open";
}

/// A part of the box of the uncertain parameters.
struct EquilibriumCell {
  std::vector<Enclosure> ranges;  ///< of the uncertain set, in its order
  StandingVerdict verdict;
  /// Where it stands: of the height of Equilibrium's reference point above the ground, m, then of the joints whose
  /// positions are sought, the root's two and, with proportional control, all others.
  std::vector<Enclosure> postures = {};
};

struct Equilibrium {
  /// Shares of the box's volume, which add up to 1 but for roundings. `stands` is 1 only where all of the box does.
  double stands = 0.0;
  double not_on_all = 0.0;
  double open = 0.0;
  std::optional<Standing> standing;  ///< the hull of all cells that are proven to stand; none: there is no such cell
  std::vector<EquilibriumCell> cells;
  std::array<double, 3> reference{};  ///< a point of the root next to the ground, in its frame
  bool interrupted = false;           ///< what was not looked at is open
};

/// How far from the file's posture, in rad about each horizontal axis and in m of height, it is proven that there is no
/// equilibrium on all cylinders: of leaning farther nothing is said.
constexpr double equilibrium_reach_of_tilt = 0.1;
constexpr double equilibrium_reach_of_height = 0.05;

struct EquilibriumOptions {
  JointControl control = JointControl::held;
  std::uint32_t cells = 16;  ///< the finest subdivision of each uncertain parameter's range, rounded up to a power of 2
  std::function<bool()> interrupted = {};
  std::function<void(double fraction)> progress = {};  ///< of the box's volume that is done
};

/// Gravity, the applied force's vertical part at t = 0 and the cylinders' elastic forces act; friction carries nothing,
/// and nothing moves. Each cylinder presses with half its stiffness at each of the two Gauss points of its axis. Throws
/// Error(input) for a model that cannot stand by these: without cylinders, without a root that first is translated and
/// then turned about x and z, with a horizontal applied force.
[[nodiscard]] Equilibrium equilibrium(const Model& model, UncertainSet uncertain, const EquilibriumOptions& options);

// Claims about where a body stands still on the ground.

/// The claims, as `equilibrium` finds them.
struct EquilibriumClaims {
  JointControl control;
  std::vector<std::uint32_t> uncertain;  ///< parameters of the model
  std::vector<Enclosure> ranges;         ///< of these: the box; all others are nominal
  double stands;                         ///< at least this share of the box's volume
  std::optional<Standing> standing;      ///< over all of that share; nothing: none is claimed to stand
};

/// One after the other: positions of all joints, torques, loads of the cylinders (force, penetration), the centre of
/// pressure's x and z, the least penetration.
[[nodiscard]] std::vector<Enclosure> numbers_of(const Standing& standing);

// The certificate of where a body stands still on the ground, which needs no search: boxes of parameters and postures.

/// A part of the box, with all of its own parts in preorder.
struct EquilibriumPart {
  /// Index in `uncertain`: cut at the middle of this range, to nearest; the lower half comes first.
  std::optional<std::uint32_t> halved = {};
  /// For a part that is not halved: ranges of the reference point's height and of the joints sought (the `positions`
  /// that an equilibrium leaves open, in order). They hold exactly one equilibrium on all cylinders for each parameter.
  /// Empty: nothing is said about it.
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
  /// For single parameters that stand: the least value of each number is at most `hi`, the greatest at least `lo`.
  std::optional<Standing> of_some;
  std::uint64_t parts = 0;           ///< that are said to stand
  std::uint64_t unproved_parts = 0;  ///< of these
  bool interrupted = false;          ///< nothing is said then
};

/// Returns what the certificate proves, whatever it holds, by MPFR alone and by other formulas than `equilibrium`.
/// Throws Error(input) as that. Preconditions: parameters of the model, each once, with finite ranges; a finite
/// reference point; no posture holds a NaN.
[[nodiscard]] ProvenEquilibrium prove(const Model& model, const EquilibriumClaims& claims,
                                      const EquilibriumCertificate& certificate, const CheckOptions& options);

/// Judges each claim: that so much of the box stands, then the numbers of `numbers_of`. Precondition: as many
/// numbers as `proven` has, no NaN.
[[nodiscard]] std::vector<Finding> check(const EquilibriumClaims& claims, const ProvenEquilibrium& proven);

// Equilibria with what proves them again.

struct CertifiedEquilibrium {
  EquilibriumClaims claims;  ///< what the certificate proves: other formulas, so a little wider or narrower
  EquilibriumCertificate certificate;
  std::uint64_t left_out = 0;  ///< cells that are found to stand, of which no certificate was found
  bool interrupted = false;    ///< nothing is claimed then
};

/// Certifies what was found for this model, with the same control. Throws Error(input) as `equilibrium`.
[[nodiscard]] CertifiedEquilibrium certified_equilibrium(const Model& model, UncertainSet uncertain,
                                                         JointControl control, const Equilibrium& found,
                                                         const CheckOptions& options);

// Whether a standing body returns after small disturbances, proven (docs/stance.md §8).

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
  /// The eigenvalues for the whole box where it was proven in one cell, rightmost first; otherwise none.
  std::vector<EigenvalueEnclosure> eigenvalues;
  std::vector<StabilityCell> cells;
  bool interrupted = false;  ///< what was not looked at is open
};

/// Where joints are `held`, the PID controllers' integral parts hold them where the file has them, and all their parts
/// act on disturbances; where control is `proportional`, the integral parts are absent.
using StabilityOptions = EquilibriumOptions;

/// The stability of the equilibria of `equilibrium`: by the eigenvalues of the linearised motion of all joints, with
/// masses, inertia, gravity, the cylinders' Hunt-Crossley forces, bristles that stick, and the controllers. The
/// bristles hold the feet where they are: the same body may stand elsewhere on the level ground, too. How large a
/// disturbance may be is not said. Throws Error(input) as `equilibrium`, and for a root that cannot move along each of
/// x, y and z, an applied force that varies with time, cylinders without bristles or static friction and, with `held`,
/// joints without an integral part, which nothing would hold.
[[nodiscard]] Stability stability(const Model& model, UncertainSet uncertain, const StabilityOptions& options);

}  // namespace verisq::stance
