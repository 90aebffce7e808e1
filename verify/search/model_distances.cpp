/// This file implements model_distances.hpp.
#include "verify/search/model_distances.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "verify/numbers/rounding.hpp"
#include "verify/proof/proven_surface.hpp"
#include "verify/proof/surface_patch.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/verdict.hpp"

namespace verisq::verify {

namespace {

double middle_of(const Enclosure& e) {
  return 0.5 * e.lo + 0.5 * e.hi;
}

double open_in(const WeightedCell& cell, const Enclosure& value, double result) {
  const double from_result = std::max(std::abs(value.hi - result), std::abs(value.lo - result));
  return cell.weight.hi * (value.hi - value.lo) + cell.weight.width() * from_result;
}

}  // namespace

void choose_for_mean(std::span<const WeightedCell> cells, const Enclosure& mean, double allowed,
                     std::vector<bool>& chosen) {
  if (mean.hi - mean.lo <= allowed) return;
  double weight = 0.0;
  std::vector<std::pair<double, std::size_t>> widths;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    weight += middle_of(cells[i].weight);
    widths.emplace_back(open_in(cells[i], cells[i].mean, middle_of(mean)), i);
  }
  choose_widest(widths, allowed * weight, chosen);
}

void choose_for_percentile(std::span<const WeightedCell> cells, const Enclosure& value, double part, double allowed,
                           std::vector<bool>& chosen) {
  if (value.hi - value.lo <= allowed) return;
  double excess = 0.0;
  std::vector<std::pair<double, std::size_t>> widths;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double open = open_in(cells[i], part_up_to(cells[i], middle_of(value)), part);
    if (!(open > 0.0)) continue;
    widths.emplace_back(open, i);
    excess += open;
  }
  choose_widest(widths, excess * allowed / (value.hi - value.lo), chosen);
}

void choose_for_share(std::span<const WeightedCell> cells, const AreaWithin& within, double distance, double allowed,
                      std::vector<bool>& chosen) {
  if (within.share.width() <= allowed) return;
  double area = 0.0;
  std::vector<std::pair<double, std::size_t>> widths;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    area += middle_of(cells[i].weight);
    const double open = open_in(cells[i], part_up_to(cells[i], distance), middle_of(within.share));
    if (open > 0.0) widths.emplace_back(open, i);
  }
  choose_widest(widths, allowed * area, chosen);
}

namespace {

/// Many patches a thread at a time.
constexpr std::size_t patches_a_task = 256;

struct OpenPatch {
  PatchCell cell;
  double bound = infinity;  ///< no point of the patch that belongs to the boundary is farther
  double radius = infinity;
  double of_sample = 0.0;  ///< the sample's distance from the triangles, from below
  Point sample{};
};

class PatchSearch {
 public:
  PatchSearch(const Model& model, const TriangleTree& triangles, const DeviationSearch& search)
      : triangles_(triangles), search_(search) {
    for (std::uint32_t k = 0; k < model.primitives.size(); ++k) {
      surfaces_.emplace_back(model.primitives[k], k);
      for (const PatchCell& octant : surfaces_.back().octants()) open_.push_back({.cell = octant});
    }
  }

  FarthestOfModel operator()() {
    while (!open_.empty() && may_go_on()) {
      bound_patches();
      settle_near_ones();
      if (!sample()) break;
      settle_near_ones();
      report_progress();
      halve();
    }
    found_.ended = !open_.empty();
    for (const OpenPatch& patch : open_) settled_ = std::max(settled_, patch.bound);
    found_.distance = between(lower_, settled_, [] { return "the distance of the model's surface"; });
    return found_;
  }

 private:
  [[nodiscard]] bool may_go_on() const {
    return !search_.ended() && found_.patches + open_.size() <= search_.most_samples;
  }

  [[nodiscard]] double target() const { return add(lower_, search_.allowed(lower_), Direction::down); }

