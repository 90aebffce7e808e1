/// Where a model of stance stands still on the ground, proven (docs/stance.md §7).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>
#include <verisq/stance_analysis.hpp>

namespace verisq::stance {

/// What the joints do while the body stands.
enum class JointControl : std::uint8_t {
  held,          ///< they are where the file has them: what integral action leads to in the end
  proportional,  ///< those with a controller give way until proportional times the error is the torque, others freely
};

struct CylinderLoad {
  Enclosure force;        ///< of the ground on it, upward, N
  Enclosure penetration;  ///< of both of its points, m
};

/// A static equilibrium for every parameter of a box, in which all cylinders press the ground with all their length.
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

}  // namespace verisq::stance
