/// Fits: the pose and the sizes of an implant that serve a bone best, and the proof of how well.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/fit.hpp>
#include <verisq/fit_solution.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {

namespace {

namespace py = pybind11;

using Weights = std::map<std::string, double>;
using Ranges = std::map<std::string, std::pair<double, double>>;

/// What was found, and what of it is proven.
struct PythonFit {
  PythonModel model;
  FitSolution solution;
  FitProof proof;
  PythonMap map;
  std::vector<SurfaceSide> required_sides;
  bool as_asked;
  ClearanceTerms terms;
  std::optional<PythonCertifiedBound> certified_bound;
  std::optional<PythonCertifiedContact> certified_contact;
};

/// "implant", or "implants[k]" where there are several.
std::vector<FitImplant> implants_of(const py::object& object) {
  if (py::isinstance<PythonModel>(object)) {
    const auto& model = object.cast<const PythonModel&>();
    return {{"implant", model.model(), model.landmarks(), model.areas()}};
  }
  std::vector<FitImplant> implants;
  if (!py::isinstance<py::iterable>(object)) throw py::type_error("implants must be a Model or a sequence of them");
  for (const py::handle& each : object) {
    if (!py::isinstance<PythonModel>(each))
      throw py::type_error(fmt::format("implants[{}] must be a Model", implants.size()));
    const auto& model = each.cast<const PythonModel&>();
    implants.push_back({fmt::format("implants[{}]", implants.size()), model.model(), model.landmarks(), model.areas()});
  }
  if (implants.empty()) throw py::value_error("implants must not be empty");
  return implants;
}

std::optional<FitSurface> surface_of(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  if (*word == "cavity") return FitSurface::cavity;
  if (*word == "bone") return FitSurface::bone;
  if (*word == "any") return FitSurface::unsided;
  throw py::value_error(fmt::format("surface must be \"cavity\", \"bone\", \"any\" or None, not \"{}\"", *word));
}

Completion completion_of(const std::string& word) {
  if (word == "cementless") return Completion::cementless;
  if (word == "cemented") return Completion::cemented;
  throw py::value_error(fmt::format("completion must be \"cementless\" or \"cemented\", not \"{}\"", word));
}

FitObjective objective_of(const std::string& word) {
  if (word == "fitness") return FitObjective::fitness;
  if (word == "size") return FitObjective::size;
  throw py::value_error(fmt::format("objective must be \"fitness\" or \"size\", not \"{}\"", word));
}

std::optional<bool> on_triangles(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  if (*word != "vertices" && *word != "triangles")
    throw py::value_error(fmt::format("on must be \"vertices\", \"triangles\" or None, not \"{}\"", *word));
  return *word == "triangles";
}

std::vector<Area> areas_of(const Weights& weights) {
  std::vector<Area> areas;
  for (const auto& [name, weight] : weights) {
    check_length(weight, "a weight");
    areas.push_back({name, weight});
  }
  return areas;
}

std::vector<KeptFeature> kept_of(const Ranges& ranges) {
  std::vector<KeptFeature> kept;
  for (const auto& [name, range] : ranges) {
    const auto& [lo, hi] = range;
    if (!(lo <= hi)) throw py::value_error(fmt::format("keep: {} is not from {} to {}", name, lo, hi));
    kept.push_back({name, {lo, hi}});
  }
  return kept;
}

std::optional<Cavity> labelled(const py::object& labels, const Mesh& mesh, const std::vector<Area>& weights) {
  if (labels.is_none()) return std::nullopt;
  const std::vector<std::int64_t> values = integers(labels, "labels");
  if (values.size() != mesh.vertices.size()) {
    throw py::value_error(fmt::format("there are {} labels for {} vertices", values.size(), mesh.vertices.size()));
  }
  try {
    return labelled_cavity(mesh.vertices, values, weights);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("labels: {}", error.what()));
  }
}