  void bound_patches() {
    for (const OpenPatch& patch : open_) surfaces_[patch.cell.primitive].prepare(patch.cell);
    const double enough = target();
    const std::size_t tasks = (open_.size() + patches_a_task - 1) / patches_a_task;
    search_.in_parallel(tasks, [&](std::size_t task) {
      const std::size_t end = std::min(open_.size(), (task + 1) * patches_a_task);
      for (std::size_t i = task * patches_a_task; i < end; ++i) bound(open_[i], enough);
    });
    found_.patches += open_.size();
  }

  /// Tries no harder than to come below `enough`.
  void bound(OpenPatch& open, double enough) const {
    const Patch patch = surfaces_[open.cell.primitive].patch(open.cell);
    const PatchDistance distance = distance_from(patch, triangles_, enough);
    open.sample = patch.sample;
    open.radius = patch.radius;
    open.of_sample = distance.of_sample.lo;
    open.bound = std::min(open.bound, distance.farthest);
  }

  void settle_near_ones() {
    const double enough = target();
    std::erase_if(open_, [&](const OpenPatch& patch) {
      if (!(patch.bound <= enough)) return false;
      settled_ = std::max(settled_, patch.bound);
      return true;
    });
  }

  /// Drops patches that are proven off the boundary; patches near it bound the supremum from below. False if it ended
  /// early.
  bool sample() {
    std::vector<Point> points(open_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) points[i] = open_[i].sample;
    std::vector<Enclosure> rows(points.size(), {-infinity, infinity});
    if (!search_.to_model(points, rows)) return false;
    found_.samples += points.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const Enclosure from_boundary = magnitude(rows[i]);
      if (from_boundary.lo > open_[i].radius) continue;
      note(open_[i], from_boundary.hi);
      open_[kept++] = open_[i];
    }
    open_.resize(kept);
    return true;
  }

  /// A point of the boundary lies within `from_boundary` of the sample.
  void note(const OpenPatch& patch, double from_boundary) {
    const double lower = subtract(patch.of_sample, from_boundary, Direction::down);
    if (!(lower > lower_)) return;
    lower_ = lower;
    found_.where = patch.sample;
  }

  void halve() {
    std::vector<OpenPatch> next;
    next.reserve(2 * open_.size());
    for (const OpenPatch& patch : open_) {
      const auto halves = surfaces_[patch.cell.primitive].halves(patch.cell);
      if (!halves) {
        settled_ = std::max(settled_, patch.bound);
        continue;
      }
      for (const PatchCell& half : *halves) next.push_back({.cell = half, .bound = patch.bound});
    }
    open_ = std::move(next);
  }

  void report_progress() const {
    double bound = settled_;
    for (const OpenPatch& patch : open_) bound = std::max(bound, patch.bound);
    search_.progress(bound > 0.0 && bound < infinity ? std::min(1.0, target() / bound) : 0.0);
  }

  const TriangleTree& triangles_;
  const DeviationSearch& search_;
  std::vector<PatchedSurface> surfaces_;  // one a primitive
  std::vector<OpenPatch> open_;
  double settled_ = 0.0;  ///< upper bound for all patches that are not open any more
  double lower_ = 0.0;
  FarthestOfModel found_{};
};

}  // namespace

FarthestOfModel farthest_of_model(const Model& model, const TriangleTree& triangles, const DeviationSearch& search) {
  return PatchSearch(model, triangles, search)();
}

namespace {

constexpr std::size_t parts_a_task = 256;

struct Part {
  PatchCell cell;
  bool whole = false;  ///< all of the part is proven to lie on the boundary
  WeightedCell weighted = {{0.0, infinity}, {0.0, infinity}, {0.0, infinity}};  ///< the patch as a whole
  Point sample{};
  double radius = infinity;
};

class PatchMeanSearch {
 public:
  PatchMeanSearch(const Model& model, const TriangleTree& triangles, std::span<const double> percentiles,
                  double largest, const DeviationSearch& search, const std::vector<bool>& counted = {})
      : triangles_(triangles), percentiles_(percentiles), largest_(largest), search_(search) {
    for (std::uint32_t k = 0; k < model.primitives.size(); ++k) {
      surfaces_.emplace_back(model.primitives[k], k);
      if (!counted.empty() && !counted[k]) continue;
      for (const PatchCell& octant : surfaces_.back().octants()) {
        parts_.push_back({.cell = octant, .whole = search.to_each_primitive.empty()});
      }
    }
    bound(parts_);
  }

