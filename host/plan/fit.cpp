/// The search of a fit: sampled starts, refined from a wide fitness to the given one, then within the limit.
#include "verisq/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "host/device/device.hpp"
#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/pose_search.hpp"
#include "host/plan/requirements.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "verify/solids/model.hpp"
#include "verisq/device.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq {

namespace {

using namespace fit_search;

/// Points of a thinned cavity: enough to distinguish good poses from bad ones, and to climb by.
constexpr std::size_t kSampledPoints = 128;
constexpr std::size_t kClimbedPoints = 384;

/// Graduated optimisation: the scale of the fitness in each round, the starts that take part, and their stopping
/// criteria.
constexpr double kSampledWidening = 16.0;
struct Round {
  double widening;
  std::size_t starts;
  StoppingCriteria stop;
};
constexpr std::array kRounds{Round{16.0, 16, {1e-3, 40}}, Round{4.0, 16, {1e-3, 40}}, Round{1.0, 8, {1e-4, 60}}};
/// Starts that are refined with all points within the limit.
constexpr std::size_t kFinalists = 4;
/// In parts of the fitness' scale: poses whose surfaces are about this close are one finalist, and one start. Both
/// would climb to the same maximum.
constexpr double kDistinct = 0.1;
/// Factors of the steps within which points count as in contact: first as wide as the fitness' scale, then half as wide
/// each time.
constexpr double kContactWidening = 10.0;
constexpr double kDistinctStarts = 0.25;
/// Points added between the cavity's points: they distinguish most poses that cut the surface from those that do not.
constexpr std::size_t kSurfacePoints = 4096;
/// Shares of the work on an implant, when sampling and the rounds are done.
constexpr double kSampled = 0.3;
constexpr double kClimbed = 0.7;
/// Times that the search's limit is lowered because bone lies deeper in an overlap than in any primitive.
constexpr int kMostSettlings = 5;
/// Factor of the lowered limit.
constexpr double kSettlingMargin = 0.98;

void require(bool holds, std::string_view message) {
  if (!holds) throw Error(ErrorKind::input, std::string(message));
}

void check(const Cavity& cavity, const FitOptions& options) {
  check_fit_problem(cavity, options.fitness, options.penetration_limit, options.range);
  for (const FitConstraint& constraint : options.constraints) {
    require(constraint.range.lo <= constraint.range.hi && constraint.unit > 0.0 && constraint.value != nullptr,
            fmt::format("constraint {}: needs a range, a positive unit and a value", constraint.name));
  }
  for (const FitContact& contact : options.contacts) {
    require(!contact.points.empty() && contact.weights.size() == contact.points.size() &&
                contact.share.lo <= contact.share.hi,
            fmt::format("contact {}: needs a range, points, and a weight for each", contact.name));
  }
  require(cavity.triangles.empty() || (options.surface_tolerance > 0.0 && std::isfinite(options.surface_tolerance)),
          fmt::format("surface tolerance: must be finite and positive, not {}", options.surface_tolerance));
}

std::vector<CandidateSpace> spaces_of(std::span<const UncertainModel> series, const PoseRange& range) {
  std::vector<CandidateSpace> spaces;
  for (std::size_t i = 0; i < series.size(); ++i) {
    try {
      spaces.emplace_back(series[i], range);
    } catch (const Error& error) {
      throw Error(error.kind(), fmt::format("implants[{}]: {}", i, error.what()));
    }
  }
  return spaces;
}

std::vector<double> weights_of(const Cavity& cavity) {
  std::vector<double> weights;
  weights.reserve(cavity.points.size());
  for (const std::uint32_t area : cavity.area_of) weights.push_back(cavity.areas[area].weight);
  return weights;
}

void check_sides(std::span<const UncertainModel> series, const Cavity& cavity, const FitOptions& options) {
  if (options.sides.empty()) return;
  require(options.sides.size() == series.size(),
          fmt::format("sides: of {} implants, where there are {}", options.sides.size(), series.size()));
  for (std::size_t i = 0; i < series.size(); ++i) {
    require(options.sides[i].size() == series[i].primitives.size(),
            fmt::format("sides[{}]: of {} primitives, where there are {}", i, options.sides[i].size(),
                        series[i].primitives.size()));
  }
  check_surface_has_sides({cavity.points, cavity.triangles});
}

/// Nothing if the implants may be anywhere.
std::optional<InsideTest> inside_test(const Cavity& cavity, const FitOptions& options) {
  if (options.sides.empty()) return std::nullopt;
  return InsideTest({cavity.points, cavity.triangles});
}

/// An empty selection means the host.
device::Selection selected(const FitOptions& options) {
  if (options.device == "host") return {};
  return device::select_device(options.device, either(options.interrupted, options.out_of_time));
}

/// Kernels evaluate unions of convex primitives; for others a device maps the found pose.
bool kernels_evaluate(std::span<const UncertainModel> series) {
  return std::ranges::all_of(
      series, [](const UncertainModel& implant) { return is_union_of_convex(bracket(implant).largest); });
}

bool with_meshes(std::span<const UncertainModel> series) {
  return std::ranges::any_of(series, [](const UncertainModel& implant) { return has_mesh(bracket(implant).largest); });
}

/// An evaluator of the points whose kernels are compiled. Nothing, and no device, if the search is to end first: the
/// host then computes the remaining evaluations.
std::unique_ptr<CandidateEvaluator> compiled_on(device::Selection& selection, const Cavity& cavity,
                                                std::span<const CandidateSpace> spaces, const FitOptions& options) {
  std::vector<Candidate> candidates;
  for (const CandidateSpace& space : spaces) candidates.push_back(space.candidate(space.start()));
  const auto make = [candidates, points = cavity.points, weights = weights_of(cavity),
                     fitness = options.fitness](const device::Device& device) {
    auto evaluator = device::device_candidate_evaluator(device, points, weights);
    std::vector<Evaluation> evaluations;
    std::vector<PointDistance> distances;
    for (const Candidate& candidate : candidates) {
      evaluator->evaluate({&candidate, 1}, fitness, {}, 1, evaluations);
      evaluator->distances(candidate, distances);
    }
    return evaluator;
  };
  return made_ready(selection, options.device, either(options.interrupted, options.out_of_time), make);
}

MakeEvaluator evaluator_on(const std::optional<device::Device>& device, bool kernels) {
  return [&device, kernels](const Cavity& cavity) {
    const std::vector<double> weights = weights_of(cavity);
    return device && kernels ? device::device_candidate_evaluator(*device, cavity.points, weights)
                             : host_candidate_evaluator(cavity.points, weights);
  };
}

/// The cavity in which every implant of the series is searched: its own points count; the limit holds at these and at
/// others on the surface between them.
struct SearchedCavity {
  /// `of_points` is an evaluator of the points, if there is one already.
  SearchedCavity(const Cavity& cavity, double spacing, const MakeEvaluator& make,
                 std::unique_ptr<CandidateEvaluator> of_points)
      : points(cavity),
        surface(with_surface_points(cavity, spacing, kSurfacePoints)),
        point_evaluator(of_points ? std::move(of_points) : make(points)),
        surface_evaluator(make(surface)) {}

