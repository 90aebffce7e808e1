/// A ball with a bite out of it, anywhere: the signed distance of a tree of sets in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <verisq/model.hpp>

namespace verisq::oracle {

/// The unit ball about the origin without the ball about `centre`, whose surfaces meet in a circle, the rim.
struct BittenBall {
  Point centre;
  double radius;

  [[nodiscard]] Model model() const {
    const auto ball = [](const Point& at, double r) {
      return Primitive{"ball", {{r, r, r}, {1.0, 1.0}}, {at, {1.0, 0.0, 0.0, 0.0}}};
    };
    const SetExpression whole{.operands = {}, .operation = SetOperation::unite, .primitive = 0};
    const SetExpression bite{.operands = {}, .operation = SetOperation::unite, .primitive = 1};
    return {"",
            {ball({}, 1.0), ball(centre, radius)},
            SetExpression{.operands = {whole, bite}, .operation = SetOperation::subtract}};
  }

  /// Of a point outside the unit ball and outside the bite.
  [[nodiscard]] double distance(const Point& x) const {
    const double apart = std::hypot(centre[0], centre[1], centre[2]);
    const double far = std::hypot(x[0], x[1], x[2]);
    // In the half-plane through x that the line of the centres bounds.
    const double along = (x[0] * centre[0] + x[1] * centre[1] + x[2] * centre[2]) / apart;
    const double across = std::sqrt(std::max(0.0, far * far - along * along));
    const bool foot_is_left = std::hypot(along / far - apart, across / far) >= radius;
    if (foot_is_left) return far - 1.0;
    const double rim_along = (apart * apart + 1.0 - radius * radius) / (2.0 * apart);
    return std::hypot(along - rim_along, across - std::sqrt(1.0 - rim_along * rim_along));
  }
};

/// A bitten ball, and a point above the bite.
struct BittenBallCase {
  BittenBall solid;
  Point above;
};

/// Reproducible: the same for the same seed.
[[nodiscard]] inline BittenBallCase random_bitten_ball(unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> symmetric(-1.0, 1.0);
  const auto number = [&] { return symmetric(generator); };
  const double radius = std::pow(10.0, -0.7 + 0.5 * number());
  Point direction{};
  for (double& d : direction) d = number();
  const double apart = (1.0 + 0.9 * radius * number()) / std::hypot(direction[0], direction[1], direction[2]);
  const double height = 1.1 + radius + std::fabs(number());
  BittenBallCase result{{{}, radius}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    result.solid.centre[i] = apart * direction[i];
    result.above[i] = height * result.solid.centre[i] + 0.2 * number();
  }
  return result;
}

}  // namespace verisq::oracle