/// A share, of percents as the command line has them.
std::optional<double> gap_of(const std::optional<double>& percent) {
  if (!percent) return std::nullopt;
  if (!(*percent > 0.0 && *percent < 100.0))
    throw py::value_error(fmt::format("bound must be above 0 and below 100 percent, not {}", *percent));
  return *percent / 100.0;
}

void check_ranges(const FitRequest& request) {
  constexpr double half_turn = 180.0;
  constexpr std::size_t most_samples = 1'000'000'000;
  for (const auto& [name, value] : {std::pair("gap", request.gap), std::pair("gap_tolerance", request.gap_tolerance),
                                    std::pair("translation_range", request.translation_range)}) {
    if (value) check_length(*value, name);
  }
  if (request.gap_tolerance == 0.0) throw py::value_error("gap_tolerance must be above 0");
  check_length(request.penetration_limit, "penetration_limit");
  check_length(request.rotation_range, "rotation_range");
  if (request.rotation_range > half_turn) throw py::value_error("rotation_range must be at most 180 degrees");
  if (request.samples < 1 || request.samples > most_samples)
    throw py::value_error(fmt::format("samples must be 1 to {}", most_samples));
}

/// Before Python sees any of it.
struct FoundFit {
  FitSolution solution;
  FitProof proof;
  std::vector<MapResult> rows;
  std::vector<Certificate> certificates;  ///< none, or one a row
  double tolerance;
  std::optional<CertifiedBestFit> best;          ///< nothing without certificates or a bound
  std::optional<CertifiedContact> contact = {};  ///< nothing without certificates or triangles
};

/// Searches and proves, without Python's lock.
class FitRun {
 public:
  FitRun(const FitProblem& problem, Interruption& interruption, const std::optional<double>& gap, double bound_time,
         const std::optional<double>& time_limit, const std::optional<double>& tolerance, bool certificates)
      : problem_(problem),
        interrupted_(interruption.poll()),
        gap_(gap),
        bound_limit_(bound_time),
        limit_(time_limit, interrupted_),
        tolerance_(tolerance),
        certificates_(certificates) {}

  FoundFit operator()() {
    limit_.start();
    FoundFit found{.solution = solve_fit(problem_, options()),
                   .proof = {},
                   .rows = {},
                   .certificates = {},
                   .tolerance = 0.0,
                   .best = {}};
    const Model& fitted = found.solution.fit.model;
    found.tolerance = tolerance_or_default(tolerance_, bounding_radius(fitted));
    const auto sink = [&](std::span<const Point>, std::span<const MapResult> rows,
                          std::span<const Certificate> certificates) {
      found.rows.insert(found.rows.end(), rows.begin(), rows.end());
      found.certificates.insert(found.certificates.end(), certificates.begin(), certificates.end());
    };
    found.proof = prove_fit(problem_, found.solution,
                            {.tolerance = found.tolerance,
                             .device = problem_.options.device,
                             .certificates = certificates_,
                             .interrupted = interrupted_,
                             .out_of_time = limit_.out_of_time()},
                            sink);
    if (certificates_ && found.solution.bound) found.best = certified_bound(*found.solution.bound);
    if (certificates_ && found.proof.contact && !has_mesh(fitted)) {
      found.contact = certified_contact(problem_, found.solution.fit, found.proof, limit_.stop());
      if (found.contact->proven.interrupted) found.contact.reset();
    }
    return found;
  }

 private:
  [[nodiscard]] std::optional<CertifiedBestFit> certified_bound(const FitBound& bound) const {
    CheckOptions check;
    check.interrupted = limit_.stop();
    const FitOptions& options = problem_.options;
    return certified_best_fit(problem_.series, problem_.cavity,
                              {options.fitness, options.penetration_limit, options.range}, bound, check);
  }

  /// The time of the bound begins when a first pose is found.
  FitSolutionOptions options() {
    FitSolutionOptions result{.gap = gap_, .interrupted = interrupted_};
    result.found = [this](const Fit&) { bound_limit_.start(); };
    result.out_of_time = bound_limit_.out_of_time();
    result.search_out_of_time = limit_.out_of_time();
    return result;
  }

