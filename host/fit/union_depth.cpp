/// The host's proofs for the points inside.
#include "host/fit/union_depth.hpp"

#include <algorithm>
#include <mutex>
#include <numeric>

#include "host/threads/parallel.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq::fit_search {

namespace {

constexpr double kTolerance = 1e-9;

}  // namespace

UnionDepth union_depth(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                       std::span<const PointDistance> distances, const std::function<bool()>& interrupted) {
  std::vector<double> known;
  known.reserve(distances.size());
  for (const PointDistance& at : distances) known.push_back(at.distance);
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (known[i] < 0.0) inside.push_back(i);

  std::mutex polling;
  const auto poll = [&] {
    const std::lock_guard lock(polling);
    return interrupted();
  };
  const SignedDistance signed_distance(posed);
  const double tolerance = kTolerance * bounding_radius(posed);
  if (posed.primitives.size() > 1) {
    in_parallel(inside.size(), [&](std::size_t n) {
      const Enclosure found = signed_distance(cavity.points[inside[n]], tolerance, poll);
      // Wide where the search was interrupted.
      if (found.width() <= 10.0 * tolerance) known[inside[n]] = std::midpoint(found.lo, found.hi);
    });
  }
  UnionDepth result{0.0, 0.0};
  for (std::size_t i = 0; i < known.size(); ++i) {
    result.objective += cavity.areas[cavity.area_of[i]].weight * value(fitness, known[i]);
    result.deepest_penetration = std::max(result.deepest_penetration, -known[i]);
  }
  return result;
}

}  // namespace verisq::fit_search
