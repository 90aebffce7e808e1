/// This file implements certified_rows.hpp.
#include "host/maps/certified_rows.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "host/errors/refusal.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/search/set_tree.hpp"

namespace verisq {
namespace {

/// Work before a time limit begins must not take long, and each cube of a large model evaluates many leaves. Of `most`
/// cubes or searches, returns so many that they take no longer than all of them in a model of 64 leaves; at least one.
std::size_t affordable(std::size_t most, const Model& model) {
  constexpr std::size_t size = 64;
  return std::max<std::size_t>(1, most * size / std::max(verify::size_of_tree(model), size));
}

constexpr std::size_t most_cubes_of_rough_search = 256;

Enclosure rough_distance(const Model& model, const SignedDistance& distance, const Point& point, double tolerance,
                         const std::function<bool()>& interrupted) {
  std::size_t polled = 0;
  const std::size_t cubes = affordable(most_cubes_of_rough_search, model);
  return distance(point, tolerance, [&] { return ++polled > cubes || interrupted(); });
}

// A lower end beyond all numbers proves that the model is empty.
bool is_proven_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted) {
  if (is_union_of_convex(model)) return false;
  const Point& centre = model.primitives.front().pose.translation;
  const Enclosure found = rough_distance(model, distance, centre, bounding_radius(model), interrupted);
  return found.lo == std::numeric_limits<double>::max();
}

constexpr std::size_t most_known_centres = 16;

}  // namespace

void refuse_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted) {
  if (is_proven_empty(model, distance, interrupted))
    refuse("the model has no point at all: its set operations leave nothing");
}

void refuse_empty_members(const Bracket& models, const std::function<bool()>& interrupted) {
  const auto is_empty = [&](const Model& model) { return is_proven_empty(model, SignedDistance(model), interrupted); };
  if (verify::same_solids(models) || !is_empty(models.smallest)) return;
  if (is_empty(models.largest))
    refuse("no model that the intervals allow has a point: the set operations leave nothing");
  refuse(
      "the model's intervals are too wide: with what is kept at its smallest and what is removed at its largest the "
      "set "
      "operations leave no point, so that no distance is known to hold for all models that they allow; narrow them");
}

verify::CoarseDistance coarse_distance(const Model& model, const SignedDistance& distance,
                                       const std::function<bool()>& interrupted) {
  const double rough = 0x1p-6 * bounding_radius(model);
  std::vector<verify::KnownDistance> known;
  const std::size_t size = model.primitives.size();
  const std::size_t count = std::min(size, affordable(most_known_centres, model));
  for (std::size_t i = 0; i < count; ++i) {
    const Point& centre = model.primitives[i * size / count].pose.translation;
    known.push_back({centre, rough_distance(model, distance, centre, rough, interrupted)});
  }
  return {model, known};
}

}  // namespace verisq
