/// Which branches of piecewise equations hold: what is settled of a set of points, or chosen for an approximation.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace verisq::stance {

/// Of a switch at 0; what is open is decided, or the hull taken, where it is evaluated.
enum class Side : std::uint8_t { open, below, above };

/// Slips: towards x or against it.
enum class FrictionBranch : std::uint8_t { open, sticks, slips_forward, slips_backward };

/// Of one contact.
struct ContactBranches {
  Side penetration = Side::open;  ///< above 0, the cylinder touches
  Side damping = Side::open;      ///< of 1 + D delta'/v_N: below 0, the ground cannot follow and does not push
  FrictionBranch friction = FrictionBranch::open;

  [[nodiscard]] bool in_flight() const { return penetration == Side::below || damping == Side::below; }
  [[nodiscard]] bool is_settled() const {
    return in_flight() || (penetration == Side::above && damping == Side::above && friction != FrictionBranch::open);
  }
  friend bool operator==(const ContactBranches&, const ContactBranches&) = default;
};

struct MotionRegime {
  double within;                               ///< a time between the same breaks
  std::vector<ContactBranches> contacts = {};  ///< of each contact; empty: all open

  [[nodiscard]] bool is_settled() const {
    return std::all_of(contacts.begin(), contacts.end(), [](const ContactBranches& c) { return c.is_settled(); });
  }
};

}  // namespace verisq::stance
