/// Which options go together, and what is written.
#include "host/command_line/fit_certificates.hpp"

#include <fmt/core.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <verisq/certificate_file.hpp>
#include <verisq/certified_best_fit.hpp>
#include <verisq/clearance_claim.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/triangle_stream.hpp"
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

/// The distance of every triangle, between its corners too; returns the smallest one. Never ended by the first Ctrl-C,
/// like all that a fit proves.
Enclosure write_surface_map(const FitProblem& problem, const Model& fitted, MapOptions options,
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
  writer.finish();
  return {summary.minimum_lo, summary.minimum_hi};
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
                                              const FitArguments& arguments) {
  const std::string& file = arguments.bound_certificate;
  if (file.empty() || !solution.bound) return std::nullopt;
  ProgressBar bar(!arguments.no_progress, "%");
  const FitOptions& options = problem.options;
  auto certified = certified_best_fit(
      problem.series, problem.cavity, {options.fitness, options.penetration_limit, options.range}, *solution.bound,
      {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
       .interrupted = interrupted,
       .progress = [&bar](double done) { bar.update_state("certificate of the bound", done); }});
  if (!certified) {
    tell(fmt::format("interrupted; {} is not written", file));
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
  write_answer(file, answer);
  return answer.upper;
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
}

MapContents contents_of(const FitArguments& arguments) {
  return certifies(arguments) ? MapContents::covered : MapContents::enclosures;
}

void write_certificates(const FitProblem& problem, const Model& fitted, const Clearance& clearance,
                        std::vector<SideClaim> sides, const MapOptions& options, const FitArguments& arguments) {
  std::optional<Enclosure> surface;
  if (!arguments.surface_map.empty()) surface = write_surface_map(problem, fitted, options, arguments);
  if (arguments.certificate_file.empty()) return;
  write_answer(arguments.certificate_file, FitAnswer{.model = subject_file(arguments.output),
                                                     .mesh = subject_file(arguments.mesh),
                                                     .units = problem.units,
                                                     .terms = stated_terms(problem),
                                                     .claims = claims_of(clearance, surface),
                                                     .sides = std::move(sides)});
}

}  // namespace verisq::command_line
