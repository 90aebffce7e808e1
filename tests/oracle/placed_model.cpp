/// The tree over the placed primitives.
#include "tests/oracle/placed_model.hpp"

namespace verisq::oracle {

PlacedModel::PlacedModel(const Model& model)
    : model_(model), primitives_(model.primitives.begin(), model.primitives.end()), bounding_ball_{{0, 0, 0}, 0.0} {
  for (const PlacedPrimitive& p : primitives_) {
    for (std::size_t i = 0; i < 3; ++i) {
      bounding_ball_.centre[i] += p.centre()[i] / static_cast<double>(primitives_.size());
    }
  }
  for (const PlacedPrimitive& p : primitives_) {
    const double away = length(difference(p.centre(), bounding_ball_.centre));
    bounding_ball_.radius = std::max(bounding_ball_.radius, (away + p.reach()) * (1 + 1e-12));
  }
}

Membership PlacedModel::operator()(const Point& point) const {
  return membership(model_, [&](std::size_t i) { return primitives_[i].membership(point); });
}

Membership PlacedModel::operator()(const Ball& ball) const {
  return membership(model_, [&](std::size_t i) { return primitives_[i].membership(ball.centre, ball.radius); });
}

}  // namespace verisq::oracle
