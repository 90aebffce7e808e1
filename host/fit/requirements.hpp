/// All that is asked of a candidate besides the limit of penetration.
#pragma once

#include <span>

#include "host/fit/contact_aim.hpp"
#include "host/fit/pose_constraints.hpp"
#include "host/fit/side_requirements.hpp"
#include "host/fit/size_aim.hpp"

namespace verisq::fit_search {

struct Requirements {
  SideRequirements sides;
  PoseConstraints constraints;
  ContactAim contacts = {};
  SizeAim size = {};

  /// What size and contact make of the objective at most.
  [[nodiscard]] double most() const { return size.most() + contacts.most(); }

  /// 0 where all but contact is kept: the samples misplaced, and what is missing of the constraints in their units.
  [[nodiscard]] double broken(std::span<const double> parameters, const Candidate& candidate) const {
    return static_cast<double>(sides.misplaced(candidate)) + constraints.violation(parameters);
  }
};

}  // namespace verisq::fit_search