  ModelDistances operator()() {
    bool open = place(parts_);
    measure();
    while (open) {
      const std::vector<std::size_t> chosen = choose();
      if (chosen.empty()) return found_;
      open = !search_.ended() && found_.patches + 2 * chosen.size() <= search_.most_samples && halve(chosen);
      if (open) measure();
    }
    found_.ended = true;
    return found_;
  }

  ModelWithin within(double distance, double width) {
    bool open = place(parts_);
    ModelWithin result{.within = measured_within(distance)};
    while (open) {
      if (result.within.share.width() <= width) break;
      const std::vector<std::size_t> chosen = chosen_for_share(result.within, distance, width);
      if (chosen.empty()) break;
      open = !search_.ended() && found_.patches + 2 * chosen.size() <= search_.most_samples && halve(chosen);
      if (open) result.within = measured_within(distance);
    }
    result.patches = found_.patches;
    result.samples = found_.samples;
    result.ended = !open;
    return result;
  }

 private:
  AreaWithin measured_within(double distance) {
    cells_.clear();
    for (const Part& part : parts_) cells_.push_back(cell(part));
    return area_within(cells_, distance);
  }

  [[nodiscard]] std::vector<std::size_t> chosen_for_share(const AreaWithin& within, double distance,
                                                          double width) const {
    std::vector<bool> chosen(parts_.size(), false);
    choose_for_share(cells_, within, distance, width, chosen);
    return divisible_of(chosen);
  }

