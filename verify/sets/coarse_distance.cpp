/// Boxes, spheres and the triangle inequality, in 127-bit interval arithmetic.
#include "verify/sets/coarse_distance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "verify/numbers/vector.hpp"
#include "verify/proof/intersection.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr Enclosure kNothing{-infinity, infinity};

PreciseInterval exactly(double x) {
  return PreciseInterval(Real(x));
}

Enclosure rounded_outward(const PreciseInterval& a) {
  return {a.lower().to_double(Direction::down), a.upper().to_double(Direction::up)};
}

PreciseInterval way(const Point& x, const Point& y) {
  PreciseVector between;
  for (std::size_t i = 0; i < 3; ++i) between[i] = exactly(x[i]) - exactly(y[i]);
  return length<Real>(between);
}

/// From below. Outside the box, the model is at least as far as the box; inside, what lies beyond the nearest face is
/// not of the model.
double lower_by_box(const Point& x, const Box& box) {
  PreciseVector outside;
  double depth = infinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const double beyond = std::max(subtract(box.lower[i], x[i], Direction::down),  //
                                   subtract(x[i], box.upper[i], Direction::down));
    outside[i] = exactly(std::max(0.0, beyond));
    depth = std::min(depth, -beyond);
  }
  return depth >= 0.0 ? 0.0 - depth : rounded_outward(length<Real>(outside)).lo;
}

/// Far enough beyond the nearest face of the box that no rounding error brings it back.
Point beyond_nearest_face(const Point& x, const Box& box) {
  Point escape = x;
  double least = infinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const double margin = 0x1p-40 * (box.upper[i] - box.lower[i]);
    for (const double face : {box.lower[i] - margin, box.upper[i] + margin}) {
      if (!(std::fabs(face - x[i]) < least)) continue;
      least = std::fabs(face - x[i]);
      escape = x;
      escape[i] = face;
    }
  }
  return escape;
}

}  // namespace

CoarseDistance::CoarseDistance(const Model& model, std::vector<KnownDistance> known)
    : box_(bounding_box(model)), known_(std::move(known)) {}

Enclosure CoarseDistance::operator()(const Point& x) const {
  Enclosure result{lower_by_box(x, box_), infinity};
  for (const auto& [at, distance] : known_) {
    const Enclosure far = rounded_outward(way(x, at));
    const Enclosure by_way{subtract(distance.lo, far.hi, Direction::down), add(distance.hi, far.hi, Direction::up)};
    result = intersection(result, by_way, [&] { return "the signed distance at " + text_of(x); });
  }
  return result;
}

CoarseProof::CoarseProof(const Model& model) : checker_(model), box_(bounding_box(model)) {
  for (const Primitive& primitive : model.primitives) centres_.push_back(primitive.pose.translation);
}

Normal CoarseProof::towards_nearest_centre(const Point& x) const {
  const auto apart = [&](const Point& c) { return std::hypot(c[0] - x[0], c[1] - x[1], c[2] - x[2]); };
  const auto nearest = std::ranges::min_element(centres_, {}, apart);
  // An upper end is that of the point on the ray from the centre through x - v: v may be next to nothing.
  return {static_cast<std::uint32_t>(nearest - centres_.begin()), {0x1p-900, 0.0, 0.0}};
}

CertifiedEnclosure CoarseProof::operator()(const Point& x) const {
  Certificate certificate{{towards_nearest_centre(x)}, beyond_nearest_face(x, box_)};
  const Enclosure proven = checker_(x, kNothing, certificate);
  if (proven.lo > 0.0) certificate.escape.reset();  // the spheres prove it
  return {proven, certificate};
}

CertifiedEnclosure CoarseProof::operator()(const Triangle& triangle) const {
  const Certificate certificate{{towards_nearest_centre(triangle[0])}, std::nullopt, {{0.0, 0.0}}};
  return {checker_(triangle, kNothing, certificate), certificate};
}

}  // namespace verisq::verify
