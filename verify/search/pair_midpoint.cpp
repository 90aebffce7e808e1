/// Newton's method, its Hessian blended towards the largest possible one where a step gains nothing.
#include "verify/search/pair_midpoint.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "verify/search/pair_projection.hpp"

namespace verisq::verify {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMostRounds = 64;
/// Converged when the vectors cancel but for this part of their length.
constexpr double kCancelled = 1e-11;
/// How deep every other step aims inside the solids, as a part of the distance: it does not stop at a surface.
constexpr double kOvershoot = 0.25;
/// Values closer than this differ by rounding errors.
constexpr double kSameValue = 1e-13;
constexpr double kSmallestBlend = 1e-13;
/// The squared step, as a part of the value, up to which linear extrapolation helps.
constexpr double kShortStep = 1e-4;

/// Gradient and Hessian of half the square of (distance + depth) instead of the distance: the minima are the same.
struct NewtonTerms {
  Vector3d gradient;
  Matrix3d hessian;
};

NewtonTerms aimed_inside(const DistanceExpansion& at, double depth) {
  if (at.inside) return {Vector3d::Zero(), Matrix3d::Zero()};
  const double squared = 2.0 * at.value;
  const double part = squared > 0.0 ? depth / std::sqrt(squared) : 0.0;
  const Vector3d& v = at.gradient;
  const Matrix3d along = squared > 0.0 ? Matrix3d(v * v.transpose() / squared) : Matrix3d(Matrix3d::Zero());
  return {(1.0 + part) * v, (1.0 + part) * at.hessian - part * along};
}

class MidpointSearch {
 public:
  MidpointSearch(const Superquadric& a, const Superquadric& b, const Matrix3d& rotation, const Vector3d& offset)
      : a_(a), b_(b), rotation_(rotation), offset_(offset) {}

  [[nodiscard]] std::optional<MidpointContact> operator()(const Vector3d& start) const {
    Probe best = complete(start, a_(start), b_(in_b(start)));
    double blend = kSmallestBlend;
    for (int round = 0; round < kMostRounds; ++round) {
      if (best.a.inside && best.b.inside) return std::nullopt;
      if (imbalance(best) <= kCancelled * std::sqrt(best.value())) return contact(best);
      const bool aimed = round % 2 == 1;  // far from the minimum such a step may gain nothing
      const double distance = std::sqrt(2.0 * best.a.value) + std::sqrt(2.0 * best.b.value);
      const Vector3d m = best.point - step(best, aimed ? kOvershoot * distance : 0.0, blend);
      if (!m.allFinite()) return std::nullopt;
      const Probe next = complete(m, a_(m, best.a.closest), b_(in_b(m), best.b.closest));
      if (better(next, best)) {
        best = next;
        blend = std::max(0.1 * blend, kSmallestBlend);
      } else if (!aimed) {
        blend = std::min(std::max(4.0 * blend, 0.05), 1.0);
      }
    }
    return std::nullopt;
  }

 private:
  /// What both solids say about one point, in A's frame.
  struct Probe {
    Vector3d point;
    DistanceExpansion a, b;

    [[nodiscard]] double value() const { return a.value + b.value; }
  };

  [[nodiscard]] Vector3d in_b(const Vector3d& x) const { return rotation_.transpose() * (x - offset_); }

  [[nodiscard]] Probe complete(const Vector3d& point, const DistanceExpansion& a, DistanceExpansion b) const {
    b.gradient = rotation_ * b.gradient;
    b.hessian = rotation_ * b.hessian * rotation_.transpose();
    return {point, a, b};
  }

  [[nodiscard]] static double imbalance(const Probe& p) { return (p.a.gradient + p.b.gradient).norm(); }

  [[nodiscard]] static bool better(const Probe& next, const Probe& best) {
    return next.value() < best.value() ||
           (next.value() <= best.value() * (1.0 + kSameValue) && imbalance(next) < imbalance(best));
  }

  /// The Hessian blended by `blend` towards the bound 2 of that of the sum.
  [[nodiscard]] static Vector3d step(const Probe& at, double depth, double blend) {
    const NewtonTerms a = aimed_inside(at.a, depth);
    const NewtonTerms b = aimed_inside(at.b, depth);
    const Matrix3d hessian = (1.0 - blend) * (a.hessian + b.hessian) + 2.0 * blend * Matrix3d::Identity();
    return hessian.inverse() * (a.gradient + b.gradient);
  }

  /// The vector is extrapolated by the step that is left: each solid's own vector then stays one of its normals, which
  /// matters where it is nearly flat.
  [[nodiscard]] MidpointContact contact(const Probe& p) const {
    const Vector3d left = step(p, 0.0, kSmallestBlend);
    const bool usable = left.allFinite() && left.squaredNorm() <= kShortStep * p.value();
    const Vector3d plain = p.a.gradient - p.b.gradient;
    const Vector3d vector = usable ? Vector3d(plain - (p.a.hessian - p.b.hessian) * left) : plain;
    return {vector, p.point - p.a.gradient, in_b(p.point - p.b.gradient)};
  }

  PairProjection a_;
  PairProjection b_;
  Matrix3d rotation_;
  Vector3d offset_;
};

}  // namespace

std::optional<MidpointContact> midpoint_contact(const Superquadric& a, const Superquadric& b, const Matrix3d& rotation,
                                                const Vector3d& offset, const Vector3d& start) {
  return MidpointSearch(a, b, rotation, offset)(start);
}

}  // namespace verisq::verify