  const FitProblem& problem_;
  std::function<bool()> interrupted_;
  std::optional<double> gap_;
  Deadline bound_limit_;
  Deadline limit_;
  std::optional<double> tolerance_;
  bool certificates_;
};

PythonCertifiedContact contact_with_names(const FitProblem& problem, CertifiedContact contact) {
  PythonCertifiedContact result{
      {}, std::move(contact.terms), std::move(contact.claims), std::move(contact.certificate)};
  for (const Area& area : problem.cavity.areas) result.areas.push_back(area.name);
  return result;
}

PythonFit solved(FitRequest request, const std::optional<double>& bound, double bound_time,
                 const std::optional<double>& time_limit, const std::optional<double>& tolerance, bool certificates) {
  check_ranges(request);
  check_time_limit(bound_time);
  check_time_limit(time_limit);
  if (tolerance) check_length(*tolerance, "tolerance");
  const std::optional<double> gap = gap_of(bound);
  Interruption interruption;
  const FitProblem problem = without_lock(interruption, [&] { return fit_problem(std::move(request)); });
  FitRun run(problem, interruption, gap, bound_time, time_limit, tolerance, certificates);
  FoundFit found = without_lock(interruption, [&] { return run(); });
  const Fit& fit = found.solution.fit;
  const bool as_asked = is_as_asked(problem, found.solution, found.proof, gap);
  std::vector<SurfaceSide> sides;
  if (!problem.options.sides.empty()) sides = problem.options.sides[fit.implant];
  PythonModel model(fit.model, posed(problem.implant_landmarks[fit.implant], fit.pose));
  std::optional<PythonCertifiedBound> certified_bound;
  if (found.best) certified_bound = {std::move(found.best->claim), std::move(found.best->certificate)};
  std::optional<PythonCertifiedContact> certified_contact;
  if (found.contact) certified_contact = contact_with_names(problem, std::move(*found.contact));
  PythonMap map = map_of_rows(found.rows, found.proof.clearance.map, found.tolerance);
  if (certificates) map.certificates = std::make_shared<CertificateList>(std::move(found.certificates));
  return {std::move(model),
          std::move(found.solution),
          std::move(found.proof),
          std::move(map),
          std::move(sides),
          as_asked,
          {problem.options.fitness, problem.options.penetration_limit, problem.cavity.areas, problem.cavity.area_of},
          std::move(certified_bound),
          std::move(certified_contact)};
}

/// Of what was found of sides.
bool are_sides_proved(const PythonFit& self, const Mesh& mesh, const CheckOptions& options) {
  if (!self.proof.sides) return true;
  const std::vector<SideClaim> claims = claims_of(*self.proof.sides, self.required_sides);
  if (claims.empty()) return true;
  const SideChecker checker(self.solution.fit.model, mesh, self.terms.penetration_limit);
  return std::ranges::all_of(claims,
                             [&](const SideClaim& claim) { return checker(claim, options) == SideFinding::kept; });
}

