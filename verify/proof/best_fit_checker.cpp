/// Every box that is not halved is bounded, in any order; the largest bound is the proven one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "verify/numbers/points.hpp"
#include "verify/proof/check_steps.hpp"
#include "verify/proof/objective_bound.hpp"
#include "verify/solids/model.hpp"
#include "verisq/error.hpp"
#include "verisq/fit.hpp"

namespace verisq {

using verify::BoxBound;
using verify::PoseCell;

namespace {

/// For boxes whose bound is above the claim, because the author of the divisions found other balls or half-spaces:
/// `few_of` boxes are halved further, by so many levels.
constexpr std::size_t levels_of_few = 6;
/// A limit so that the tree's balls, twice as many, have indices.
constexpr std::size_t most_points = std::size_t{1} << 30U;
constexpr std::size_t few_of(std::size_t boxes) {
  return 16 + boxes / 64;
}

void require(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, message);
}

void require_range(const PoseRange& range) {
  const auto& [w, x, y, z] = range.start.quaternion;
  require(verify::is_finite(range.start.translation) && std::isfinite(w) && verify::is_finite({x, y, z}) &&
              (w != 0.0 || x != 0.0 || y != 0.0 || z != 0.0),
          "range: start: must be finite, its quaternion not zero");
  require(std::isfinite(range.translation) && range.translation >= 0.0,
          fmt::format("range: translation: must be finite and at least 0, not {}", range.translation));
  require(range.rotation_degrees >= 0.0 && range.rotation_degrees <= 180.0,
          fmt::format("range: rotation: must lie in [0, 180] degrees, not {}", range.rotation_degrees));
}

void require_terms(const ClearanceTerms& terms) {
  const Fitness& f = terms.fitness;
  require(std::isfinite(f.target) && f.target >= 0.0, fmt::format("target: must be at least 0, not {}", f.target));
  require(std::isfinite(f.scale) && f.scale > 0.0, fmt::format("scale: must be positive, not {}", f.scale));
  require(std::isfinite(terms.penetration_limit) && terms.penetration_limit >= 0.0,
          fmt::format("penetration limit: must be at least 0, not {}", terms.penetration_limit));
  for (const Area& area : terms.areas) {
    require(std::isfinite(area.weight) && area.weight >= 0.0,
            fmt::format("area {}: its weight must be at least 0, not {}", area.name, area.weight));
  }
}

void require_claim(std::span<const Model> series, std::span<const Point> points, const BestFitClaim& claim) {
  require(!series.empty(), "no implants");
  require(series.size() == claim.centres.size(),
          fmt::format("centres: {} of {} implants", claim.centres.size(), series.size()));
  for (std::size_t i = 0; i < series.size(); ++i) {
    verify::require_union_of_convex(series[i], fmt::format("bound of a fit: implants[{}]", i));
    require(verify::is_finite(claim.centres[i]), fmt::format("centres[{}]: must be finite", i));
  }
  require_range(claim.range);
  require_terms(claim.terms);
  require(claim.upper < infinity, fmt::format("upper: must be a number or minus infinity, not {}", claim.upper));
  require(!points.empty() && points.size() <= most_points,
          fmt::format("points: 1 to {}, not {}", most_points, points.size()));
  require(points.size() == claim.terms.area_of.size(),
          fmt::format("areas: of {} points, and there are {}", claim.terms.area_of.size(), points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    require(verify::is_finite(points[i]), fmt::format("points[{}]: must be finite", i));
    require(claim.terms.area_of[i] < claim.terms.areas.size(), fmt::format("points[{}]: of no area", i));
  }
}

verify::BoundedObjective objective_of(std::span<const Point> points, const ClearanceTerms& terms) {
  std::vector<verify::PointOfWeight> weighted;
  weighted.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    weighted.push_back({points[i], terms.areas[terms.area_of[i]].weight});
  }
  return {terms.fitness, terms.penetration_limit, verify::weighted_balls(weighted)};
}

/// The cells that are not halved; nothing if the divisions are not the divisions of one range.
std::optional<std::vector<PoseCell>> undivided(std::span<const PoseDivision> divisions) {
  std::vector<PoseCell> result;
  std::vector<PoseCell> open{PoseCell{}};
  for (const PoseDivision division : divisions) {
    if (open.empty()) return std::nullopt;
    const PoseCell cell = open.back();
    open.pop_back();
    if (division == PoseDivision::none) {
      result.push_back(cell);
      continue;
    }
    const auto direction = static_cast<std::size_t>(division);
    if (direction >= verify::pose_parameters || !cell.can_be_halved(direction)) return std::nullopt;
    const auto [low, high] = cell.halves(direction);
    open.push_back(high);
    open.push_back(low);
  }
  if (!open.empty()) return std::nullopt;
  return result;
}

/// Halves a cell until each part is bounded by `enough`; lists all parts in preorder.
class Refinement {
 public:
  Refinement(const std::function<BoxBound(const PoseCell&)>& bound, double enough,
             const std::function<bool()>& interrupted)
      : bound_(bound), enough_(enough), interrupted_(interrupted) {}

