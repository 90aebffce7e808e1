/// Gauge and gradient by norms of two numbers, each with its logarithmic derivatives; bends by their inverse.
#include "host/recovery/surface_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace verisq::recovery {
namespace {

constexpr double tiny = 1e-30;           // stands for 0 where a logarithm is taken
constexpr double nearest_plane = 1e-3; // of a semi-axis: nearer to a plane of symmetry second derivatives may be infinite
constexpr double straight_enough = 1e-9; // curvature times distance: the bend's inverse is the identity to rounding
constexpr double most_taper = (largest_taper - 1.0) / (largest_taper + 1.0);

/// N = (a^p + b^p)^(1/p) with p = 2/e. Of its logarithm: the derivative by ln a is `share`, by ln b 1 - share, by e half
/// the entropy of (share, 1 - share).
struct PlanarNorm {
  double value;
  double share;
  double other_share;
  double entropy;
  double odds;  ///< ln(share/other_share)
};

inline PlanarNorm planar_norm(double a, double b, double power) {
  const bool turned = b > a;
  const double larger = turned ? b : a;
  const double smaller = turned ? a : b;
  const double exponent = power * std::log(smaller / larger);
  const double ratio = std::exp(exponent);
  const double of_larger = 1.0 / (1.0 + ratio);
  const double of_smaller = ratio * of_larger;
  const double logarithm = std::log(1.0 + ratio);
  const double entropy = of_smaller > 0.0 ? logarithm - of_smaller * exponent : 0.0;
  return {larger * std::exp(logarithm / power), turned ? of_smaller : of_larger, turned ? of_larger : of_smaller,
          entropy, turned ? exponent : -exponent};
}

/// The point that a bend of curvature (kx, ky) takes to `bent` (Bend in include/verisq/model.hpp).
Eigen::Vector3d unbent(const Eigen::Vector3d& bent, const Eigen::Vector2d& curvature) {
  const double k = curvature.norm();
  if (k * bent.norm() < straight_enough) return bent;
  const Eigen::Vector2d direction = curvature / k;
  const double r = direction[0] * bent[0] + direction[1] * bent[1];
  const double s = direction[0] * bent[1] - direction[1] * bent[0];
  const double square = (1.0 - k * r) * (1.0 - k * r) + k * k * bent[2] * bent[2];
  const double straight_r = (2.0 * r - k * (r * r + bent[2] * bent[2])) / (1.0 + std::sqrt(square));
  const double straight_z = std::atan2(k * bent[2], 1.0 - k * r) / k;
  return {direction[0] * straight_r - direction[1] * s, direction[1] * straight_r + direction[0] * s, straight_z};
}

/// The gradient at `bent` of what has the gradient `slope` at the straight point: along the arc lengths are divided by
/// 1 - k r, and the frame turns by k z.
Eigen::Vector3d bent_gradient(const Eigen::Vector3d& straight, const Eigen::Vector3d& slope,
                              const Eigen::Vector2d& curvature) {
  const double k = curvature.norm();
  if (k * straight.norm() < straight_enough) return slope;
  const Eigen::Vector2d direction = curvature / k;
  const double r = direction[0] * straight[0] + direction[1] * straight[1];
  const double along_r = direction[0] * slope[0] + direction[1] * slope[1];
  const double along_s = direction[0] * slope[1] - direction[1] * slope[0];
  const double along_arc = slope[2] / std::max(1.0 - k * r, 1e-3);
  const double cosine = std::cos(k * straight[2]);
  const double sine = std::sin(k * straight[2]);
  const double new_r = cosine * along_r + sine * along_arc;
  return {direction[0] * new_r - direction[1] * along_s, direction[1] * new_r + direction[0] * along_s,
          cosine * along_arc - sine * along_r};
}

}  // namespace

/// Of a point in the frame of the straight shape.
struct DistanceToShape::Local {
  double value;              ///< f, not divided by the gradient's length
  Eigen::Vector3d gradient;  ///< of f
  Eigen::Vector3d by_axes;   ///< derivatives by ln a1, ln a2, ln a3
  Eigen::Vector2d by_exponents;
  double by_taper;
  double length;  ///< of the gradient; `gradient` and derivatives are then those at the foot, about
};

DistanceToShape::DistanceToShape(const Shape& shape, Family family)
    : shape_(shape),
      family_(family),
      reciprocal_axes_(shape.axes.cwiseInverse()),
      powers_(2.0 / shape.exponents[0], 2.0 / shape.exponents[1]) {}

