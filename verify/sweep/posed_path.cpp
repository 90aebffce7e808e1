/// The steady motion of a leg, enclosed.
#include "verify/sweep/posed_path.hpp"

namespace verisq::verify {

SteadyMotion PosedPath::motion_of(std::size_t leg) const {
  if (poses_.size() == 1) return {};
  const Vector3<double> spin = path_.spin(leg);
  const auto exact = [](const Interval& x) { return PreciseInterval(Real(x.lower()), Real(x.upper())); };
  return {precise(poses_[leg + 1].translation) - precise(poses_[leg].translation),
          {exact(spin[0]), exact(spin[1]), exact(spin[2])}};
}

}  // namespace verisq::verify
