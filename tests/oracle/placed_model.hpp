/// Any model in double: membership of points and balls, and a ball around it; what its references propose with.
#pragma once

#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/placed_primitive.hpp"

namespace verisq::oracle {

struct Ball {
  Point centre;
  double radius;
};

class PlacedModel {
 public:
  explicit PlacedModel(const Model& model);

  [[nodiscard]] Membership operator()(const Point& point) const;
  /// Of all points of the ball; `boundary` where they differ or it is not known.
  [[nodiscard]] Membership operator()(const Ball& ball) const;

  [[nodiscard]] const std::vector<PlacedPrimitive>& primitives() const { return primitives_; }
  /// Contains all primitives; its radius is the size of the model.
  [[nodiscard]] const Ball& bounding_ball() const { return bounding_ball_; }

 private:
  Model model_;
  std::vector<PlacedPrimitive> primitives_;
  Ball bounding_ball_;
};

}  // namespace verisq::oracle