/// Every distance by its certificate, and then what they say together; and sides.
bool is_proved(const PythonFit& self, const PythonMesh& mesh) {
  if (!self.map.certificates) throw py::value_error("certificates: fit(..., certificates=True) keeps them");
  const std::vector<Certificate>& certificates = self.map.certificates->certificates;
  const std::vector<Point>& vertices = mesh.mesh.vertices;
  if (vertices.size() != certificates.size())
    throw py::value_error(
        fmt::format("mesh: has {} vertices, and the fit is of {}", vertices.size(), certificates.size()));
  const auto lo = self.map.lo.unchecked<1>();
  const auto hi = self.map.hi.unchecked<1>();
  return without_lock([&](const Interrupted& interrupted) {
    const Checker checker{UncertainModel(self.solution.fit.model)};
    std::vector<Enclosure> proven;
    bool all = true;
    for (std::size_t i = 0; i < vertices.size() && !interrupted(); ++i) {
      const auto row = static_cast<py::ssize_t>(i);
      const Finding found = checker(vertices[i], {lo(row), hi(row)}, certificates[i], interrupted);
      all = all && found.verdict == Verdict::proved;
      proven.push_back(found.proven);
    }
    if (proven.size() < vertices.size()) return false;
    const std::vector<Finding> claims = check(claims_of(self.proof.clearance), clearance_of(self.terms, proven));
    return all && std::ranges::all_of(claims, [](const Finding& f) { return f.verdict == Verdict::proved; }) &&
           are_sides_proved(self, mesh.mesh, {.interrupted = interrupted});
  });
}

PythonFit fit_of(const py::object& implants, const PythonMesh& mesh, const std::optional<std::string>& surface,
                 const py::object& resection, const std::vector<std::string>& crossing,
                 const std::vector<std::string>& outside, const std::optional<py::dict>& landmarks,
                 const std::optional<std::string>& landmark_side, double landmark_radius, const Ranges& keep,
                 const std::string& objective, bool implant_contact, const std::string& completion,
                 const std::optional<double>& gap, const std::optional<double>& gap_tolerance, double penetration_limit,
                 const std::optional<std::string>& on, const py::object& pose_start,
                 const std::optional<double>& translation_range, double rotation_range, const py::object& labels,
                 const Weights& weights, const std::optional<double>& bound, double bound_time,
                 const std::optional<double>& time_limit, std::uint64_t seed, std::size_t samples,
                 const std::optional<double>& tolerance, bool certificates, const std::string& device) {
  FitRequest request{.implants = implants_of(implants),
                     .mesh_name = "mesh",
                     .mesh = mesh.mesh,
                     .surface = surface_of(surface),
                     .resection = plane(resection),
                     .crossing = crossing,
                     .outside = outside,
                     .kept = kept_of(keep),
                     .objective = objective_of(objective),
                     .implant_contact = implant_contact,
                     .completion = completion_of(completion),
                     .gap = gap,
                     .gap_tolerance = gap_tolerance,
                     .penetration_limit = penetration_limit,
                     .on_triangles = on_triangles(on),
                     .pose_start = pose(pose_start),
                     .translation_range = translation_range,
                     .rotation_range = rotation_range,
                     .seed = seed,
                     .samples = samples,
                     .weights = areas_of(weights),
                     .device = device};
  check_length(landmark_radius, "landmark_radius");
  if (landmarks) request.landmarks = {"landmarks", landmarks_of(*landmarks), side_of(landmark_side), landmark_radius};
  request.labelled = labelled(labels, request.mesh, request.weights);
  if (certificates && request.resection)
    throw py::value_error("certificates: not with a resection: cut the mesh first");
  return solved(std::move(request), bound, bound_time, time_limit, tolerance, certificates);
}

py::array_t<double> pose_array(const PythonFit& self) {
  const Pose& pose = self.solution.fit.pose;
  py::array_t<double> result(7);
  double* next = result.mutable_data();
  for (const double number : pose.translation) *next++ = number;
  for (const double number : pose.quaternion) *next++ = number;
  return result;
}

/// Of those that have to lie on a side.
py::object sides(const PythonFit& self) {
  if (!self.proof.sides) return py::none();
  py::dict result;
  for (std::size_t k = 0; k < self.required_sides.size(); ++k) {
    if (self.required_sides[k] == SurfaceSide::any) continue;
    result[py::str(name_of_primitive(self.solution.fit.model, k))] =
        std::string(to_string(self.proof.sides->of_primitives[k]));
  }
  return result;
}

