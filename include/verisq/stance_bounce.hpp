/// A verified drop and bounce of one contact cylinder (design 5, "Beyond the paper").
#pragma once

#include <functional>
#include <verisq/enclosure.hpp>

namespace verisq::stance {

/// A cylinder that lies along z falls on the ground y = 0 under gravity; Hunt-Crossley with exponent 1 or 1.5, whose
/// impact velocity v_N is the touch-down speed.
struct Drop {
  double mass;            ///< kg
  Enclosure radius;       ///< m
  double height;          ///< of the lowest point above the ground at rest, m; above 0
  double gravity;         ///< m/s^2
  double stiffness;       ///< N / m^n
  double exponent;        ///< 1 or 1.5
  Enclosure restitution;  ///< e_N in (0, 1)
};

struct Bounce {
  Enclosure touch_down_time, touch_down_speed;  ///< s, m/s
  /// A body that stays on the ground has rebound speed 0. Where it may, the time's upper end is infinite.
  Enclosure lift_off_time, rebound_speed;
  Enclosure deepest_penetration;    ///< m
  Enclosure effective_restitution;  ///< rebound speed by touch-down speed
  double steps;                     ///< of the verified integration
  bool proven;                      ///< false: the integration gave up; ends may then be infinite
};

struct BounceOptions {
  double relative_tolerance = 1e-6;  ///< of the local error, to the rebound speed
  std::function<bool()> interrupted = {};
};

/// Not proven, with infinite ends, for a drop that is none: never throws for numbers.
[[nodiscard]] Bounce bounce(const Drop& drop, const BounceOptions& options = {});

}  // namespace verisq::stance
