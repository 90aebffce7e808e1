/// The limit of penetration of pose_search.hpp.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/clearance.hpp"
#include "host/plan/pose_search.hpp"
#include "host/prepare/eigen_points.hpp"
#include "verisq/clearance.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

FullEvaluation::FullEvaluation(const CandidateSpace& space, CandidateEvaluator& evaluator, const Cavity& cavity,
                               const Requirements& asked, const Fitness& fitness, double penetration_limit,
                               SearchWatch& watch)
    : space_(space),
      evaluator_(evaluator),
      cavity_(cavity),
      asked_(asked),
      fitness_(fitness),
      penetration_limit_(penetration_limit),
      watch_(watch),
      result_{} {}

const FullEvaluation::Result& FullEvaluation::at(std::span<const double> parameters) {
  if (std::ranges::equal(parameters, parameters_)) return result_;
  parameters_.assign(parameters.begin(), parameters.end());
  const Candidate candidate = space_.candidate(parameters);
  evaluator_.distances(candidate, result_.distances);
  watch_.count(1);
  EvaluationSum sum(fitness_, candidate);
  for (std::size_t i = 0; i < cavity_.points.size(); ++i)
    sum.add(cavity_.points[i], cavity_.areas[cavity_.area_of[i]].weight, result_.distances[i]);
  result_.evaluation = sum.result();
  result_.deepest_penetration = std::max(-result_.evaluation.smallest_distance, 0.0);
  result_.within_limit = -result_.evaluation.smallest_distance <= penetration_limit_;
  const double broken = asked_.broken(parameters_, candidate);
  if (result_.within_limit && broken == 0.0) watch_.found(result_.evaluation.objective);
  asked_.size.add_to(result_.evaluation, candidate);
  const double apart = asked_.contacts.add_to(result_.evaluation, candidate);
  const Found found{.parameters = parameters_,
                    .objective = result_.evaluation.objective,
                    .deepest_penetration = result_.deepest_penetration,
                    .within_limit = result_.within_limit,
                    .broken = broken,
                    .apart = apart};
  incumbent_.offer(found);
  latest_.offer(found);
  return result_;
}

namespace {

constexpr int kMostRounds = 12;
constexpr StoppingCriteria kRefinement{.step = 1e-8, .evaluations = 80};
constexpr StoppingCriteria kRestoration{.step = 1e-8, .evaluations = 120};
/// Points added in a round, at most.
constexpr std::size_t kAdded = 128;
/// In parts of the fitness' scale: the distance from the limit within which a point is watched, and the margin that
/// keeps rounding from crossing the limit.
constexpr double kWatched = 0.5;
constexpr double kMargin = 1e-6;
/// In parts of the sum of weights: the gain that makes another round worthwhile.
constexpr double kWorthwhile = 1e-9;

class LimitedRefinement {
 public:
  explicit LimitedRefinement(FullEvaluation& cavity)
      : cavity_(cavity), scale_(cavity.fitness().scale), units_(cavity.space().units()) {
    for (double& unit : units_) unit *= scale_;
    for (const std::uint32_t area : cavity.cavity().area_of) weight_ += cavity.cavity().areas[area].weight;
  }

  void run(Parameters parameters) {
    double reached = -infinity;
    for (int round = 0; round < kMostRounds && !cavity_.watch().ended(); ++round) {
      const bool more = watch_worst(parameters);
      // If the nearest primitive changes, the distance has a kink, at which the optimiser may stop early: a fresh start
      // continues.
      const double objective = cavity_.at(parameters).evaluation.objective;
      if (!more && objective <= reached + kWorthwhile * weight_) break;
      reached = more ? -infinity : objective;
      parameters = maximised(limited_problem(), restored(parameters), kRefinement);
    }
    (void)restored(parameters);
  }

  void restore(const Parameters& parameters) { (void)restored(parameters); }

