/// The closest point of the surface of any set operations, where near the query one primitive's surface is all of it.
#pragma once

#include <memory>
#include <optional>

#include "verisq/closest_point.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Let the ball about x that just holds the nearest surface point p of a primitive K be such that every other primitive
/// has it all inside or all outside, or does not matter within it, whatever lies in K; then the model is K there, or
/// what K leaves, and p is its nearest surface point, too (docs/mathematics.md §25). Immutable: safe to call from many
/// threads.
class SetClosestPoint {
 public:
  explicit SetClosestPoint(const Model& model);
  ~SetClosestPoint();
  SetClosestPoint(SetClosestPoint&&) noexcept;
  SetClosestPoint& operator=(SetClosestPoint&&) noexcept;

  /// Nothing where no primitive decides. `farthest`: an upper bound of the distance of x to the model's surface, which
  /// only saves time; infinite where nothing is known.
  [[nodiscard]] std::optional<ClosestPoint> operator()(const Point& x, double farthest) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::verify
