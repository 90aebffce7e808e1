/// Rounds of proof and search.
#include "host/fit/surface_limit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/clearance/mesh_estimate.hpp"
#include "host/fit/full_evaluation.hpp"
#include "host/fit/host_evaluator.hpp"
#include "host/fit/penetration_limit.hpp"
#include "host/fit/surface_points.hpp"
#include "verisq/mesh_clearance.hpp"
#include "verisq/posed_model.hpp"

namespace verisq::fit_search {
namespace {

constexpr int most_rounds = 24;
/// One after the other: the implant is too large, or may not move.
constexpr int most_futile_rounds = 10;
constexpr int most_unmoved_rounds = 5;
/// In parts of the tolerance of the surface: how closely a proof follows it at first, and how far within the limit the
/// search stays so that a closer one can succeed.
constexpr double coarse = 100.0;
constexpr double kept_away = 2.0;
constexpr double farther_away = 4.0;
/// In parts of the objective: what makes another round worth its while once a pose is proven.
constexpr double worthwhile = 1e-4;
/// Rounds after which a pose is no longer improved, only moved away from the surface, farther each time: along a flat
/// side the best pose slides between any points.
constexpr int patient_rounds = 3;
constexpr double impatience = 2.0;
/// The grid about the implant: how many points on the whole surface at most, and which are close, in spacings.
constexpr std::size_t most_grid_points = 100'000;
constexpr double close_by = 2.0;
/// Of the outer points of a patch, in spacings.
constexpr double patch_spacing = 0.5;
/// Of one proof, a coarse and a close one: where it would need more, a pose a little farther away is proven sooner.
constexpr std::uint64_t most_coarse_samples = std::uint64_t{1} << 13U;
constexpr std::uint64_t most_samples = std::uint64_t{1} << 16U;
constexpr std::uint64_t most_estimates = std::uint64_t{1} << 18U;
/// A point that is deeper in an overlap of primitives than in each of them: the search's limit is lowered in
/// proportion, and by this factor more.
constexpr double lowering = 0.98;

class SurfaceSearch {
 public:
  SurfaceSearch(const CandidateSpace& space, const Cavity& cavity, const Requirements& asked, const FitOptions& options,
                double spacing, std::string device, const MakeEvaluator& make_evaluator, SearchWatch& watch)
      : space_(space),
        asked_(asked),
        options_(options),
        spacing_(spacing),
        device_(std::move(device)),
        make_evaluator_(make_evaluator),
        watch_(watch),
        mesh_{cavity.points, cavity.triangles},
        guarded_(cavity),
        limit_(options.penetration_limit),
        kept_away_(kept_away * options.surface_tolerance) {
    guarded_.areas.push_back({"between the points", 0.0});
  }

  /// The points of a grid on the surface that the implant comes close to.
  void guard_grid_about(const Found& found) {
    const Cavity grid = with_surface_points({mesh_.vertices, {{"points", 1.0}}, zeros(mesh_), mesh_.triangles},
                                            spacing_, most_grid_points);
    std::vector<PointDistance> distances;
    make_evaluator_(grid)->distances(space_.candidate(found.parameters), distances);
    std::vector<Point> close;
    for (std::size_t i = mesh_.vertices.size(); i < grid.points.size(); ++i)
      if (distances[i].distance < close_by * spacing_) close.push_back(grid.points[i]);
    guard(close);
  }

  Found within(Found found) {
    std::optional<Found> best;
    Found shallowest = found;
    for (int round = 0, futile = 0, unmoved = 0; round < most_rounds && !watch_.interrupted(); ++round) {
      const MeshClearance clearance = proven(found);
      if (clearance.interrupted) break;
      found.deepest_penetration = std::max(-clearance.smallest_distance.hi, 0.0);
      found.within_limit = clearance.proven_too_deep == 0;
      if (round == 0 || found.deepest_penetration < shallowest.deepest_penetration) shallowest = found;
      const bool all_proven = clearance.proven_too_deep + clearance.undecided == 0;
      if (!all_proven) {
        if (++futile > most_futile_rounds) break;
        if (futile > patient_rounds) kept_away_ *= impatience;
      } else {
        // A repaired pose is not yet the best nearby: the search goes on from there while that pays.
        if (best && (found.broken > best->broken || found.apart > best->apart)) break;
        if (best && found.objective <= best->objective + worthwhile * std::abs(best->objective)) break;
        best = found;
        futile = 0;
        kept_away_ = kept_away * options_.surface_tolerance;
      }
      guard(clearance.too_deep);
      const Parameters earlier = found.parameters;
      found = next(found, futile, all_proven);
      unmoved = found.parameters == earlier ? unmoved + 1 : 0;
      if (unmoved > most_unmoved_rounds) break;
    }
    if (best) return *best;
    shallowest.within_limit = false;  // not proven of the whole surface
    return shallowest;
  }

