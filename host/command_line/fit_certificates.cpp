/// The proofs of the distances and areas in contact of a fit.
#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/error.hpp>
#include <verisq/fit.hpp>

#include "host/command_line/fit_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

StatedTerms stated_terms(const FitProblem& problem) {
  return {.fitness = problem.options.fitness,
          .penetration_limit = problem.options.penetration_limit,
          .areas = problem.cavity.areas,
          .area_runs = runs_of(problem.cavity.area_of)};
}

/// Writes the distance of every triangle, between its corners too. Writes nothing if interrupted.
MapSummary write_surface_map(const FitProblem& problem, const Model& fitted, MapOptions options,
                             const FitArguments& arguments) {
  const Mesh& mesh = problem.mesh;
  const bool convex = is_union_of_convex(fitted);
  options.certificates = true;
  options.covers = !convex;
  const MapContents contents = convex ? MapContents::certified : MapContents::covered;
  MapWriter writer(arguments.surface_map, &mesh, MapForm{.contents = contents, .elements = MapElements::triangles});
  ProgressBar bar(!arguments.no_progress, "triangles");
  TriangleStream stream(mesh);
  std::uint64_t done = 0;
  const Source<Triangle> source = [&](std::span<Triangle> triangles) { return stream.read(triangles); };
  const Sink<Triangle> sink = [&](std::span<const Triangle>, std::span<const MapResult> rows,
                                  std::span<const Certificate> certificates) {
    writer.append(rows, certificates);
    done += rows.size();
    bar.update(done, stream.fraction(done));
  };
  const MapSummary summary = TriangleMapper(fitted, options).map(source, sink);
  if (summary.interrupted) {
    tell(fmt::format("interrupted; {} is not written", arguments.surface_map));
    return summary;
  }
  writer.finish();
  if (summary.out_of_time) {
    tell(fmt::format("the time limit is reached: {}: {} of {} rows are valid, and wide", arguments.surface_map,
                     summary.wide, summary.points));
  }
  return summary;
}

}  // namespace

void declare_certificates(Options& options, FitArguments& arguments) {
  options.add_flag("--certificates", arguments.certificates,
                   "Write what proves the distances again, for `verisq check`: into the --map (.csv, .vtp), and into "
                   "the page of --report, which then proves itself in its reader's browser");
  options.add("--surface-map", arguments.surface_map, "FILE",
              "The proven distance of every triangle, between its corners too, 0 where it meets the implant, with what "
              "proves it again: .csv .vtp");
  options.add(
      "--certificate-file", arguments.certificate_file, "FILE",
      "What these distances say together, F, the smallest, the areas, and on which side the parts of the implant lie, "
      "for `verisq check --certificate` with the maps, which get --certificates: .json");
}

std::optional<double> write_bound_certificate(const FitProblem& problem, const FitSolution& solution,
                                              const Deadline& limit, const FitArguments& arguments) {
  const std::string& file = arguments.bound_certificate;
  if (file.empty() || !solution.bound) return std::nullopt;
  ProgressBar bar(!arguments.no_progress, "%");
  const FitOptions& options = problem.options;
  auto certified = certified_best_fit(
      problem.series, problem.cavity, {options.fitness, options.penetration_limit, options.range}, *solution.bound,
      {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
       .interrupted = limit.stop(),
       .progress = [&bar](double done) { bar.update_state("certificate of the bound", done); }});
  if (!certified) {
    tell(fmt::format("{}; {} is not written", limit.passed() ? "the time limit is reached" : "interrupted", file));
    return std::nullopt;
  }
  BestFitAnswer answer{.models = {},
                       .mesh = subject_file(arguments.mesh),
                       .units = problem.units,
                       .terms = stated_terms(problem),
                       .range = certified->claim.range,
                       .centres = std::move(certified->claim.centres),
                       .upper = certified->claim.upper,
                       .certificate = std::move(certified->certificate)};
  for (const std::string& implant : arguments.implants) answer.models.push_back(subject_file(implant));
  const double upper = answer.upper;
  write_answer(file, std::move(answer));
  return upper;
}

bool certifies(const FitArguments& arguments) {
  return arguments.certificates || !arguments.certificate_file.empty();
}

void check_certificates(const FitArguments& arguments) {
  if (!arguments.certificate_file.empty() && arguments.map.empty())
    refuse("--certificate-file: give the --map that holds the certificates of its distances");
  if (arguments.certificates && arguments.map.empty() && arguments.report.html.empty())
    refuse("--certificates: give the --map or the --report that keeps them");
  const bool of_bound = !arguments.bound_certificate.empty();
  if (of_bound && !arguments.bound) refuse("--bound-certificate-file: give the --bound that it is of");
  if (!certifies(arguments) && arguments.surface_map.empty() && !of_bound) return;
  if (arguments.resection)
    refuse(
        "--certificates, --surface-map, --bound-certificate-file: not with --resection, which leaves a part of the "
        "mesh out: cut it first");
  if (!std::filesystem::is_regular_file(arguments.mesh))
    refuse(fmt::format("--certificates: {}: is no regular file, and they must tell which it is", arguments.mesh));
}