inline DistanceToShape::Local DistanceToShape::straight(const Eigen::Vector3d& local, bool to_foot) const {
  const double k = shape_.taper;
  const double height = local[2] * reciprocal_axes_[2];
  const Eigen::Vector3d scaled(local[0] * reciprocal_axes_[0], local[1] * reciprocal_axes_[1], height + k);
  const Eigen::Vector3d size = scaled.cwiseAbs().cwiseMax(tiny);
  const PlanarNorm section = planar_norm(size[0], size[1], powers_[1]);
  const PlanarNorm whole = planar_norm(section.value, size[2], powers_[0]);
  const double h = whole.value;
  const Eigen::Vector3d shares(whole.share * section.share, whole.share * section.other_share, whole.other_share);
  Eigen::Vector3d of_gauge;  // its gradient
  for (int i = 0; i < 3; ++i) of_gauge[i] = std::copysign(h * shares[i] / size[i], scaled[i]) * reciprocal_axes_[i];
  Local result;
  result.value = h - 1.0 - k * height;
  result.gradient = of_gauge;
  result.gradient[2] -= k * reciprocal_axes_[2];
  result.by_axes = -of_gauge.cwiseProduct(local);
  result.by_axes[2] += k * height;
  result.by_exponents = {0.5 * h * whole.entropy, 0.5 * h * whole.share * section.entropy};
  result.by_taper = of_gauge[2] * shape_.axes[2] - height;
  if (!to_foot) return result;

  // Derivatives along the unit normal n, which the quotient f/|gradient| needs: |gradient| changes with a parameter as
  // the derivative of f by that parameter does along n. All follow from those of the shares' logarithms.
  const double length = std::max(result.gradient.norm(), tiny);
  result.length = length;
  const Eigen::Vector3d normal = result.gradient / length;
  const double distance = result.value / length;
  Eigen::Vector3d rate;  // of ln size
  for (int i = 0; i < 3; ++i) rate[i] = normal[i] * reciprocal_axes_[i] * std::copysign(1.0 / std::max(size[i], nearest_plane), scaled[i]);
  const double section_rate = section.share * rate[0] + section.other_share * rate[1];
  const double gauge_rate = shares.dot(rate);
  const double within = powers_[1] * (rate[0] - rate[1]);
  const double between = powers_[0] * (section_rate - rate[2]);
  const Eigen::Vector3d share_rate(whole.other_share * between + section.other_share * within,
                                   whole.other_share * between - section.share * within, -whole.share * between);
  Eigen::Vector3d curved;  // the gauge's second derivative times n
  for (int i = 0; i < 3; ++i) curved[i] = of_gauge[i] * (gauge_rate + share_rate[i] - rate[i]);
  const double whole_entropy_rate = -whole.odds * whole.share * whole.other_share * between;
  const double section_entropy_rate = -section.odds * section.share * section.other_share * within;
  result.gradient -= distance * curved;
  result.by_axes += distance * (curved.cwiseProduct(local) + of_gauge.cwiseProduct(normal));
  result.by_axes[2] -= distance * k * normal[2] * reciprocal_axes_[2];
  result.by_exponents[0] -= distance * 0.5 * h * (gauge_rate * whole.entropy + whole_entropy_rate);
  result.by_exponents[1] -=
      distance * 0.5 * h * whole.share *
      ((gauge_rate + whole.other_share * between) * section.entropy + section_entropy_rate);
  result.by_taper -= distance * (curved[2] * shape_.axes[2] - normal[2] * reciprocal_axes_[2]);
  return result;
}

double DistanceToShape::value(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = shape_.rotation.transpose() * (point - shape_.centre);
  const Eigen::Vector3d at = unbent(local, shape_.curvature);
  const Local result = straight(at, false);
  return result.value / std::max(bent_gradient(at, result.gradient, shape_.curvature).norm(), tiny);
}

void DistanceToShape::evaluate(const Eigen::Vector3d& point, SurfaceDistance& distance) const {
  const Eigen::Vector3d local = shape_.rotation.transpose() * (point - shape_.centre);
  const bool bent = bends(family_) || !shape_.curvature.isZero(0.0);
  const Eigen::Vector3d at = bent ? unbent(local, shape_.curvature) : local;
  const Local result = straight(at, !bent);
  const Eigen::Vector3d gradient = bent ? bent_gradient(at, result.gradient, shape_.curvature) : result.gradient;
  const double scale = 1.0 / std::max(bent ? gradient.norm() : result.length, tiny);
  distance.value = result.value * scale;
  distance.normal = gradient * scale;
  distance.derivatives.segment<3>(0) = -distance.normal;
  distance.derivatives.segment<3>(3) = distance.normal.cross(local);
  distance.derivatives.segment<3>(6) = result.by_axes * scale;
  distance.derivatives.segment<2>(9) = result.by_exponents * scale;
  distance.derivatives[11] = tapers(family_) ? result.by_taper * scale : 0.0;
  distance.derivatives.segment<2>(12).setZero();
  if (!bends(family_)) return;
  const double width = 1e-4 / (local.norm() + shape_.axes.maxCoeff());  // of the difference quotient
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d shift = width * Eigen::Vector2d::Unit(i);
    const Eigen::Vector3d by_curvature =
        (unbent(local, shape_.curvature + shift) - unbent(local, shape_.curvature - shift)) / (2.0 * width);
    distance.derivatives[12 + i] = result.gradient.dot(by_curvature) * scale;
  }
}

Shape moved(const Shape& shape, const Step& step) {
  Shape result = shape;
  result.centre += shape.rotation * step.segment<3>(0);
  const Eigen::Vector3d turn = step.segment<3>(3);
  if (const double angle = turn.norm(); angle > 0.0)
    result.rotation = Eigen::Quaterniond(shape.rotation * Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix())
                          .normalized()
                          .toRotationMatrix();
  for (int i = 0; i < 3; ++i) result.axes[i] *= std::exp(step[6 + i]);
  for (int i = 0; i < 2; ++i)
    result.exponents[i] = std::clamp(shape.exponents[i] + step[9 + i], smallest_exponent, largest_exponent);
  result.taper = std::clamp(shape.taper + step[11], -most_taper, most_taper);
  result.curvature += step.segment<2>(12);
  return result;
}

}  // namespace verisq::recovery
