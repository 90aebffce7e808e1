/// This file implements the choice of normals.
#include "host/batches/certificate_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/certified_distance.hpp"

namespace verisq::device {
namespace {

bool usable(const Point& v) {
  return std::all_of(v.begin(), v.end(), [](double c) { return std::isfinite(c); }) &&
         std::any_of(v.begin(), v.end(), [](double c) { return c != 0.0; });
}

/// A vector along `v` whose length is the distance: the point less it is the closest one (see Certificate). Kernels
/// give normals any length.
Point as_long_as(double distance, const Point& v) {
  const double scale = distance / std::hypot(v[0], v[1], v[2]);
  const Point scaled{scale * v[0], scale * v[1], scale * v[2]};
  return distance > 0.0 && usable(scaled) ? scaled : v;
}

}  // namespace

CertificateAssembly::CertificateAssembly(const Model& model) {
  for (const Primitive& primitive : model.primitives) {
    const verify::PosedSuperquadric proof(primitive);
    const Point origin = verify::rounded(verify::midpoint(proof.motion().translation));
    spheres_.push_back({origin, proof.radius().upper().to_double(verify::Direction::up)});
  }
}

// To nearest, with room for rounding: where it is close the normal is kept.
bool CertificateAssembly::clear_of_sphere(const Point& point, double distance, const Sphere& sphere) {
  const double from_centre =
      std::hypot(point[0] - sphere.centre[0], point[1] - sphere.centre[1], point[2] - sphere.centre[2]);
  return from_centre - sphere.radius > distance + 1e-12 * (from_centre + sphere.radius);
}

Certificate CertificateAssembly::operator()(const Point& point, const Enclosure& distance,
                                            const Evidence& evidence) const {
  const auto& primitives = evidence.primitives;
  const auto nearest =
      std::min_element(primitives.begin(), primitives.end(), [](const auto& a, const auto& b) { return a.hi < b.hi; });
  const auto first = static_cast<std::uint32_t>(nearest - primitives.begin());
  const Point normal = usable(nearest->normal) ? as_long_as(nearest->hi, nearest->normal) : Point{};
  Certificate certificate{{{first, normal}}, {}};
  if (distance.lo > 0.0) {
    for (std::uint32_t i = 0; i < primitives.size(); ++i) {
      if (i == first || !usable(primitives[i].normal) || clear_of_sphere(point, distance.lo, spheres_[i])) continue;
      certificate.normals.push_back({i, primitives[i].normal});
    }
  } else if (primitives.size() > 1 && std::isfinite(distance.lo) && usable(evidence.escape)) {
    certificate.escape = evidence.escape;
  }
  return certificate;
}

Certificate certificate_of(const TriangleEvidence& evidence) {
  const auto nearest = std::min_element(evidence.begin(), evidence.end(),
                                        [](const auto& a, const auto& b) { return a.bounds.hi < b.bounds.hi; });
  const auto first = static_cast<std::uint32_t>(nearest - evidence.begin());
  Certificate certificate{{{first, nearest->bounds.normal}}, {}, nearest->weights};
  for (std::uint32_t i = 0; i < evidence.size(); ++i) {
    if (i != first && usable(evidence[i].bounds.normal)) certificate.normals.push_back({i, evidence[i].bounds.normal});
  }
  return certificate;
}

}  // namespace verisq::device
