/// Which kind of answer it is, and what it has to be given with.
#include "host/command_line/check_command.hpp"

#include <fmt/core.h>

#include <variant>
#include <verisq/certificate_file.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/best_fit_check.hpp"
#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/contact_check.hpp"
#include "host/command_line/deviation_check.hpp"
#include "host/command_line/equilibrium_check.hpp"
#include "host/command_line/features_check.hpp"
#include "host/command_line/fit_check.hpp"
#include "host/command_line/insertion_check.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/map_check.hpp"
#include "host/command_line/octree_check.hpp"
#include "host/command_line/path_check.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/whole_number.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The map is one that `verisq map --certificates` wrote for the same model and the same points or triangles, in\n"
    "the same order; the map tells which of both. Each [lo, hi] is proved again by MPFR from the model, the point or\n"
    "triangle, and the row's certificate alone: no OpenCL, and nothing of the run that wrote the map, is trusted.\n"
    "\n"
    "\"Proved\": the exact distance lies in [lo, hi]. \"Refuted\": it does not. \"Unproved\": the certificate does\n"
    "not decide. \"Falsified\": something else that the map shows is not so. What a .vtp draws must be the points and\n"
    "cells given, bit for bit, and the middles of [lo, hi]; one tolerance must explain every status (which of device\n"
    "and host verified a row is not checked). \"Missing\": an interrupted or killed run left a part of a .csv, as\n"
    "OUT.partial or OUT.*.partial; a last row that is not whole does not count.\n"
    "\n"
    "--certificate: a file that --certificate-file wrote. The files named here must be, byte for byte, those that the\n"
    "answer is about. Of\n"
    "  distance   give A's --model, then B's: the distance is proved, or that they meet, of every pose\n"
    "  path       give A's --model, then B's: the smallest distance of all times is proved, or when the models first\n"
    "             meet (status 0 says that this is proved, not that the way is free)\n"
    "  fit        give the fitted --model, the --mesh, the --map and, where there was one, the --surface-map: every\n"
    "             distance is proved, and then what they say together, F, the smallest distance, the deepest\n"
    "             penetration, how many vertices keep the limit, the numbers of every area\n"
    "  fit --bound\n"
    "             give each implant's --model, as it lies in its own file, and the --mesh: that no pose of the range\n"
    "             fits better is proved (of the file of --bound-certificate-file)\n"
    "  fit --contact-certificate-file\n"
    "             give the fitted --model and the --mesh: how much of its area, and of each area's, is in contact "
    "with\n"
    "             the implant is proved\n"
    "  insert     give the implant's --model, the bone's --mesh and, where there was one, the surface --within: the\n"
    "             smallest distance of every vertex along the whole way is proved, that of the whole surface where\n"
    "             --on triangles asked for it, and how much bone is taken away\n"
    "  deviation  give --model and --mesh or --points: how far these lie from the model's surface is proved, at most,\n"
    "             in the mean, and percentiles; and how far the model's surface lies from them, at most\n"
    "  features   what its landmarks say is enclosed once more, at 127 bits\n"
    "  stance     give its --model (.xml): where the body stands still is proved\n"
    "\n"
    "--octree: a file of `verisq octree`, with or without white cubes. Its black cubes are proved to lie inside, and\n"
    "what black and gray ones leave out outside; all together they prove the volume.\n"
    "\n"
    "Exit status: 0 every row proved, nothing falsified or missing; 3 not so; 2 bad usage or input, also other models\n"
    "than the certificate is about, and a whole map with fewer or more rows than there are points or triangles; 130 "
    "interrupted by Ctrl-C, 143 by SIGTERM, 129 by\n"
    "SIGHUP (what was checked so far is printed).\n"
    "\n"
    "Examples:\n"
    "  verisq map --model stem.json --mesh femur.off --certificates -o clearance.csv\n";
constexpr const char* example = "--model stem.json --mesh femur.off --map clearance.csv";

