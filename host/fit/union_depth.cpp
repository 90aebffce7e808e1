/// The host's proofs for the points inside, or a map of all.
#include "host/fit/union_depth.hpp"

#include <algorithm>
#include <mutex>
#include <numeric>

#include "host/threads/parallel.hpp"
#include "verisq/map.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq::fit_search {

namespace {

constexpr double kTolerance = 1e-9;
/// Of distances that searches find.
constexpr double kSearchedTolerance = 1e-6;

/// What is wide, by an interruption or at the limits of the methods, stays as it is.
void take_if_narrow(double& known, const Enclosure& found, double tolerance) {
  if (found.width() <= 10.0 * tolerance) known = std::midpoint(found.lo, found.hi);
}

void map_all(const Model& posed, const Cavity& cavity, const std::string& device,
             const std::function<bool()>& interrupted, std::vector<double>& known) {
  const double tolerance = kSearchedTolerance * bounding_radius(posed);
  std::size_t row = 0;
  std::size_t asked = 0;
  PointMapper mapper(posed, {.tolerance = tolerance, .device = device, .interrupted = interrupted});
  mapper.map(
      [&](std::span<Point> points) {
        const std::size_t count = std::min(points.size(), cavity.points.size() - asked);
        std::copy_n(cavity.points.begin() + static_cast<std::ptrdiff_t>(asked), count, points.begin());
        asked += count;
        return count;
      },
      [&](std::span<const Point>, std::span<const MapResult> rows, std::span<const Certificate>) {
        for (const MapResult& found : rows) take_if_narrow(known[row++], found.distance, tolerance);
      });
}

void prove_inside(const Model& posed, const Cavity& cavity, const std::function<bool()>& interrupted,
                  std::vector<double>& known) {
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
  in_parallel(inside.size(), [&](std::size_t n) {
    take_if_narrow(known[inside[n]], signed_distance(cavity.points[inside[n]], tolerance, poll), tolerance);
  });
}

}  // namespace

UnionDepth union_depth(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                       std::span<const PointDistance> distances, const std::string& device,
                       const std::function<bool()>& interrupted) {
  std::vector<double> known;
  known.reserve(distances.size());
  for (const PointDistance& at : distances) known.push_back(at.distance);
  if (!is_union_of_convex(posed)) {
    map_all(posed, cavity, device, interrupted, known);
  } else if (posed.primitives.size() > 1) {
    prove_inside(posed, cavity, interrupted, known);
  }
  UnionDepth result{0.0, 0.0};
  for (std::size_t i = 0; i < known.size(); ++i) {
    result.objective += cavity.areas[cavity.area_of[i]].weight * value(fitness, known[i]);
    result.deepest_penetration = std::max(result.deepest_penetration, -known[i]);
  }
  return result;
}

}  // namespace verisq::fit_search