 private:
  /// The distance left to the limit and the margin; negative beyond it.
  [[nodiscard]] double slack(const PointDistance& at) const {
    return at.distance + cavity_.penetration_limit() - kMargin * scale_;
  }

  /// Adds points to the watched; false where all that are too deep are watched already.
  bool watch_worst(const Parameters& parameters) {
    const std::vector<PointDistance>& distances = cavity_.at(parameters).distances;
    const bool first = watched_.empty();
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t i = 0; i < distances.size(); ++i) {
      const bool near = slack(distances[i]) < (first ? kWatched * scale_ : 0.0);
      if (near && !std::ranges::binary_search(watched_, i)) candidates.push_back(i);
    }
    std::ranges::stable_sort(candidates, {}, [&](std::uint32_t i) { return distances[i].distance; });
    candidates.resize(std::min(candidates.size(), kAdded));
    watched_.insert(watched_.end(), candidates.begin(), candidates.end());
    std::ranges::sort(watched_);
    return !candidates.empty();
  }

  [[nodiscard]] MaximisationProblem problem(
      double typical, std::function<double(std::span<const double>, std::span<double>)> objective) const {
    return {.lower = cavity_.space().lower(),
            .upper = cavity_.space().upper(),
            .units = units_,
            .typical = typical,
            .objective = std::move(objective),
            .interrupted = [this] { return cavity_.watch().ended(); }};
  }

  /// The objective, the watched points as constraints in parts of the scale.
  [[nodiscard]] MaximisationProblem limited_problem() {
    MaximisationProblem result =
        problem(weight_ + cavity_.asked().most(), [this](std::span<const double> x, std::span<double> gradient) {
          const Evaluation& found = cavity_.at(x).evaluation;
          std::ranges::copy(cavity_.space().gradient(x, found.pose_gradient, found.size_gradient), gradient.begin());
          return found.objective;
        });
    result.constraints = watched_.size() + cavity_.asked().constraints.rows();
    result.constraint_tolerance = kMargin / 2.0;
    result.constrain = [this](std::span<const double> x, std::span<double> values, std::span<double> jacobian) {
      const FullEvaluation::Result& found = cavity_.at(x);
      for (std::size_t j = 0; j < watched_.size(); ++j) {
        values[j] = slack(found.distances[watched_[j]]) / scale_;
        const std::span<double> row = jacobian.subspan(j * x.size(), x.size());
        write_derivatives(x, watched_[j], found.distances[watched_[j]], row);
        for (double& derivative : row) derivative /= scale_;
      }
      const PoseConstraints& asked = cavity_.asked().constraints;
      std::ranges::transform(asked.slack(x), values.begin() + static_cast<std::ptrdiff_t>(watched_.size()),
                             [](double slack) { return slack - kMargin; });
      std::ranges::copy(asked.jacobian(x), jacobian.begin() + static_cast<std::ptrdiff_t>(watched_.size() * x.size()));
    };
    return result;
  }

  void write_derivatives(std::span<const double> x, std::uint32_t point, const PointDistance& at,
                         std::span<double> row) const {
    const Point pivot = cavity_.space().pivot(x);
    const auto by_pose = pose_gradient(cavity_.cavity().points[point], pivot, at.normal);
    cavity_.space().gradient(x, by_pose, at, row);
  }

  /// Adds the squares of the constraints' violations; subtracts their derivatives from the gradient.
  [[nodiscard]] double add_missing(std::span<const double> x, std::span<double> gradient) const {
    const PoseConstraints& asked = cavity_.asked().constraints;
    std::vector<double> missing = asked.slack(x);
    for (double& slack : missing) slack = std::min(slack - 2.0 * kMargin, 0.0);
    double sum = 0.0;
    for (const double part : missing) sum += part * part;
    if (sum == 0.0) return sum;  // derivatives cost a dozen values each
    const std::vector<double> derivatives = asked.jacobian(x);
    for (std::size_t j = 0; j < missing.size(); ++j) {
      for (std::size_t k = 0; k < x.size(); ++k) gradient[k] -= 2.0 * missing[j] * derivatives[j * x.size() + k];
    }
    return sum;
  }

