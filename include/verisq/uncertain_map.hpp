/// Maps of models, points and triangles whose numbers are known within bounds only (docs/mathematics.md §8).
#pragma once

#include <memory>
#include <verisq/distance_map.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

/// As DistanceMapper for an uncertain model: each row encloses the signed distances to every member of every point
/// within `point_radius` of the one given. Certificates are those of UncertainChecker.
///
/// A row is verified if it is at most the tolerance wide all the same, whatever part of that is uncertainty; the
/// distances to the bracketing models are asked for to half the tolerance each. An exact model and radius 0 go straight
/// to DistanceMapper. Seconds in the summary add up those of the maps of the bracketing models.
class UncertainDistanceMapper {
 public:
  /// Precondition: `point_radius` is finite and at least 0. Throws as DistanceMapper and `bracket`.
  UncertainDistanceMapper(const UncertainModel& model, double point_radius, const MapOptions& options);
  ~UncertainDistanceMapper();
  UncertainDistanceMapper(UncertainDistanceMapper&&) noexcept;
  UncertainDistanceMapper& operator=(UncertainDistanceMapper&&) noexcept;

  /// As DistanceMapper::map.
  MapSummary map(const PointSource& source, const MapSink& sink);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// As UncertainDistanceMapper for the distances of triangles each of whose corners is uncertain by the radius.
class UncertainTriangleMapper {
 public:
  UncertainTriangleMapper(const UncertainModel& model, double point_radius, const MapOptions& options);
  ~UncertainTriangleMapper();
  UncertainTriangleMapper(UncertainTriangleMapper&&) noexcept;
  UncertainTriangleMapper& operator=(UncertainTriangleMapper&&) noexcept;

  MapSummary map(const TriangleSource& source, const TriangleSink& sink);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