  [[nodiscard]] std::vector<std::size_t> divisible_of(const std::vector<bool>& chosen) const {
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i] && surfaces_[parts_[i].cell.primitive].halves(parts_[i].cell)) indices.push_back(i);
    }
    return indices;
  }

  void bound(std::vector<Part>& parts) {
    for (const Part& part : parts) surfaces_[part.cell.primitive].prepare(part.cell);
    const std::size_t tasks = (parts.size() + parts_a_task - 1) / parts_a_task;
    search_.in_parallel(tasks, [&](std::size_t task) {
      const std::size_t end = std::min(parts.size(), (task + 1) * parts_a_task);
      for (std::size_t i = task * parts_a_task; i < end; ++i) bound(parts[i]);
    });
    found_.patches += parts.size();
  }

  /// The distances of the two flat triangles' points, moved to the patch. Bounds that are proven for a larger patch are
  /// valid for its parts.
  void bound(Part& part) const {
    const PatchedSurface& surface = surfaces_[part.cell.primitive];
    const Patch patch = surface.patch(part.cell);
    const PatchArea area = surface.area(part.cell);
    part.sample = patch.sample;
    part.radius = patch.radius;
    const double largest_weight = part.weighted.weight.hi;
    part.weighted = weighted_patch(patch, area, triangles_, part.weighted.range);
    part.weighted.weight = {part.whole ? area.area.lo : 0.0, std::min(largest_weight, area.area.hi)};
  }

  /// Finds the parts that lie on the boundary, and those that do not. If no other primitive's surface comes near,
  /// either all of a part lies on it or none; the sample's distance decides. False if it ended early: then parts are
  /// unchanged.
  [[nodiscard]] bool place(std::vector<Part>& parts) {
    std::vector<std::size_t> open;
    std::vector<Point> points;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].whole) continue;
      open.push_back(i);
      points.push_back(parts[i].sample);
    }
    if (open.empty()) return true;
    std::vector<Enclosure> to_model(points.size(), {-infinity, infinity});
    if (!search_.to_model(points, to_model)) return false;
    std::vector<bool> alone(points.size(), true);
    std::vector<Enclosure> rows(points.size());
    for (std::size_t k = 0; k < search_.to_each_primitive.size(); ++k) {
      rows.assign(points.size(), {-infinity, infinity});
      if (!search_.to_each_primitive[k](points, rows)) return false;
      for (std::size_t i = 0; i < open.size(); ++i) {
        const Part& part = parts[open[i]];
        if (part.cell.primitive != k && !(magnitude(rows[i]).lo > part.radius)) alone[i] = false;
      }
    }
    found_.samples += points.size() * (1 + search_.to_each_primitive.size());
    std::vector<bool> off(parts.size(), false);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Enclosure from_boundary = magnitude(to_model[i]);
      Part& part = parts[open[i]];
      off[open[i]] = from_boundary.lo > part.radius || part.weighted.range.lo > largest_;
      if (alone[i] && from_boundary.hi < part.radius) {
        part.whole = true;
        part.weighted.weight.lo = surfaces_[part.cell.primitive].area(part.cell).area.lo;
      }
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (!off[i]) parts[kept++] = parts[i];
    }
    parts.resize(kept);
    return true;
  }

  [[nodiscard]] WeightedCell cell(const Part& part) const { return on_boundary(part.weighted, part.whole, largest_); }

  void measure() {
    cells_.clear();
    for (const Part& part : parts_) cells_.push_back(cell(part));
    found_.mean = mean_of(cells_);
    const Distribution distribution(cells_);
    found_.percentiles.clear();
    for (const double percent : percentiles_) found_.percentiles.push_back(distribution.percentile(percent));
  }

  /// The choice proves nothing.
  [[nodiscard]] std::vector<std::size_t> choose() const {
    std::vector<bool> chosen(parts_.size(), false);
    choose_for_mean(cells_, found_.mean, search_.allowed(found_.mean.lo), chosen);
    for (std::size_t i = 0; i < percentiles_.size(); ++i) {
      const Enclosure& value = found_.percentiles[i];
      choose_for_percentile(cells_, value, percentiles_[i] / 100.0, search_.allowed(value.lo), chosen);
    }
    return divisible_of(chosen);
  }

  /// False where it ended early: the parts are as before.
  [[nodiscard]] bool halve(const std::vector<std::size_t>& chosen) {
    std::vector<Part> next;
    next.reserve(2 * chosen.size());
    std::vector<bool> is_chosen(parts_.size(), false);
    for (const std::size_t i : chosen) {
      is_chosen[i] = true;
      Part half = parts_[i];
      const auto halves = surfaces_[half.cell.primitive].halves(half.cell);
      for (const PatchCell& cell : *halves) {
        half.cell = cell;
        next.push_back(half);
      }
    }
    bound(next);
    if (!place(next)) return false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (!is_chosen[i]) next.push_back(parts_[i]);
    }
    parts_ = std::move(next);
    return true;
  }

  const TriangleTree& triangles_;
  std::span<const double> percentiles_;
  double largest_;  // of the boundary
  const DeviationSearch& search_;
  std::vector<PatchedSurface> surfaces_;  // one a primitive
  std::vector<Part> parts_;
  std::vector<WeightedCell> cells_;  // of the parts
  ModelDistances found_{};
};

}  // namespace

ModelDistances distances_of_model(const Model& model, const TriangleTree& triangles,
                                  std::span<const double> percentiles, double largest, const DeviationSearch& search) {
  return PatchMeanSearch(model, triangles, percentiles, largest, search)();
}

ModelWithin model_within(const Model& model, const TriangleTree& triangles, const std::vector<bool>& counted,
                         double distance, double width, const DeviationSearch& search) {
  return PatchMeanSearch(model, triangles, {}, infinity, search, counted).within(distance, width);
}

}  // namespace verisq::verify
