/// The public entry: a model as posed solids.
#include "verisq/signed_distance.hpp"

#include <vector>

#include "verify/solid_union.hpp"
#include "verisq/checker.hpp"

namespace verisq {

struct SignedDistance::State {
  explicit State(const Model& model) : checker(model), solids(model.primitives.begin(), model.primitives.end()) {}

  Checker checker;
  std::vector<verify::Solid> solids;
};

SignedDistance::SignedDistance(const Model& model) : state_(std::make_unique<State>(model)) {}

SignedDistance::~SignedDistance() = default;
SignedDistance::SignedDistance(SignedDistance&&) noexcept = default;
SignedDistance& SignedDistance::operator=(SignedDistance&&) noexcept = default;

Enclosure SignedDistance::operator()(const Point& point, double tolerance) const {
  return verify::signed_distance(state_->solids, point, tolerance).distance;
}

CertifiedEnclosure SignedDistance::certified(const Point& point, double tolerance) const {
  CertifiedEnclosure found = verify::signed_distance(state_->solids, point, tolerance);
  found.distance = state_->checker(point, found.distance, found.certificate).proven;
  return found;
}

double bounding_radius(const Model& model) {
  using namespace verify;
  PreciseVector box = Solid(model.primitives.front()).bounding_box();
  for (const Primitive& primitive : model.primitives) {
    const PreciseVector other = Solid(primitive).bounding_box();
    for (Eigen::Index i = 0; i < 3; ++i) box[i] = hull(box[i], other[i]);
  }
  PreciseVector diagonal;
  for (Eigen::Index i = 0; i < 3; ++i) diagonal[i] = PreciseInterval(box[i].upper()) - PreciseInterval(box[i].lower());
  return (length<Real>(diagonal) / PreciseInterval(2)).upper().to_double(Direction::up);
}

}  // namespace verisq