/// By the names that `keep` knows them by.
py::object contact(const PythonFit& self) {
  if (!self.proof.contact) return py::none();
  py::dict result;
  result["contact"] = self.proof.contact->of_mesh;
  for (std::size_t k = 0; k < self.proof.contact->by_region.size(); ++k)
    result[py::str("contact:" + self.proof.clearance.areas[k].area.name)] = self.proof.contact->by_region[k];
  if (self.proof.contact->of_model) result["implant_contact"] = *self.proof.contact->of_model;
  return result;
}

py::object unit(const FitCondition& self) {
  switch (self.unit) {
    case ConditionUnit::length: return py::str("length");
    case ConditionUnit::degrees: return py::str("degrees");
    case ConditionUnit::percent: return py::str("percent");
    case ConditionUnit::none: break;
  }
  return py::none();
}

py::object binds(const FitCondition& self) {
  if (!self.binds) return py::none();
  return py::str(*self.binds == RangeEnd::lower ? "lower" : "upper");
}

std::string representation(const PythonFit& self) {
  const Enclosure& objective = self.proof.clearance.objective;
  return fmt::format("<verisq.Fit: objective in [{}, {}]{}>", objective.lo, objective.hi,
                     self.as_asked ? "" : ", not all as asked");
}

/// Of an area without points there is none.
template <class Member>
auto of_points(Member member) {
  return [member](const AreaClearance& self) {
    return self.points > 0 ? std::optional<Enclosure>(self.*member) : std::nullopt;
  };
}

void declare_areas(py::module_& module) {
  py::class_<AreaClearance>(module, "AreaClearance", "What is proven of one area of a fit.")
      .def_property_readonly("name", [](const AreaClearance& self) { return self.area.name; })
      .def_property_readonly("weight", [](const AreaClearance& self) { return self.area.weight; })
      .def_readonly("points", &AreaClearance::points, "How many points it has.")
      .def_readonly("proven_within", &AreaClearance::proven_within, "How many are proven to be served.")
      .def_readonly("proven_outside", &AreaClearance::proven_outside, "How many are proven not to be.")
      .def_readonly("undecided", &AreaClearance::undecided, "All others.")
      .def_property_readonly("smallest_distance", of_points(&AreaClearance::smallest_distance), "Enclosure, or None.")
      .def_property_readonly("mean_distance", of_points(&AreaClearance::mean_distance),
                             "Enclosure, or None; each point counts once.")
      .def_property_readonly("median_distance", of_points(&AreaClearance::median_distance), "Enclosure, or None.")
      .def_property_readonly("distance_of_95", of_points(&AreaClearance::distance_of_95),
                             "Enclosure, or None: so near are at least 95 % of them.")
      .def(pickled<AreaClearance>());
  py::class_<FitBound>(module, "FitBound", "How good any pose of the range can be.")
      .def_readonly("upper", &FitBound::upper,
                    "Proven: no pose whose points all keep the limit has a larger objective; -inf: there is none.")
      .def_readonly("reached", &FitBound::reached, "Whether the search was known to be as near as asked for.")
      .def_readonly("out_of_time", &FitBound::out_of_time, "Whether bound_time ended it.")
      .def_readonly("boxes", &FitBound::boxes, "Of poses, looked at.")
      .def(pickled<FitBound>());
}