  const Cavity& points;
  Cavity surface;  ///< the points are its first
  std::unique_ptr<CandidateEvaluator> point_evaluator;
  std::unique_ptr<CandidateEvaluator> surface_evaluator;
};

/// Half the least side of its box.
double smallest_half_width(const Mesh& mesh) {
  const Extent extent = extent_of(mesh.vertices);
  double smallest = infinity;
  for (std::size_t i = 0; i < 3; ++i) smallest = std::min(smallest, 0.5 * (extent.upper[i] - extent.lower[i]));
  return smallest;
}

/// The smallest semi-axis, about that of a mesh, too: no part of an implant slips through from one side to the other.
double spacing_of_surface_points(std::span<const UncertainModel> series) {
  double smallest = infinity;
  for (const UncertainModel& implant : series) {
    for (const UncertainPrimitive& primitive : implant.primitives) {
      if (primitive.mesh) {
        smallest = std::min(smallest, smallest_half_width(*primitive.mesh));
        continue;
      }
      for (const Enclosure& semi_axis : primitive.semi_axes) smallest = std::min(smallest, semi_axis.hi);
    }
  }
  return smallest;
}

/// The search for one implant.
class ImplantSearch {
 public:
  ImplantSearch(const CandidateSpace& space, std::size_t implant, SearchedCavity& cavity, const Requirements& asked,
                const FitOptions& options, std::string device, SearchWatch& watch)
      : space_(space),
        implant_(implant),
        evaluator_(*cavity.point_evaluator),
        cavity_(cavity.points),
        surface_(cavity.surface),
        surface_evaluator_(*cavity.surface_evaluator),
        asked_(asked),
        options_(options),
        device_(std::move(device)),
        watch_(watch),
        weights_(weights_of(cavity_)),
        full_(space, *cavity.surface_evaluator, cavity.surface, asked, options.fitness, options.penetration_limit,
              watch) {}

