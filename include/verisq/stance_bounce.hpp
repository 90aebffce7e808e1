/// A verified drop and bounce of one contact cylinder (docs/stance.md §6).
#pragma once

#include <functional>
#include <verisq/enclosure.hpp>

namespace verisq::stance {

/// A cylinder that lies along z, alone, falls on the ground y = 0 under gravity. The ground pushes with
/// k delta^n max(0, 1 + D delta'/v_N), where D follows from the restitution: Hunt-Crossley, exponent n of 1 or 1.5.
/// Numbers in an Enclosure are any within: each bounce has one of them all the while.
struct Drop {
  Enclosure mass;             ///< kg; above 0
  Enclosure radius;           ///< m; acts on nothing: the lowest point falls by the height whatever the radius
  double height;              ///< of the lowest point above the ground at rest, m; above 0
  double gravity;             ///< m/s^2
  double stiffness;           ///< k, N / m^n
  double exponent;            ///< n, 1 or 1.5
  Enclosure restitution;      ///< e_N in (0, 1), at touch-down with the speed v_N
  Enclosure impact_velocity;  ///< v_N, m/s; above 0
};

/// Contains the bounces for all numbers of the drop.
struct Bounce {
  Enclosure touch_down_time, touch_down_speed;  ///< s, m/s
  /// A body that stays on the ground has rebound speed 0. Where it may, the time's upper end is infinite, and the lower
  /// end is that of the bodies that lift off, if any may.
  Enclosure lift_off_time, rebound_speed;
  Enclosure deepest_penetration;    ///< m
  Enclosure effective_restitution;  ///< rebound speed by touch-down speed
  double steps;                     ///< of the verified integration
  bool proven;                      ///< false: the integration gave up; ends may then be infinite
};

struct BounceOptions {
  double relative_tolerance = 1e-6;  ///< of the local error, to the rebound speed that it would have without gravity
  std::function<bool()> interrupted = {};
};

/// Not proven, with infinite ends, for a drop that is none: never throws for numbers.
[[nodiscard]] Bounce bounce(const Drop& drop, const BounceOptions& options = {});

}  // namespace verisq::stance
