/// Searches of few cubes, so that they take no longer in large models.
#include "host/maps/rough_distance.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "verify/sets/set_tree.hpp"
#include "verisq/error.hpp"

namespace verisq {
namespace {

/// What comes before a time limit begins must not take long, and each cube of a large model looks at many leaves: of
/// `most` cubes or searches so many as take no longer than all of them in a model of 64 leaves; at least one.
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

constexpr std::size_t most_known_centres = 16;

}  // namespace

// A search tells nothing by a lower end beyond all numbers.
void refuse_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted) {
  if (is_union_of_convex(model)) return;
  const Point& centre = model.primitives.front().pose.translation;
  const Enclosure found = rough_distance(model, distance, centre, bounding_radius(model), interrupted);
  if (found.lo == std::numeric_limits<double>::max())
    throw Error(ErrorKind::input, "the model has no point at all: its set operations leave nothing");
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
