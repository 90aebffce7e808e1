/// Signed distance of a point to any model, by branch and bound over cubes (docs/mathematics.md §10, §11).
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "verify/sets/cube.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

class SolidDistance {
 public:
  explicit SolidDistance(const Model& model);
  ~SolidDistance();
  SolidDistance(SolidDistance&&) noexcept;
  SolidDistance& operator=(SolidDistance&&) noexcept;

  /// Encloses the exact signed distance; works until it is at most `tolerance` wide, the budget of cubes is spent or
  /// `interrupted` (polled) says so: then it is valid, and wide. `known` is what is proven already.
  [[nodiscard]] Enclosure operator()(const Point& x, double tolerance, const Enclosure& known,
                                     const std::function<bool()>& interrupted) const;

  /// A point proven to lie in the solid, or with Side::outside beyond it, hardly farther from x than any is; nothing
  /// where none was found.
  [[nodiscard]] std::optional<Point> nearest(const Point& x, Side side, double tolerance,
                                             const std::function<bool()>& interrupted) const;
  [[nodiscard]] std::optional<Point> escape(const Point& x, double tolerance,
                                            const std::function<bool()>& interrupted) const {
    return nearest(x, Side::outside, tolerance, interrupted);
  }

  /// Of a point.
  [[nodiscard]] Colour colour(const Point& x) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::verify
