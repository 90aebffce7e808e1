/// The distance of two models whose numbers are known within bounds only (docs/mathematics.md §8).
#pragma once

#include <functional>
#include <memory>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/model_distance.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

/// What holds for every member of A and every member of B.
struct UncertainModelDistance {
  Enclosure distance;
  Proximity proximity;   ///< separated, overlapping: proven of all members; undecided: also where members differ
  bool complete = true;  ///< false: interrupted
};

/// As PairDistance for two uncertain models; for exact ones the enclosures are the same.
class UncertainPairDistance {
 public:
  /// Throws as `bracket`.
  UncertainPairDistance(const UncertainModel& a, const UncertainModel& b);
  ~UncertainPairDistance();
  UncertainPairDistance(UncertainPairDistance&&) noexcept;
  UncertainPairDistance& operator=(UncertainPairDistance&&) noexcept;

  /// Encloses the exact distances of all members of A and of B moved by `pose`; interrupted as PairDistance.
  [[nodiscard]] UncertainModelDistance operator()(const Pose& pose = {},
                                                  const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