 private:
  static std::vector<std::uint32_t> zeros(const Mesh& mesh) {
    return std::vector<std::uint32_t>(mesh.vertices.size(), 0);
  }

  /// Closely, where a coarse proof finds nothing too deep. With bends and set operations a proof takes many times as
  /// long as an estimate, which comes first.
  [[nodiscard]] MeshClearance proven(const Found& found) {
    if (!is_union_of_convex(space_.sized(found.parameters))) {
      MeshClearance estimate = estimated(found);
      if (estimate.interrupted || estimate.proven_too_deep + estimate.undecided > 0) return estimate;
    }
    MeshClearance coarsely = proven(found, coarse);
    return coarsely.proven_too_deep == 0 ? proven(found, 1.0) : coarsely;
  }

  [[nodiscard]] MeshClearance proven(const Found& found, double coarseness) {
    const Model model = posed(space_.sized(found.parameters), space_.pose(found.parameters));
    return mesh_clearance(model, mesh_,
                          {.penetration_limit = options_.penetration_limit,
                           .tolerance = coarse * options_.surface_tolerance,
                           .limit_tolerance = coarseness * options_.surface_tolerance,
                           .most_samples = coarseness > 1.0 ? most_coarse_samples : most_samples,
                           .device = device_,
                           .interrupted = [this] { return watch_.interrupted(); }});
  }

  [[nodiscard]] MeshClearance estimated(const Found& found) {
    const Candidate candidate = space_.candidate(found.parameters);
    const auto distances = [&](std::span<const Point> points) {
      const std::vector<double> weights(points.size(), 0.0);
      std::vector<PointDistance> at;
      host_candidate_evaluator(points, weights)->distances(candidate, at);
      std::vector<double> found_distances;
      found_distances.reserve(at.size());
      for (const PointDistance& each : at) found_distances.push_back(each.distance);
      return found_distances;
    };
    return mesh_estimate(distances, mesh_,
                         {.penetration_limit = options_.penetration_limit,
                          .tolerance = coarse * options_.surface_tolerance,
                          .limit_tolerance = options_.surface_tolerance,
                          .most_samples = most_estimates,
                          .interrupted = [this] { return watch_.interrupted(); }});
  }

  void guard(const std::vector<PointOnTriangle>& deep) {
    for (const auto& [point, n] : deep) {
      const auto& [a, b, c] = mesh_.triangles[n];
      guard(patch({mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]}, point, patch_spacing * spacing_));
    }
  }

  void guard(const std::vector<Point>& points) {
    guarded_.points.insert(guarded_.points.end(), points.begin(), points.end());
    guarded_.area_of.resize(guarded_.points.size(), static_cast<std::uint32_t>(guarded_.areas.size() - 1));
  }

  [[nodiscard]] Found next(const Found& found, int futile, bool proven) {
    return futile > patient_rounds ? restored(found) : searched(found, proven);
  }

  [[nodiscard]] Found searched(const Found& found, bool proven) {
    const std::unique_ptr<CandidateEvaluator> evaluator = make_evaluator_(guarded_);
    if (!proven && evaluation(*evaluator).at(found.parameters).within_limit) tighten(found);
    FullEvaluation full = evaluation(*evaluator);
    refine_within_limit(full, found.parameters);
    return *full.best();
  }

  [[nodiscard]] Found restored(const Found& found) {
    const std::unique_ptr<CandidateEvaluator> evaluator = make_evaluator_(guarded_);
    FullEvaluation full = evaluation(*evaluator);
    restore_within_limit(full, found.parameters);
    return *full.best();
  }

  [[nodiscard]] FullEvaluation evaluation(CandidateEvaluator& evaluator) {
    return {space_, evaluator, guarded_, asked_, options_.fitness, limit_ - kept_away_, watch_};
  }

  /// For a candidate that the search takes to be within the limit, and a proof does not.
  void tighten(const Found& found) {
    if (found.within_limit)
      kept_away_ *= farther_away;  // too close to be decided
    else
      limit_ *= lowering * std::min(options_.penetration_limit / found.deepest_penetration, 1.0);
  }

  const CandidateSpace& space_;
  const Requirements& asked_;
  const FitOptions& options_;
  double spacing_;
  std::string device_;
  const MakeEvaluator& make_evaluator_;
  SearchWatch& watch_;
  Mesh mesh_;
  Cavity guarded_;
  double limit_;
  double kept_away_;
};

}  // namespace

Found within_surface(const CandidateSpace& space, const Found& start, const Cavity& cavity, const Requirements& asked,
                     double spacing, const FitOptions& options, const std::string& device,
                     const MakeEvaluator& make_evaluator, SearchWatch& watch) {
  SurfaceSearch search(space, cavity, asked, options, spacing, device, make_evaluator, watch);
  search.guard_grid_about(start);
  return search.within(start);
}

}  // namespace verisq::fit_search