void refuse_what_has_no_certificates(const FitProblem& problem, const FitArguments& arguments) {
  if (!arguments.surface_map.empty() && problem.mesh.triangles.empty())
    refuse(fmt::format("--surface-map: {}: has no triangles", arguments.mesh));
  const auto with_mesh = std::ranges::find_if(
      problem.series, [](const UncertainModel& implant) { return has_mesh(bracket(implant).largest); });
  if (with_mesh == problem.series.end()) return;
  const std::string& name = problem.names[static_cast<std::size_t>(with_mesh - problem.series.begin())];
  if (!arguments.surface_map.empty())
    refuse(fmt::format("--surface-map: {} has a mesh, of which only vertices have certificates: give --map", name));
  if (!arguments.contact_certificate.empty())
    refuse(
        fmt::format("--contact-certificate-file: {} has a mesh, and only superquadrics have one: leave it out", name));
}

MapContents contents_of(const FitArguments& arguments) {
  return certifies(arguments) ? MapContents::covered : MapContents::enclosures;
}

ExitStatus write_certificates(const FitProblem& problem, const Model& fitted, const Clearance& clearance,
                              std::vector<SideClaim> sides, const MapOptions& options, const FitArguments& arguments) {
  std::optional<Enclosure> surface;
  ExitStatus status = ExitStatus::verified;
  if (!arguments.surface_map.empty()) {
    const MapSummary map = write_surface_map(problem, fitted, options, arguments);
    if (map.interrupted) return ExitStatus::interrupted;
    if (map.out_of_time) status = ExitStatus::unverified;
    surface = {map.minimum_lo, map.minimum_hi};
  }
  if (arguments.certificate_file.empty()) return status;
  write_answer(arguments.certificate_file, FitAnswer{.model = subject_file(arguments.output),
                                                     .mesh = subject_file(arguments.mesh),
                                                     .units = problem.units,
                                                     .terms = stated_terms(problem),
                                                     .claims = claims_of(clearance, surface),
                                                     .sides = std::move(sides)});
  return status;
}

namespace {

/// Roundings alone make a claim wider by less.
constexpr double share_of_roundings = 1e-9;

void tell_if_wider(const std::string& file, const std::string& name, const AreaWithin& found,
                   const ContactClaim& claimed) {
  constexpr int digits = 4;
  const Enclosure of_found = claim_of(found).percent;
  if (claimed.percent.width() <= of_found.width() * (1.0 + share_of_roundings)) return;
  tell(fmt::format("{}: claims less than was found, {} %, not {} %: {}", file, outward_digits(claimed.percent, digits),
                   outward_digits(of_found, digits), quotation(name)));
}

void tell_of_wider(const std::string& file, const ContactAreas& found, const ContactClaims& claimed,
                   const std::vector<std::string>& names) {
  tell_if_wider(file, "contact", found.of_mesh, claimed.of_mesh);
  for (std::size_t k = 0; k < names.size(); ++k)
    tell_if_wider(file, "contact:" + names[k], found.by_region[k], claimed.by_region[k]);
  if (found.of_model && claimed.of_model) tell_if_wider(file, "implant_contact", *found.of_model, *claimed.of_model);
}

}  // namespace

void declare_contact_certificate(Options& options, FitArguments& arguments) {
  options.add(
      "--contact-certificate-file", arguments.contact_certificate, "FILE",
      "How much of the mesh's area, of each area's and, with --implant-contact, of the implant's own surface is "
      "in contact, with what proves it again, for `verisq check --certificate` with the fitted model and the "
      "mesh: .json");
}

void check_contact_certificate(const FitArguments& arguments) {
  if (arguments.contact_certificate.empty()) return;
  if (arguments.resection)
    refuse("--contact-certificate-file: not with --resection, which leaves a part of the mesh out: cut it first");
  if (!std::filesystem::is_regular_file(arguments.mesh))
    refuse(fmt::format("--contact-certificate-file: {}: is no regular file, and it must tell which it is",
                       arguments.mesh));
}

void refuse_what_has_no_contact(const FitProblem& problem, const FitArguments& arguments) {
  if (!arguments.contact_certificate.empty() && problem.mesh.triangles.empty())
    refuse(fmt::format("--contact-certificate-file: {}: has no triangles", arguments.mesh));
}

ContactFile write_contact_certificate(const FitProblem& problem, const Fit& fit, const FitProof& proof,
                                      const Deadline& limit, const FitArguments& arguments) {
  const std::string& file = arguments.contact_certificate;
  if (file.empty()) return ContactFile::not_asked_for;
  // The first Ctrl-C may have ended the search: its result is proven all the same.
  const auto ended = [before = interrupted()] { return !before && interrupted(); };
  CertifiedContact certified;
  {
    ProgressBar bar(!arguments.no_progress, "%");
    certified = certified_contact(problem, fit, proof, either(ended, limit.out_of_time()),
                                  [&bar](double done) { bar.update_state("certificate of contact", done); });
  }
  if (certified.proven.interrupted) {
    tell(fmt::format("{}; {} is not written", ended() ? "interrupted" : "the time limit is reached", file));
    return ended() ? ContactFile::interrupted : ContactFile::out_of_time;
  }
  std::vector<std::string> regions;
  for (const Area& area : problem.cavity.areas) regions.push_back(area.name);
  ContactAnswer answer{.model = subject_file(arguments.output),
                       .mesh = subject_file(arguments.mesh),
                       .units = problem.units,
                       .distance = certified.terms.distance,
                       .regions = regions,
                       .region_runs = runs_of(certified.terms.region_of),
                       .claims = certified.claims,
                       .counted = std::move(certified.terms.counted),
                       .certificate = std::move(certified.certificate)};
  try {
    write_answer(file, std::move(answer));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    tell(error.what());
    return ContactFile::too_large;
  }
  tell_of_wider(file, *proof.contact, certified.claims, regions);
  return ContactFile::written;
}

}  // namespace verisq::command_line