  struct Part {
    std::vector<PoseDivision> divisions;
    double upper = infinity;
  };

  Part operator()(const PoseCell& cell, std::size_t further) {
    divide(cell, further);
    return std::move(part_);
  }

 private:
  void divide(const PoseCell& cell, std::size_t further) {  // NOLINT(misc-no-recursion): by at most `further` levels
    const BoxBound found = interrupted_() ? BoxBound{infinity, {}} : bound_(cell);
    const std::optional<std::size_t> direction = further > 0 ? widest(cell, found) : std::nullopt;
    part_.divisions.push_back(direction ? static_cast<PoseDivision>(*direction) : PoseDivision::none);
    if (!direction) {
      part_.upper = std::max(part_.upper, found.upper);
      return;
    }
    for (const PoseCell& half : cell.halves(*direction)) divide(half, further - 1);
  }

  /// The direction in which to halve; nothing if the cell needs no halving, or cannot be halved.
  [[nodiscard]] std::optional<std::size_t> widest(const PoseCell& cell, const BoxBound& found) const {
    if (found.upper <= enough_) return std::nullopt;
    const auto direction = static_cast<std::size_t>(std::ranges::max_element(found.spread) - found.spread.begin());
    if (!(found.spread[direction] > 0.0) || !cell.can_be_halved(direction)) return std::nullopt;
    return direction;
  }

  const std::function<BoxBound(const PoseCell&)>& bound_;
  double enough_;
  const std::function<bool()>& interrupted_;
  Part part_{.divisions = {}, .upper = -infinity};
};

/// The divisions with each part that is not halved replaced by its refinement.
std::vector<PoseDivision> joined(std::span<const PoseDivision> divisions,
                                 std::span<const Refinement::Part> refinements) {
  std::vector<PoseDivision> all;
  std::size_t next = 0;
  for (const PoseDivision division : divisions) {
    if (division != PoseDivision::none) {
      all.push_back(division);
    } else {
      const std::vector<PoseDivision>& part = refinements[next++].divisions;
      all.insert(all.end(), part.begin(), part.end());
    }
  }
  return all;
}

}  // namespace

struct BestFitChecker::State {
  State(std::span<const Model> series, std::span<const Point> points, const BestFitClaim& claim)
      : objective(objective_of(points, claim.terms)), claimed(claim.upper) {
    for (std::size_t i = 0; i < series.size(); ++i) {
      bounds.push_back(std::make_unique<verify::ObjectiveBound>(series[i], claim.centres[i], claim.range, objective));
    }
  }

  [[nodiscard]] double all_weights() const { return objective.balls.front().weight; }

  /// A bound that no interval can hold is no bound: the result is the sum of all weights.
  [[nodiscard]] BoxBound bound(std::size_t implant, const PoseCell& cell) const {
    try {
      const BoxBound found = (*bounds[implant])(cell);
      if (found.upper < all_weights()) return found;
      return {all_weights(), found.spread};
    } catch (const std::domain_error&) {
      return {all_weights(), {}};
    }
  }

