/// Poles, circles and corners of spheres.
#include "tests/oracle/sphere_solid.hpp"

#include <limits>

namespace verisq::oracle {

namespace {

[[nodiscard]] Vector sum(const Vector& a, const Vector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

[[nodiscard]] Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Some unit vector orthogonal to the unit vector n.
[[nodiscard]] Vector orthogonal(const Vector& n) {
  std::size_t least = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (abs(n[i]) < abs(n[least])) least = i;
  }
  Vector unit{Real(0), Real(0), Real(0)};
  unit[least] = 1;
  const Vector v = cross(n, unit);
  return scaled<Real>(v, 1 / length(v));
}

}  // namespace

SphereSolid::SphereSolid(const Model& model) : model_(model), margin_(0) {
  for (const Primitive& p : model.primitives) {
    spheres_.push_back({widened(p.pose.translation), Real(p.superquadric.semi_axes[0])});
    margin_ = std::max<Real>(margin_, ldexp(length(spheres_.back().centre) + spheres_.back().radius, -110));
  }
}

Membership SphereSolid::membership(const Vector& point) const {
  return oracle::membership(model_, [&](std::size_t i) {
    const Real excess = length(difference(point, spheres_[i].centre)) - spheres_[i].radius;
    if (excess > margin_) return Membership::outside;
    return excess < -margin_ ? Membership::inside : Membership::boundary;
  });
}

std::optional<SphereSolid::Circle> SphereSolid::circle(const Sphere& a, const Sphere& b) const {
  const Vector axis = difference(b.centre, a.centre);
  const Real d = length(axis);
  if (d < margin_) return std::nullopt;
  const Real along = (d * d + a.radius * a.radius - b.radius * b.radius) / (2 * d);
  const Real squared = a.radius * a.radius - along * along;
  if (squared <= 0) return std::nullopt;
  const Vector normal = scaled<Real>(axis, 1 / d);
  return Circle{sum(a.centre, scaled(normal, along)), normal, sqrt(squared)};
}

bool SphereSolid::add_poles(const Vector& q, std::vector<Vector>& candidates) const {
  for (const auto& [centre, radius] : spheres_) {
    const Vector away = difference(q, centre);
    const Real distance = length(away);
    if (distance < margin_) return false;
    for (const int sign : {1, -1}) candidates.push_back(sum(centre, scaled<Real>(away, sign * radius / distance)));
  }
  return true;
}

bool SphereSolid::add_rims(const Vector& q, std::vector<Vector>& candidates) const {
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    for (std::size_t j = i + 1; j < spheres_.size(); ++j) {
      const std::optional<Circle> rim = circle(spheres_[i], spheres_[j]);
      if (!rim) continue;
      const auto& [centre, normal, radius] = *rim;
      const Vector away = difference(q, centre);
      const Vector across = difference(away, scaled<Real>(normal, dot(away, normal)));
      const Real distance = length(across);
      if (distance < margin_) return false;
      for (const int sign : {1, -1}) candidates.push_back(sum(centre, scaled<Real>(across, sign * radius / distance)));
      const Vector u = orthogonal(normal);
      const Vector v = cross(normal, u);
      for (std::size_t k = j + 1; k < spheres_.size(); ++k) {
        // |centre + radius (u cos t + v sin t) - c_k|^2 = r_k^2, that is a cos t + b sin t = c.
        const Vector offset = difference(spheres_[k].centre, centre);
        const Real a = 2 * radius * dot(offset, u);
        const Real b = 2 * radius * dot(offset, v);
        const Real c = dot(offset, offset) + radius * radius - spheres_[k].radius * spheres_[k].radius;
        const Real amplitude = sqrt(a * a + b * b);
        if (!(abs(c) < amplitude)) continue;
        const Real middle = atan2(b, a);
        const Real half = acos(c / amplitude);
        for (const Real& t : {Real(middle + half), Real(middle - half)}) {
          const Vector spoke = sum(scaled<Real>(u, radius * cos(t)), scaled<Real>(v, radius * sin(t)));
          candidates.push_back(sum(centre, spoke));
        }
      }
    }
  }
  return true;
}

std::optional<ReferenceDistance> SphereSolid::signed_distance(const Point& point) const {
  const Vector q = widened(point);
  const Real slack = 4 * margin_ + ldexp(length(q), -110);
  const Membership side = membership(q);
  if (side == Membership::boundary) return ReferenceDistance{-slack, slack, true};
  std::vector<Vector> candidates;
  if (!add_poles(q, candidates) || !add_rims(q, candidates)) return std::nullopt;
  Real nearest = std::numeric_limits<Real>::infinity();
  for (const Vector& candidate : candidates) {
    if (membership(candidate) != side) nearest = std::min<Real>(nearest, length(difference(q, candidate)));
  }
  const Real distance = side == Membership::outside ? nearest : Real(-nearest);
  return ReferenceDistance{distance - slack, distance + slack, true};
}

}  // namespace verisq::oracle
