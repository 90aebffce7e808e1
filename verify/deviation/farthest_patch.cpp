/// Generation by generation: patches that cannot hold the farthest point are settled by their bound, those that are
/// proven off the boundary of the solid are dropped, the others are halved.
#include "verify/deviation/farthest_patch.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "verify/deviation/patch_distance.hpp"
#include "verify/deviation/surface_patch.hpp"
#include "verify/deviation/triangle_piece.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq::verify {

namespace {

/// Many patches a thread at a time.
constexpr std::size_t patches_a_task = 256;

struct OpenPatch {
  PatchCell cell;
  double bound = infinity;  ///< no point of it that belongs to the boundary is farther
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

  /// Drops what is proven off the boundary; what is near it bounds the supremum from below. False where it ended early.
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
  double settled_ = 0.0;  ///< of all patches that are not open any more
  double lower_ = 0.0;
  FarthestOfModel found_{};
};

}  // namespace

FarthestOfModel farthest_of_model(const Model& model, const TriangleTree& triangles, const DeviationSearch& search) {
  return PatchSearch(model, triangles, search)();
}

}  // namespace verisq::verify