  [[nodiscard]] Refinement::Part refined(std::size_t implant, const PoseCell& cell, double enough, std::size_t further,
                                         const CheckOptions& options) const {
    const std::function<BoxBound(const PoseCell&)> bound = [this, implant](const PoseCell& part) {
      return this->bound(implant, part);
    };
    return Refinement(bound, enough, options.interrupted)(cell, further);
  }

  verify::BoundedObjective objective;
  double claimed;
  std::vector<std::unique_ptr<verify::ObjectiveBound>> bounds;  ///< one an implant
};

BestFitChecker::BestFitChecker(std::span<const Model> series, std::span<const Point> points,
                               const BestFitClaim& claim) {
  require_claim(series, points, claim);
  try {
    state_ = hidden<State>(series, points, claim);
  } catch (const std::domain_error&) {
    throw Error(ErrorKind::input, "implants, points, weights or range: too large for the arithmetic of a bound");
  }
  require(std::isfinite(state_->all_weights()), "weights: their sum over all points overflows");
}

ProvenBestFit BestFitChecker::operator()(const BestFitCertificate& certificate, const CheckOptions& options) const {
  struct Box {
    std::size_t implant;
    PoseCell cell;
  };
  ProvenBestFit result{.upper = -infinity};
  std::vector<Box> boxes;
  bool all_divided = certificate.ranges.size() == state_->bounds.size();
  for (std::size_t i = 0; i < state_->bounds.size() && all_divided; ++i) {
    const auto cells = undivided(certificate.ranges[i]);
    all_divided = cells.has_value();
    for (const PoseCell& cell : cells.value_or(std::vector<PoseCell>())) boxes.push_back({i, cell});
  }
  if (!all_divided) return {.upper = state_->all_weights()};

  std::vector<double> uppers(boxes.size());
  verify::CheckSteps steps(boxes.size(), options);
  steps.each(boxes.size(), [&](std::size_t i) { uppers[i] = state_->bound(boxes[i].implant, boxes[i].cell).upper; });
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (uppers[i] > state_->claimed) open.push_back(i);
  }
  if (open.size() <= few_of(boxes.size())) {
    verify::CheckSteps further(open.size(), options);
    further.each(open.size(), [&](std::size_t k) {
      const auto& [implant, cell] = boxes[open[k]];
      uppers[open[k]] = state_->refined(implant, cell, state_->claimed, levels_of_few, options).upper;
    });
  }
  if (options.interrupted()) return {.upper = state_->all_weights(), .interrupted = true};
  for (const double upper : uppers) result.upper = std::max(result.upper, upper);
  result.boxes = boxes.size();
  result.open = static_cast<std::uint64_t>(
      std::ranges::count_if(uppers, [this](double upper) { return upper > state_->claimed; }));
  return result;
}

RefinedBestFit BestFitChecker::refined(const BestFitCertificate& certificate, double enough, std::size_t further,
                                       const CheckOptions& options) const {
  const std::vector<PoseDivision> whole{PoseDivision::none};
  RefinedBestFit result{.certificate = {}, .upper = -infinity};
  for (std::size_t i = 0; i < state_->bounds.size(); ++i) {
    const bool is_divided = i < certificate.ranges.size() && undivided(certificate.ranges[i]).has_value();
    const std::vector<PoseDivision>& divisions = is_divided ? certificate.ranges[i] : whole;
    const std::vector<PoseCell> cells = *undivided(divisions);
    std::vector<Refinement::Part> parts(cells.size());
    verify::CheckSteps steps(cells.size(), options);
    steps.each(cells.size(), [&](std::size_t k) { parts[k] = state_->refined(i, cells[k], enough, further, options); });
    result.certificate.ranges.push_back(joined(divisions, parts));
    for (const Refinement::Part& part : parts) result.upper = std::max(result.upper, part.upper);
  }
  result.upper = std::min(result.upper, state_->all_weights());
  return result;
}

Verdict check(const BestFitClaim& claim, const ProvenBestFit& proven) {
  return proven.upper <= claim.upper ? Verdict::proved : Verdict::unproved;
}

}  // namespace verisq