ExitStatus status_of(const CheckReport& report) {
  if (report.interrupted) return ExitStatus::interrupted;
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

void refuse_points(const CheckArguments& arguments) {
  const auto refuse_option = [](const char* option) { refuse(fmt::format("{}: only with --map", option)); };
  if (!arguments.inputs.mesh.empty()) refuse_option("--mesh");
  if (!arguments.inputs.points.empty()) refuse_option("--points");
  if (arguments.point_radius != 0.0) refuse_option("--point-radius");
}

void refuse_what_certificates_lack(const CheckArguments& arguments) {
  if (!arguments.map.empty() || !arguments.surface_map.empty())
    refuse(fmt::format("--map: {} is of two models, not of a map", arguments.certificate));
  refuse_points(arguments);
  if (arguments.inputs.pose) refuse("--pose: only with --map or --octree");
}

ExitStatus print(const CheckReport& report, const CheckArguments& arguments) {
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return status_of(report);
}

ExitStatus check_map_file(const CheckArguments& arguments) {
  check_usage(arguments.inputs);
  watch_for_interruption();
  MapReader map(arguments.map);
  return print(checked_map(arguments, map, [](std::uint64_t, const Enclosure&) {}), arguments);
}

bool has_poses(const Answer& answer) {
  return std::holds_alternative<PairAnswer>(answer) || std::holds_alternative<PoseAnswers>(answer) ||
         std::holds_alternative<InsertionAnswer>(answer) || std::holds_alternative<PathAnswer>(answer);
}

ExitStatus check_certificate(const CheckArguments& arguments) {
  const Answer answer = read_answer(arguments.certificate);
  if (!arguments.poses.empty() && !has_poses(answer))
    refuse(fmt::format("--poses: {} is neither of a path, nor of a way in, nor of poses", arguments.certificate));
  if (!arguments.within.empty() && !std::holds_alternative<InsertionAnswer>(answer))
    refuse(fmt::format("--within: {} is of no way in", arguments.certificate));
  if (const auto* const fit = std::get_if<FitAnswer>(&answer)) return run_fit_check(*fit, arguments);
  if (const auto* const best = std::get_if<BestFitAnswer>(&answer)) return run_best_fit_check(*best, arguments);
  if (const auto* const way = std::get_if<InsertionAnswer>(&answer)) return run_insertion_check(*way, arguments);
  if (const auto* const deviation = std::get_if<DeviationAnswer>(&answer))
    return run_deviation_check(*deviation, arguments);
  if (const auto* const contact = std::get_if<ContactAnswer>(&answer)) return run_contact_check(*contact, arguments);
  if (const auto* const features = std::get_if<FeaturesAnswer>(&answer))
    return run_features_check(*features, arguments);
  if (const auto* const standing = std::get_if<EquilibriumAnswer>(&answer))
    return run_equilibrium_check(*standing, arguments);
  if (arguments.models.empty()) refuse("--model is required");
  refuse_what_certificates_lack(arguments);
  if (const auto* const path = std::get_if<PathAnswer>(&answer)) return run_path_check(*path, arguments);
  return run_certificate_check(answer, {arguments.certificate, arguments.models, arguments.poses, arguments.json});
}

}  // namespace

void declare_check(Options& options, CheckArguments& arguments) {
  options.explain(fmt::format("{}  {} {}", closing_words, options.full_name(), example));
  options.add_each(
      "--model", arguments.models, "FILE",
      "Model of posed superquadrics (verisq-model/1, JSON), or of stance (XML); of a --certificate each that it\n"
      "is about, in its order; that of features needs none");
  declare_points(options, arguments.inputs);
  options.add("--map", arguments.map, "FILE", "The map, written with --certificates: .csv .vtp .csv.partial");
  options.add("--certificate", arguments.certificate, "FILE",
              "Instead of a map, or of a fit with it: a certificate file, .json");
  options.add(
      "--poses", arguments.poses, "FILE",
      "Of a --certificate of a path, a way in, or poses: refuses it unless it is of the poses of this file, .csv");
  options.add("--within", arguments.within, "FILE",
              "Of a --certificate of bone that is removed around a cavity: the bone's outer surface, a mesh");
  options.add("--surface-map", arguments.surface_map, "FILE",
              "Of the --certificate of a fit that had one: the map of whole triangles");
  options.add("--octree", arguments.octree, "FILE",
              "Instead of a map: an octree of `octree`, .vtu: every cube inside, and outside all that it leaves out");
  options.add("--sample", arguments.sample, whole_number<std::uint64_t>(1), "NUMBER",
              "Of an --octree, so many cubes chosen at random (default: all)");
  options.add("--point-radius", arguments.point_radius, parse_length, "NUMBER", "As the map was made with (default 0)");
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_check(const CheckArguments& given) {
  if (!given.octree.empty() && (!given.map.empty() || !given.certificate.empty())) {
    refuse("--octree: not with --map or --certificate");
  }
  if (given.map.empty() && given.certificate.empty() && given.octree.empty()) {
    refuse("give one of --map, --certificate and --octree");
  }
  if (!given.surface_map.empty() && given.certificate.empty()) refuse("--surface-map: only with --certificate");
  if (!given.within.empty() && given.certificate.empty()) refuse("--within: only with --certificate");
  if (!given.poses.empty() && given.certificate.empty()) refuse("--poses: only with --certificate");
  if (given.sample && given.octree.empty()) refuse("--sample: only with --octree");
  CheckArguments arguments = given;
  if (!given.models.empty()) arguments.inputs.model = given.models.front();
  if (!given.certificate.empty()) return check_certificate(arguments);
  if (given.models.empty()) refuse("--model is required");
  if (given.models.size() != 1) refuse("--model: give one, that of the --map or --octree");
  if (!given.octree.empty()) {
    refuse_points(given);
    return run_octree_check(
        {given.octree, given.models.front(), given.inputs.pose, given.sample, given.json, given.no_progress});
  }
  return check_map_file(arguments);
}

}  // namespace verisq::command_line