void declare_conditions(py::module_& module) {
  py::class_<AreaWithin>(module, "AreaWithin", "How much of an area is in contact, proven.")
      .def_readonly("area", &AreaWithin::area, "Enclosure of all of it.")
      .def_readonly("within", &AreaWithin::within, "Enclosure of what is in contact.")
      .def_readonly("share", &AreaWithin::share, "Enclosure, in [0, 1], of that over all.")
      .def(pickled<AreaWithin>());
  py::class_<FitCondition>(module, "FitCondition", "What is asked of a fit, and what is proven of it.")
      .def_readonly("name", &FitCondition::name, "\"smallest distance\", \"side of stem\", or as `keep` has it.")
      .def_property_readonly("unit", unit, "\"length\", \"degrees\", \"percent\"; None of sides.")
      .def_readonly("value", &FitCondition::value, "Enclosure, or None.")
      .def_readonly("asked", &FitCondition::range, "Enclosure that it has to lie in, or None.")
      .def_readonly("kept", &FitCondition::kept, "True or False where that is proven, else None.")
      .def_property_readonly("binds", binds, "\"lower\" or \"upper\" where it comes close to that end, else None.")
      .def(pickled<FitCondition>());
  py::class_<FitTrial>(module, "FitTrial", "What a fit found and did not choose: by a search that proves nothing.")
      .def_property_readonly(
          "implant", [](const FitTrial& self) { return self.fit.implant; }, "Which of the series.")
      .def_property_readonly("model", [](const FitTrial& self) { return PythonModel(self.fit.model, {}); })
      .def_property_readonly(
          "objective", [](const FitTrial& self) { return self.fit.objective; }, "About.")
      .def_property_readonly(
          "deepest_penetration", [](const FitTrial& self) { return self.fit.deepest_penetration; }, "About.")
      .def_readonly("size", &FitTrial::size, "The volumes of the primitives, added up.")
      .def_property_readonly(
          "changes", [](const FitTrial& self) { return self.changes.features; }, "A list of Feature, proven.")
      .def_readonly("kept", &FitTrial::kept, "Whether all that is asked was proven; None where it was not tried.")
      .def_readonly("not_proven", &FitTrial::open, "Names of conditions that were not proven.")
      .def(pickled<FitTrial>());
}

using FitClass = py::class_<PythonFit>;

/// Proven distances, sides, changes and contact.
void declare_proof(FitClass& fit) {
  const auto proven = [](auto Clearance::*member) {
    return [member](const PythonFit& self) { return self.proof.clearance.*member; };
  };
  fit.def_property_readonly("objective", proven(&Clearance::objective), "Enclosure of F, the paper's Eq. (4).")
      .def_property_readonly("smallest_distance", proven(&Clearance::smallest_distance), "Enclosure, of all vertices.")
      .def_property_readonly("deepest_penetration", proven(&Clearance::deepest_penetration),
                             "Enclosure, of all vertices; [0, 0] where all are proven outside.")
      .def_property_readonly("proven_too_deep", proven(&Clearance::proven_too_deep),
                             "How many vertices are proven to lie deeper in the implant than the limit.")
      .def_property_readonly("proven_within_limit", proven(&Clearance::proven_shallow),
                             "How many are proven to lie no deeper.")
      .def_property_readonly("areas", proven(&Clearance::areas), "A list of AreaClearance.")
      .def_property_readonly(
          "surface", [](const PythonFit& self) { return self.proof.surface; },
          "MeshClearance of all triangles; None where vertices alone keep the limit.")
      .def_property_readonly("sides", sides,
                             "For each primitive that has to lie on a side what is found of it: \"proven\", or why it\n"
                             "is not; None where sides do not matter.")
      .def_property_readonly(
          "changes", [](const PythonFit& self) { return self.proof.changes.features; },
          "A list of Feature: what the implant changes of the bone's; empty without its landmarks.")
      .def_property_readonly("contact", contact,
                             "For the mesh, each area and, where asked for, the implant, by the names of `keep`, an\n"
                             "AreaWithin; None for a mesh without triangles.")
      .def_property_readonly(
          "conditions", [](const PythonFit& self) { return self.proof.conditions; },
          "A list of FitCondition: all that was asked.");
}

