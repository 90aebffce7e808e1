/// Distances of two models for many poses of the second: what fitting and collision checks need.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <verisq/distance_map.hpp>
#include <verisq/map_result.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// As PointSource and MapSink.
using PoseSource = std::function<std::size_t(std::span<Pose>)>;
using PoseSink = std::function<void(std::span<const Pose>, std::span<const MapResult>)>;

/// As DistanceMapper for the distance of model A and of model B moved by each pose (x -> R x + t, after B's primitives'
/// own poses): 0 where they meet.
class PoseMapper {
 public:
  /// Throws Error(input) as DistanceMapper does, for options that ask for certificates (there are none), and unless
  /// both models are is_union_of_convex.
  PoseMapper(const Model& a, const Model& b, const MapOptions& options);
  ~PoseMapper();
  PoseMapper(PoseMapper&&) noexcept;
  PoseMapper& operator=(PoseMapper&&) noexcept;

  /// As DistanceMapper::map; throws Error(input) for a pose that is not finite or whose quaternion is zero.
  MapSummary map(const PoseSource& source, const PoseSink& sink);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