  /// The best pose; of the surface it considers only the search's points.
  Found best() {
    watch_.at(implant_, 0.0);
    full_.at(space_.start());  // so that there is a best pose, whenever the search is interrupted
    std::vector<Ranked> starts = global_start(space_, evaluator_, asked_, landscape(kSampledWidening, kSampledPoints),
                                              {options_.samples, options_.seed, kRounds[0].starts}, watch_);
    watch_.at(implant_, kSampled);
    for (std::size_t round = 0; round < std::size(kRounds); ++round) {
      climb(starts, kRounds[round]);
      watch_.at(implant_, kSampled + (kClimbed - kSampled) * static_cast<double>(round + 1) / std::size(kRounds));
    }
    keep_best(starts, kFinalists);
    for (const Pose& pose : options_.tried) refine(space_.nearest(pose));
    for (std::size_t i = 0; i < starts.size() && !watch_.ended(); ++i) {
      refine(starts[i].parameters);
      watch_.at(implant_,
                kClimbed + (1.0 - kClimbed) * static_cast<double>(i + 1) / static_cast<double>(starts.size()));
    }
    return cavity_.triangles.empty() ? settled(*full_.best()) : *full_.best();
  }

  /// The refined pose of each start, but for the best and those close to a better one.
  [[nodiscard]] std::vector<Found> others() {
    std::vector<Found> ranked = refined_;
    std::ranges::stable_sort(ranked, better);
    std::vector<Found> distinct;
    for (const Found& found : ranked) {
      const auto is_close = [&](const Found& other) { return close(found.parameters, other.parameters, kDistinct); };
      if (std::ranges::none_of(distinct, is_close)) distinct.push_back(found);
    }
    if (!distinct.empty()) distinct.erase(distinct.begin());
    for (Found& found : distinct) found = found_in_union(found);
    return distinct;
  }

  Found found_in_union(const Found& found) {
    const Model model = posed(space_.sized(found.parameters), space_.pose(found.parameters));
    const std::span<const PointDistance> distances = full_.at(found.parameters).distances;
    const UnionDepth depth = union_depth(model, cavity_, options_.fitness, distances.first(cavity_.points.size()),
                                         device_, [this] { return watch_.ended(); });
    return {.parameters = found.parameters,
            .objective = depth.objective,
            .deepest_penetration = depth.deepest_penetration,
            .within_limit = depth.deepest_penetration <= options_.penetration_limit,
            .broken = found.broken,
            .apart = found.apart};
  }

 private:
  [[nodiscard]] Landscape landscape(double widening, std::size_t points) const {
    const std::size_t stride = std::max<std::size_t>(weights_.size() / points, 1);
    double weight = 0.0;
    for (std::size_t i = 0; i < weights_.size(); i += stride) weight += weights_[i];
    return {widened(options_.fitness, widening), stride, weight > 0.0 ? weight : 1.0};
  }