/// Other finds, and how good a fit could be.
void declare_trials(FitClass& fit) {
  fit.def_property_readonly(
         "finalists", [](const PythonFit& self) { return self.solution.trials; },
         "A list of FitTrial: what else was found.")
      .def_property_readonly(
          "bound", [](const PythonFit& self) { return self.solution.bound; }, "FitBound, or None.")
      .def_readonly("certified_bound", &PythonFit::certified_bound,
                    "CertifiedBound: the same with what proves it again; None without certificates=True or a bound.")
      .def_readonly(
          "certified_contact", &PythonFit::certified_contact,
          "CertifiedContact: contact with what proves it again; None without certificates=True, or triangles.")
      .def_property_readonly(
          "gap", [](const PythonFit& self) { return self.proof.gap; },
          "What the objective is below the bound at most, as a share of it, proven; None where that is not known.")
      .def_property_readonly(
          "unfinished", [](const PythonFit& self) { return self.proof.unfinished; },
          "What time_limit left unproven: some of \"vertices\", \"surface\", \"sides\", \"contact\".")
      .def_property_readonly(
          "out_of_time", [](const PythonFit& self) { return self.solution.fit.out_of_time; },
          "Whether time_limit ended the search.")
      .def_readonly(
          "as_asked", &PythonFit::as_asked,
          "Every row verified, nothing proven too deep, sides, features and contact kept, the bound reached.");
}

void declare_class_of_fits(py::module_& module) {
  const auto searched = [](auto Fit::*member) {
    return [member](const PythonFit& self) { return self.solution.fit.*member; };
  };
  const auto moved = [](auto FitMovement::*member) {
    return [member](const PythonFit& self) { return self.solution.fit.movement.*member; };
  };
  FitClass fit(module, "Fit",
               "What fit() found, by a search that proves nothing, and what is proven of it: everything but\n"
               "pose, implant, searched_objective, moved_centre, moved_rotation, at_limits.");
  fit.def_readonly("model", &PythonFit::model, "The implant with its chosen sizes, in its place: what is proven of.")
      .def_property_readonly("pose", pose_array, "float64 (7,): translation and quaternion, after the implant's own.")
      .def_property_readonly("implant", searched(&Fit::implant), "Which of the series.")
      .def_property_readonly("searched_objective", searched(&Fit::objective), "By the search's own reckoning.")
      .def_property_readonly("moved_centre", moved(&FitMovement::centre), "From the start, in model units.")
      .def_property_readonly("moved_rotation", moved(&FitMovement::rotation_degrees),
                             "A rotation vector about that centre, in degrees.")
      .def_property_readonly("at_limits", moved(&FitMovement::at_limits), "Which ranges ended the search.")
      .def_readonly("map", &PythonFit::map, "Map of the distances of all vertices (cut at the resection).");
  declare_proof(fit);
  declare_trials(fit);
  fit.def("is_proved", is_proved, py::arg("mesh"),
          "is_proved(mesh) -> bool\n\nProves again, by MPFR alone, the distance of every vertex from its certificate, "
          "and from\nthese objective, smallest_distance, deepest_penetration, how many vertices keep the limit and "
          "the\nnumbers of all areas; and the sides that are \"proven\"; of the bound certified_bound, of contact "
          "certified_contact.\n"
          "Changes and surface have no certificates. Raises ValueError without certificates, and for a mesh of other "
          "vertices than the "
          "fit's.")
      .def("__repr__", representation)
      .def(pickled<PythonFit>());
}

}  // namespace

