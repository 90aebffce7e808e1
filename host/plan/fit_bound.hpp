/// Upper bounds of a fit's objective over a range of poses, by halvings of it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/plan/candidate_evaluation.hpp"
#include "verify/proof/solid_field.hpp"
#include "verify/search/distance_field.hpp"
#include "verify/search/fit_box_bound.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

// Boxes of a searched range of poses, made by halving the range.

struct RangeCell {
  verify::PoseCell poses;
  double bound = infinity;   ///< bound of the objective in the box
  std::uint8_t widest = 0;   ///< direction to be divided next
  std::uint8_t implant = 0;  ///< in the series
  std::uint32_t node = 0;    ///< in the implant's tree of halvings

  /// The two halves; their nodes follow each other from `first` on.
  [[nodiscard]] std::array<RangeCell, 2> halves(std::uint32_t first) const {
    std::array<RangeCell, 2> halves{*this, *this};
    const auto [low, high] = poses.halves(widest);
    halves[0].poses = low;
    halves[0].node = first;
    halves[1].poses = high;
    halves[1].node = first + 1;
    return halves;
  }
};

// An implant whose objective is bounded over boxes of its poses.

/// Any number of threads may ask.
class BoundedImplant {
 public:
  /// Keeps nothing of its arguments; polls the options now and then whether to end. Throws Error(input) like
  /// CandidateSpace and Mapper.
  BoundedImplant(const UncertainModel& implant, std::span<const verify::WeightedPoint> points,
                 const FitBoundOptions& options);
  BoundedImplant(const BoundedImplant&) = delete;
  BoundedImplant& operator=(const BoundedImplant&) = delete;

  [[nodiscard]] verify::PoseBox box(const RangeCell& cell) const;
  [[nodiscard]] verify::FitBoxResult operator()(const verify::PoseBox& box) const { return bound_(box); }

  [[nodiscard]] const CandidateSpace& space() const { return candidates_; }
  [[nodiscard]] const verify::DistanceField& field() const { return field_; }
  /// False if the options ended the work before all was ready: then it bounds nothing.
  [[nodiscard]] bool is_ready() const { return ready_; }
  /// The device that proved depths, or "host".
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
