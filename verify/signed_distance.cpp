/// The public entry: a model as posed solids.
#include "verisq/signed_distance.hpp"

#include <vector>

#include "verify/solid_union.hpp"

namespace verisq {

struct SignedDistance::State {
  std::vector<verify::Solid> solids;
};

SignedDistance::SignedDistance(const Model& model) : state_(std::make_unique<State>()) {
  state_->solids.reserve(model.primitives.size());
  for (const Primitive& primitive : model.primitives) state_->solids.emplace_back(primitive);
}

SignedDistance::~SignedDistance() = default;
SignedDistance::SignedDistance(SignedDistance&&) noexcept = default;
SignedDistance& SignedDistance::operator=(SignedDistance&&) noexcept = default;

Enclosure SignedDistance::operator()(const Point& point, double tolerance) const {
  return verify::signed_distance(state_->solids, point, tolerance);
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
