/// Both certificates take the vector between the closest points for the common normal.
#include "bench/certified_proposal.hpp"

#include "bench/approximate_motion.hpp"
#include "verify/proof/pair_checker.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::bench {

Enclosure PointCertifier::operator()(const Point& query, const Point& closest) const {
  const Normal normal{0, point(vector(query) - vector(closest))};
  // A claim that is true of every point outside: the finding then holds what the normal proves.
  const Enclosure anything{0.0, infinity};
  return check_(query, anything, {{normal}, {}, {}}).proven;
}

Enclosure PairCertifier::operator()(const Pose& pose_of_b, const Point& on_a, const Point& on_b) const {
  const verify::PosedSuperquadric b({"b", b_, pose_of_b});
  const verify::PairBounds bounds(a_, b, b.motion());
  const Eigen::Vector3d between = ApproximateMotion(pose_of_b)(vector(on_b)) - vector(on_a);
  return bounds.distance({0, 0, point(between), on_a, on_b});
}

}  // namespace verisq::bench