  void refine(const Parameters& start) {
    full_.begin_anew();
    refine_within_limit(full_, asked_.contacts.asks() ? towards_contact(start) : start);
    if (full_.best_since()) refined_.push_back(*full_.best_since());
  }

  /// Near a pose that serves best there may be no contact that a small step would change.
  [[nodiscard]] Parameters towards_contact(const Parameters& start) {
    Parameters reached = start;
    Requirements wide = asked_;
    for (double widening = kContactWidening; widening > 1.0 && !watch_.ended(); widening /= 2.0) {
      wide.contacts = asked_.contacts.widened(widening);
      FullEvaluation guided(space_, surface_evaluator_, surface_, wide, options_.fitness, options_.penetration_limit,
                            watch_);
      refine_within_limit(guided, reached);
      reached = guided.best()->parameters;
    }
    return reached;
  }

  [[nodiscard]] bool close(const Parameters& a, const Parameters& b, double scales) const {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (std::fabs(a[i] - b[i]) > scales * options_.fitness.scale * space_.units()[i]) return false;
    }
    return true;
  }

  /// Of starts that are close to each other keeps only the best.
  void keep_best(std::vector<Ranked>& starts, std::size_t count) const {
    std::ranges::stable_sort(starts, [](const Ranked& a, const Ranked& b) { return a.objective > b.objective; });
    std::vector<Ranked> kept;
    for (const Ranked& start : starts) {
      if (kept.size() == count) break;
      const auto is_close = [&](const Ranked& other) {
        return close(start.parameters, other.parameters, kDistinctStarts);
      };
      if (std::ranges::none_of(kept, is_close)) kept.push_back(start);
    }
    starts = std::move(kept);
  }

  void climb(std::vector<Ranked>& starts, const Round& round) {
    keep_best(starts, round.starts);
    const Landscape climbed = landscape(round.widening, kClimbedPoints);
    for (Ranked& start : starts) {
      if (watch_.ended()) return;
      start = refined(space_, evaluator_, asked_, climbed, start.parameters, round.stop, watch_);
    }
  }

  /// Replaces the search's depths by those in the union. If these break the limit, the search is repeated nearby under
  /// a limit that is lower in the same proportion.
  Found settled(Found found) {
    double limit = options_.penetration_limit;
    for (int settling = 0;; ++settling) {
      const Found in_union = found_in_union(found);
      if (in_union.within_limit || !found.within_limit || settling == kMostSettlings || watch_.ended()) return in_union;
      limit *= kSettlingMargin * options_.penetration_limit / in_union.deepest_penetration;
      FullEvaluation lower(space_, evaluator_, cavity_, asked_, options_.fitness, limit, watch_);
      refine_within_limit(lower, found.parameters);
      found = *lower.best();
    }
  }

  const CandidateSpace& space_;
  std::size_t implant_;
  CandidateEvaluator& evaluator_;
  const Cavity& cavity_;
  const Cavity& surface_;  ///< with points between those of the cavity
  CandidateEvaluator& surface_evaluator_;
  const Requirements& asked_;
  const FitOptions& options_;
  std::string device_;
  SearchWatch& watch_;
  std::vector<double> weights_;
  FullEvaluation full_;
  std::vector<Found> refined_;  ///< from each start
};

/// The best pose of an implant, and the other refined poses.
struct FoundOfImplant {
  Found best;
  double size;
  std::vector<Found> others;
};

/// Compares two implants of the series.
bool better(const FoundOfImplant& a, const FoundOfImplant& b, FitObjective objective) {
  const bool alike = a.best.broken == b.best.broken && a.best.apart == b.best.apart &&
                     a.best.within_limit == b.best.within_limit &&
                     (a.best.within_limit || a.best.deepest_penetration == b.best.deepest_penetration);
  if (objective == FitObjective::size && alike && a.size != b.size) return a.size > b.size;
  return fit_search::better(a.best, b.best);
}