  /// From a candidate beyond the limit to one within it, if one is near: least squares of the excess depths of all
  /// points.
  [[nodiscard]] Parameters restored(const Parameters& parameters) const {
    const PoseConstraints& asked = cavity_.asked().constraints;
    if (cavity_.at(parameters).within_limit && asked.violation(parameters) == 0.0) return parameters;
    std::vector<double> row(parameters.size());
    Parameters best = parameters;
    double least = infinity;
    const auto minus_squares = [&](std::span<const double> x, std::span<double> gradient) {
      const FullEvaluation::Result& found = cavity_.at(x);
      double sum = 0.0;
      std::ranges::fill(gradient, 0.0);
      for (std::uint32_t i = 0; i < found.distances.size(); ++i) {
        // Twice the margin: the squares leave a little of the excess.
        const double missing = std::min(slack(found.distances[i]) - kMargin * scale_, 0.0) / scale_;
        if (missing == 0.0) continue;
        sum += missing * missing;
        write_derivatives(x, i, found.distances[i], row);
        for (std::size_t k = 0; k < row.size(); ++k) gradient[k] -= 2.0 * missing * row[k] / scale_;
      }
      sum += add_missing(x, gradient);
      if (sum < least) {
        least = sum;
        best.assign(x.begin(), x.end());
      }
      return -sum;
    };
    (void)maximised(problem(1.0, minus_squares), parameters, kRestoration);
    return best;
  }

  FullEvaluation& cavity_;
  double scale_;
  Parameters units_;
  double weight_ = 0.0;
  std::vector<std::uint32_t> watched_;  ///< ascending
};

}  // namespace

void refine_within_limit(FullEvaluation& cavity, const Parameters& start) {
  LimitedRefinement(cavity).run(start);
}

void restore_within_limit(FullEvaluation& cavity, const Parameters& start) {
  LimitedRefinement(cavity).restore(start);
}

namespace {

/// A patch: grids of so many points either side of the middle, each this much finer than the outermost.
constexpr int patch_reach = 2;
constexpr std::array patch_scales{1.0, 4.0, 16.0};

double length(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Parts that the sides of a triangle are cut into.
double parts(const Cavity& cavity, const std::array<std::uint32_t, 3>& triangle, double spacing) {
  const Point& a = cavity.points[triangle[0]];
  const Point& b = cavity.points[triangle[1]];
  const Point& c = cavity.points[triangle[2]];
  return std::max(std::ceil(std::max({length(a, b), length(b, c), length(c, a)}) / spacing), 1.0);
}

double number_of_points(const Cavity& cavity, double spacing) {
  double number = 0.0;
  for (const auto& triangle : cavity.triangles) {
    const double n = parts(cavity, triangle, spacing);
    number += (n + 1.0) * (n + 2.0) / 2.0 - 3.0;
  }
  return number;
}

void add_grid(Cavity& cavity, const std::array<std::uint32_t, 3>& triangle, double spacing) {
  const auto n = static_cast<int>(parts(cavity, triangle, spacing));
  const auto [a, b, c] = std::array{cavity.points[triangle[0]], cavity.points[triangle[1]], cavity.points[triangle[2]]};
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      if (i == n || j == n || i + j == 0) continue;  // the corners are there
      const double of_b = static_cast<double>(i) / n;
      const double of_c = static_cast<double>(j) / n;
      Point point;
      for (std::size_t k = 0; k < 3; ++k) point[k] = a[k] + of_b * (b[k] - a[k]) + of_c * (c[k] - a[k]);
      cavity.points.push_back(point);
    }
  }
}

}  // namespace

