/// Proves finished enclosures of uncertain models and points again, as Checker does those of exact ones.
#pragma once

#include <memory>
#include <verisq/checker.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

/// The certificate of such an enclosure proves two statements: its normals bound the distance to the largest (or
/// inflated) model from below, with the escape if there is one, and that to the smallest from above, the first normal
/// first; each normal proves what it can for either. Immutable after construction: safe to call from many threads.
class UncertainChecker {
 public:
  /// Each point is any within `point_radius` of the one given, each triangle any whose corners are. Precondition:
  /// finite, at least 0. Throws as `bracket`.
  UncertainChecker(const UncertainModel& model, double point_radius);
  ~UncertainChecker();
  UncertainChecker(UncertainChecker&&) noexcept;
  UncertainChecker& operator=(UncertainChecker&&) noexcept;

  /// Never says `proved` of an enclosure that does not contain the exact signed distances of all members; `refuted`
  /// says that of one member. Preconditions as for Checker.
  [[nodiscard]] Finding operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const;
  [[nodiscard]] Finding operator()(const Triangle& triangle, const Enclosure& claimed,
                                   const Certificate& certificate) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
