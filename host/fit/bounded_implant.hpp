/// An implant whose objective is bounded over boxes of its poses.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/fit/candidate_space.hpp"
#include "host/fit/range_cell.hpp"
#include "verify/placement/distance_field.hpp"
#include "verify/placement/fit_box_bound.hpp"
#include "verify/placement/pose_box.hpp"
#include "verisq/fit_bound.hpp"

namespace verisq::fit_search {

/// Any number of threads may ask.
class BoundedImplant {
 public:
  /// Keeps nothing of its arguments; asks the options now and then whether to end. Throws Error(input) as
  /// CandidateSpace and Mapper.
  BoundedImplant(const UncertainModel& implant, std::span<const verify::WeightedPoint> points,
                 const FitBoundOptions& options);
  BoundedImplant(const BoundedImplant&) = delete;
  BoundedImplant& operator=(const BoundedImplant&) = delete;

  [[nodiscard]] verify::PoseBox box(const RangeCell& cell) const;
  [[nodiscard]] verify::FitBoxResult operator()(const verify::PoseBox& box) const { return bound_(box); }

  [[nodiscard]] const CandidateSpace& space() const { return candidates_; }
  [[nodiscard]] const verify::DistanceField& field() const { return field_; }
  /// False where the options asked to end before all was ready: then it bounds nothing.
  [[nodiscard]] bool is_ready() const { return ready_; }
  /// That proved depths, or "host".
  [[nodiscard]] const std::string& device() const { return device_; }

 private:
  [[nodiscard]] double model_radius() const;
  [[nodiscard]] double size_of(std::span<const verify::WeightedPoint> points) const;
  [[nodiscard]] std::vector<double> depths(std::span<const Point> queries, const FitBoundOptions& options);

  CandidateSpace candidates_;
  Model model_;
  verify::PoseSpace space_;
  double size_;
  verify::DistanceField field_;
  verify::FitBoxBound bound_;
  std::string device_;
  bool ready_ = false;
};

}  // namespace verisq::fit_search