void declare_fits(py::module_& module) {
  declare_class_of_certified_bounds(module);
  declare_class_of_certified_contacts(module);
  declare_areas(module);
  declare_conditions(module);
  declare_class_of_fits(module);
  module.def(
      "fit", fit_of, py::arg("implants"), py::arg("mesh"), py::kw_only(), py::arg("surface") = py::none(),
      py::arg("resection") = py::none(), py::arg("crossing") = std::vector<std::string>(),
      py::arg("outside") = std::vector<std::string>(), py::arg("landmarks") = py::none(),
      py::arg("landmark_side") = py::none(), py::arg("landmark_radius") = 0.0, py::arg("keep") = Ranges(),
      py::arg("objective") = "fitness", py::arg("implant_contact") = false, py::arg("completion") = "cementless",
      py::arg("gap") = py::none(), py::arg("gap_tolerance") = py::none(), py::arg("penetration_limit") = 0.0,
      py::arg("on") = py::none(), py::arg("pose_start") = py::none(), py::arg("translation_range") = py::none(),
      py::arg("rotation_range") = 30.0, py::arg("labels") = py::none(), py::arg("weights") = Weights(),
      py::arg("bound") = py::none(), py::arg("bound_time") = 300.0, py::arg("time_limit") = py::none(),
      py::arg("seed") = 1, py::arg("samples") = 4096, py::arg("tolerance") = py::none(),
      py::arg("certificates") = false, py::arg("device") = "auto",
      "fit(implants, mesh, *, surface=None, resection=None, crossing=(), outside=(), landmarks=None,\n"
      "    landmark_side=None, landmark_radius=0.0, keep={}, objective=\"fitness\", implant_contact=False,\n"
      "    completion=\"cementless\", gap=None, gap_tolerance=None, penetration_limit=0.0, on=None, pose_start=None,\n"
      "    translation_range=None, rotation_range=30.0, labels=None, weights={}, bound=None, bound_time=300.0, "
      "time_limit=None,\n"
      "    seed=1, samples=4096, tolerance=None, certificates=False, device=\"auto\") -> Fit\n\n"
      "Searches for the pose and the sizes of an implant, a Model or a series of them, that serve the vertices of a\n"
      "Mesh best, and proves what it found. Semi-axes that are intervals are sizes to choose from, of unions without\n"
      "bends. Lengths are in the implants' units.\n\n"
      "surface: what the mesh bounds: \"cavity\" or \"bone\"; \"any\": sides do not matter. None: a closed mesh whose\n"
      "    normals point inward is a cavity.\n"
      "resection: the plane in which the bone is cut, six numbers: a point and a normal to what is cut off.\n"
      "crossing, outside: names of primitives that may lie anywhere, that have to lie outside. What only cuts an\n"
      "    implant lies anywhere.\n"
      "landmarks, landmark_side, landmark_radius: the bone's (a dictionary as Femur.landmarks, mm), how well known;\n"
      "    of the implant its own landmarks count, else the centres of its primitives \"head\" and \"neck\".\n"
      "keep: for changes of the bone's features by their names (lo, hi), in which they have to be; for areas in\n"
      "    contact (\"contact\", \"contact:AREA\", \"implant_contact\") in percent.\n"
      "objective: \"fitness\", or \"size\": the largest implant, or sizes, of which all that is asked is proven.\n"
      "implant_contact: encloses how much of the implant's own surface is in contact, too.\n"
      "completion, gap, gap_tolerance: \"cementless\", at most the gap apart; \"cemented\", a layer of it, to within\n"
      "    the tolerance. Defaults: 2 where units are mm; half the gap.\n"
      "penetration_limit, on: no \"triangles\" (default where there are any) or \"vertices\" deeper in the implant.\n"
      "pose_start, translation_range, rotation_range: where the search begins (seven numbers), how far it may go, in\n"
      "    model units (default: half the diagonal of the mesh's box) and degrees.\n"
      "labels: integers (N,), the area of each vertex; None: the boxes of the implants' files. weights: of areas, by\n"
      "    their names.\n"
      "bound, bound_time: asks for a proof that no pose is better by more than so many percent; seconds for it.\n"
      "time_limit: seconds, for search, bound and proofs; then what is open stays so: Fit.unfinished.\n"
      "seed, samples: the same seed on the same device gives the same pose; poses sampled first.\n"
      "tolerance: of the map, default 1e-6 of the fitted model's bounding_radius.\n"
      "certificates: keep what proves the map's rows again, for Fit.is_proved and Checker, the bound, and the mesh's\n"
      "    areas in contact; not with a resection.\n\n"
      "Ctrl-C ends it: KeyboardInterrupt. Raises ValueError for numbers and words out of range, Error as `verisq fit`\n"
      "does, by its options' names.");
}

}  // namespace verisq::python
