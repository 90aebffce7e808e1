/// The exponential of a rotation vector and its Jacobian at 127 bits; all that depends on points in binary64.
#include "verify/best_fit/box_of_poses.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/cross_product.hpp"
#include "verify/analysis/in_binary64.hpp"
#include "verify/proof/rigid_motion.hpp"
#include "verify/proof/trigonometry.hpp"

namespace verisq::verify {

namespace {

PreciseMatrix cross_matrix(const PreciseVector& v) {
  return {{0, -v[2], v[1]}, {v[2], 0, -v[0]}, {-v[1], v[0], 0}};
}

/// (a - sin a)/a³ = 1/6 - a²/120 + ..., whose terms fall and change their signs: for small a between its first sums.
PreciseInterval cubic_quotient(const PreciseInterval& a) {
  const PreciseInterval squared = square(a);
  if (squared.upper() < Real(0x1p-20)) {
    const PreciseInterval first = PreciseInterval(1) / PreciseInterval(6);
    return {(first - squared / PreciseInterval(120)).lower(), first.upper()};
  }
  return (PreciseInterval(1) - quotient_of_sine(a)) / squared;
}

/// exp(ω) and its left Jacobian J: 1 + s W + c W², W the matrix of the cross product with ω; of exp(ω) s = sin a/a and
/// c = (1 - cos a)/a², of J s is that c and c = (a - sin a)/a³, a = |ω|.
struct Exponential {
  explicit Exponential(const PreciseVector& omega) {
    const PreciseInterval angle = length<Real>(omega);
    const PreciseMatrix cross = cross_matrix(omega);
    const PreciseMatrix squared = cross * cross;
    const PreciseInterval half_quotient = quotient_of_sine(angle / PreciseInterval(2));
    const PreciseInterval versine = square(half_quotient) / PreciseInterval(2);
    rotation = PreciseMatrix::identity() + cross * quotient_of_sine(angle) + squared * versine;
    jacobian = PreciseMatrix::identity() + cross * versine + squared * cubic_quotient(angle);
  }
  PreciseMatrix rotation;
  PreciseMatrix jacobian;
};

/// Rounded up.
double length_up(double a, double b, double c) {
  return length<double>(IntervalVector(Interval(a), Interval(b), Interval(c))).upper();
}

}  // namespace

RangeOfPoses::RangeOfPoses(const PoseRange& range, const Point& centre) {
  const RigidMotion start(range.start);
  start_rotation_ = start.rotation;
  start_centre_ = in_binary64(start(precise(centre)));
  const PreciseInterval angle = PreciseInterval(Real(range.rotation_degrees)) * half_turn() / PreciseInterval(180);
  for (std::size_t k = 0; k < 3; ++k) {
    ends_[k] = range.translation;
    ends_[3 + k] = in_binary64(angle).upper();
  }
}

// The parameters of the cell lie between the exact shares (2 i / 2^l - 1) of the ends; the centre is any number near
// their middle, and half of them all reach no farther from it.
BoxOfPoses::BoxOfPoses(const RangeOfPoses& range, const PoseCell& cell) {
  std::array<double, pose_parameters> centre{};
  for (std::size_t k = 0; k < pose_parameters; ++k) {
    const auto share = [&](std::uint32_t index) { return std::ldexp(index, 1 - cell.level[k]) - 1.0; };  // exact
    const Interval end(range.end(k));
    const Interval low = end * Interval(share(cell.index[k]));
    const Interval high = end * Interval(share(cell.index[k] + 1));
    centre[k] = 0.5 * low.lower() + 0.5 * high.upper();
    half_[k] = std::max((high - Interval(centre[k])).upper(), (Interval(centre[k]) - low).upper());
  }
  const Exponential exponential(precise(Point{centre[3], centre[4], centre[5]}));
  rotation_ = in_binary64(exponential.rotation * range.start_rotation());
  inverse_ = rotation_.transpose();
  jacobian_transposed_ = in_binary64(exponential.jacobian.transpose());
  pivot_ = range.start_centre() + IntervalVector(Interval(centre[0]), Interval(centre[1]), Interval(centre[2]));
  moved_ = length_up(half_[0], half_[1], half_[2]);
  turned_ = length_up(half_[3], half_[4], half_[5]);
}

// x - c = R(1)^T (arm - δτ). Rotations along the line from the centre turn no faster than |δω|, so that R^T arm goes no
// farther than |δω| |arm|, and its second derivative is at most 3/2 |δω|² |arm|: its remainder is half of that, that of
// R^T δτ |R(1)^T δτ - R(0)^T δτ| <= |δω| |δτ|.
BoxOfPoses::Arm BoxOfPoses::arm(const Point& v) const {
  Arm result{IntervalVector(Interval(v[0]), Interval(v[1]), Interval(v[2])) - pivot_, {}, 0.0, 0.0};
  result.from_centre = inverse_ * result.from_pivot;
  const Interval length = verify::length<double>(result.from_pivot);
  const Interval moved(moved_);
  const Interval turned(turned_);
  result.reach = (moved + turned * length).upper();
  result.remainder = (turned * (Interval(0.75) * turned * length + moved)).upper();
  return result;
}

// n·R^T (arm - δτ) changes by -(R n)·δτ, and where the implant turns by θ = J δω by (θ × R n)·arm = θ·(R n × arm).
PoseSlope BoxOfPoses::slope(const Arm& arm, const IntervalVector& turned) const {
  const IntervalVector by_rotation = jacobian_transposed_ * cross(turned, arm.from_pivot);
  return {-turned[0], -turned[1], -turned[2], by_rotation[0], by_rotation[1], by_rotation[2]};
}

double BoxOfPoses::range_up(const PoseSlope& slope) const {
  Interval sum(0);
  for (std::size_t k = 0; k < pose_parameters; ++k) sum += abs(slope[k]) * Interval(half_[k]);
  return sum.upper();
}

}  // namespace verisq::verify