std::vector<Point> patch(const Triangle& triangle, const Point& middle, double spacing) {
  const Eigen::Vector3d a = vector_of(triangle[0]);
  const Eigen::Vector3d ab = vector_of(triangle[1]) - a;
  const Eigen::Vector3d ac = vector_of(triangle[2]) - a;
  const Eigen::Vector3d normal = ab.cross(ac);
  const Eigen::Vector3d along = ab.normalized();
  const Eigen::Vector3d across = normal.cross(ab).normalized();
  const auto in_triangle = [&](const Eigen::Vector3d& x) {
    const double of_b = (x - a).cross(ac).dot(normal) / normal.squaredNorm();
    const double of_c = ab.cross(x - a).dot(normal) / normal.squaredNorm();
    return of_b >= 0.0 && of_c >= 0.0 && of_b + of_c <= 1.0;
  };
  std::vector<Point> points{middle};
  for (const double finer : patch_scales) {
    for (int i = -patch_reach; i <= patch_reach; ++i) {
      for (int j = -patch_reach; j <= patch_reach; ++j) {
        const Eigen::Vector3d x = vector_of(middle) + spacing / finer * (i * along + j * across);
        if ((i != 0 || j != 0) && in_triangle(x)) points.push_back({x[0], x[1], x[2]});
      }
    }
  }
  return points;
}

Cavity with_surface_points(const Cavity& cavity, double spacing, std::size_t most_points) {
  Cavity result = cavity;
  if (cavity.triangles.empty()) return result;
  while (number_of_points(cavity, spacing) > static_cast<double>(most_points) &&
         number_of_points(cavity, 2.0 * spacing) < number_of_points(cavity, spacing))
    spacing *= 2.0;
  for (const auto& triangle : cavity.triangles) add_grid(result, triangle, spacing);
  result.areas.push_back({"between the points", 0.0});
  result.area_of.resize(result.points.size(), static_cast<std::uint32_t>(result.areas.size() - 1));
  return result;
}

namespace {

constexpr int most_rounds = 24;
/// One after the other: the implant is too large, or may not move.
constexpr int most_futile_rounds = 10;
constexpr int most_unmoved_rounds = 5;
/// In parts of the surface's tolerance: the accuracy of a first proof, and the distances within the limit at which the
/// search stays so that a closer proof can succeed.
constexpr double coarse = 100.0;
constexpr double kept_away = 2.0;
constexpr double farther_away = 4.0;
/// In parts of the objective: the gain that makes another round worthwhile once a pose is proven.
constexpr double worthwhile = 1e-4;
/// Rounds after which a pose is no longer improved, only moved away from the surface, farther each time: along a flat
/// side the best pose slides between any points.
constexpr int patient_rounds = 3;
constexpr double impatience = 2.0;
/// The grid about the implant: the largest number of points on the whole surface, and the distance, in spacings, of
/// points that are close.
constexpr std::size_t most_grid_points = 100'000;
constexpr double close_by = 2.0;
/// Distance of the outer points of a patch, in spacings.
constexpr double patch_spacing = 0.5;
/// Limits of one proof, a coarse and a close one: if it would need more, a pose a little farther away is proven sooner.
constexpr std::uint64_t most_coarse_samples = std::uint64_t{1} << 13U;
constexpr std::uint64_t most_samples = std::uint64_t{1} << 16U;
constexpr std::uint64_t most_estimates = std::uint64_t{1} << 18U;
/// If a point is deeper in an overlap of primitives than in each of them, the search's limit is lowered in proportion,
/// and by this factor more.
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
    for (int round = 0, futile = 0, unmoved = 0; round < most_rounds && !watch_.ended(); ++round) {
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

  /// A close proof, if a coarse proof finds nothing too deep. With bends and set operations a proof takes many times as
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
                           .interrupted = [this] { return watch_.ended(); }});
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
                          .interrupted = [this] { return watch_.ended(); }});
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

  /// For a candidate that the search considers within the limit, but a proof does not.
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