FitFinalist finalist(const CandidateSpace& space, std::size_t implant, const Found& found) {
  const Pose pose = space.pose(found.parameters);
  return {.implant = implant,
          .pose = pose,
          .model = posed(space.sized(found.parameters), pose),
          .objective = found.objective,
          .deepest_penetration = found.deepest_penetration,
          .within_limit = found.within_limit,
          .kept = found.broken == 0.0 && found.apart == 0.0};
}

std::vector<FitFinalist> finalists_of(std::span<const CandidateSpace> spaces, std::span<const FoundOfImplant> found,
                                      std::size_t chosen) {
  std::vector<FitFinalist> finalists;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i != chosen) finalists.push_back(finalist(spaces[i], i, found[i].best));
  }
  for (const Found& other : found[chosen].others) finalists.push_back(finalist(spaces[chosen], chosen, other));
  std::ranges::stable_sort(finalists, [](const FitFinalist& a, const FitFinalist& b) {
    return std::tuple(a.kept, a.within_limit, a.objective) > std::tuple(b.kept, b.within_limit, b.objective);
  });
  return finalists;
}

}  // namespace

Fit fit(std::span<const UncertainModel> series, const Cavity& cavity, const FitOptions& options) {
  require(!series.empty(), "fit: no implant to fit");
  for (const UncertainModel& implant : series) verify::require_valid_with_meshes(implant);
  check(cavity, options);
  check_sides(series, cavity, options);
  const std::vector<CandidateSpace> spaces = spaces_of(series, options.range);
  device::Selection selection = selected(options);
  const bool kernels = kernels_evaluate(series);
  auto of_points = kernels ? compiled_on(selection, cavity, spaces, options) : nullptr;
  const std::string device = selection.device && !with_meshes(series) ? selection.device->name : "host";
  const MakeEvaluator make_evaluator = evaluator_on(selection.device, kernels);
  const double spacing = spacing_of_surface_points(series);
  SearchedCavity searched(cavity, spacing, make_evaluator, std::move(of_points));
  SearchWatch watch(options, series.size());
  const std::optional<InsideTest> inside = inside_test(cavity, options);
  std::size_t implant = 0;
  std::vector<FoundOfImplant> all;
  double weight = 0.0;
  for (const double each : weights_of(cavity)) weight += each;
  for (std::size_t i = 0; i < spaces.size() && (i == 0 || !watch.ended()); ++i) {
    const Requirements asked{inside ? SideRequirements(*inside, options.sides[i]) : SideRequirements(),
                             PoseConstraints(spaces[i], options.constraints, i),
                             ContactAim(options.contacts, options.fitness.scale, weight, make_evaluator),
                             options.objective == FitObjective::size ? SizeAim(spaces[i], weight) : SizeAim()};
    ImplantSearch search(spaces[i], i, searched, asked, options, device, watch);
    Found found = search.best();
    if (!cavity.triangles.empty()) {
      found = within_surface(spaces[i], found, cavity, asked, spacing, options, device, make_evaluator, watch);
      found.objective = search.found_in_union(found).objective;
    }
    all.push_back({found, implant_size(spaces[i].sized(found.parameters)), search.others()});
    if (better(all.back(), all[implant], options.objective)) implant = i;
  }
  const bool out_of_time = watch.out_of_time();
  const Found& best = all[implant].best;
  const Pose pose = spaces[implant].pose(best.parameters);
  return {.implant = implant,
          .pose = pose,
          .model = posed(spaces[implant].sized(best.parameters), pose),
          .objective = best.objective,
          .deepest_penetration = best.deepest_penetration,
          .within_limit = best.within_limit,
          .movement = spaces[implant].movement(best.parameters),
          .finalists = finalists_of(spaces, all, implant),
          .interrupted = watch.ended() && watch.interrupted(),
          .out_of_time = out_of_time,
          .poses = watch.poses(),
          .device = device,
          .notice = selection.notice};
}

}  // namespace verisq
