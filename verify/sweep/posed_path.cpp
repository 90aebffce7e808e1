/// The steady motion of a leg, enclosed, and of a part of it.
#include "verify/sweep/posed_path.hpp"

#include <algorithm>

#include "verify/numbers/rounding.hpp"

namespace verisq::verify {

ShortMotion PosedPath::motion_between(double begin, double until) const {
  const double middle = std::clamp(0.5 * (begin + until), begin, until);
  const double reach = std::max(subtract(middle, begin, Direction::up), subtract(until, middle, Direction::up));
  return {enclosed_pose(middle), motion_of(static_cast<std::size_t>(begin)), reach};
}

SteadyMotion PosedPath::motion_of(std::size_t leg) const {
  if (leg + 1 >= poses_.size()) return {};  // nothing moves at the last pose alone
  const Vector3<double> spin = path_.spin(leg);
  const auto exact = [](const Interval& x) { return PreciseInterval(Real(x.lower()), Real(x.upper())); };
  return {precise(poses_[leg + 1].translation) - precise(poses_[leg].translation),
          {exact(spin[0]), exact(spin[1]), exact(spin[2])}};
}

}  // namespace verisq::verify
