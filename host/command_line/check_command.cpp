/// `verisq check`: reads the answer to be proved again, and prints the result.
#include "host/command_line/check_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <verisq/certificate_file.hpp>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/input_file.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

double rows_per_second(const CheckReport& report) {
  return report.seconds > 0.0 ? static_cast<double>(report.rows()) / report.seconds : 0.0;
}

std::string digits_of(const Point& point) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g})", point[0], point[1], point[2]);
}

std::string digits_of(const Triangle& triangle) {
  return fmt::format("{}, {}, {}", digits_of(triangle[0]), digits_of(triangle[1]), digits_of(triangle[2]));
}

std::string readable(const MapDifference& falsified) {
  const auto place = falsified.index ? fmt::format(", index {}", *falsified.index) : std::string();
  return fmt::format("falsified {}{}\n  shown              {}\n  expected           {}\n", falsified.array, place,
                     falsified.shown, falsified.expected);
}

JsonObject object_of(const MapDifference& falsified) {
  return {{"array", falsified.array},
          {"index", falsified.index},
          {"shown", falsified.shown},
          {"expected", falsified.expected}};
}

/// Returns whether to state the smallest distance: all rows must be there, and none refuted, as rows of another map may
/// be.
bool tells_smallest(const CheckReport& report) {
  return report.missing == 0 && report.refuted == 0 && !report.interrupted && std::isfinite(report.smallest.width());
}

bool comes_first(const CheckedRow& a, const CheckedRow& b) {
  const bool a_refuted = a.finding.verdict == Verdict::refuted;
  const bool b_refuted = b.finding.verdict == Verdict::refuted;
  return a_refuted != b_refuted ? a_refuted : a.index < b.index;
}

}  // namespace

void count(const CheckedRow& row, CheckReport& report) {
  report.smallest = {std::min(report.smallest.lo, row.finding.proven.lo),
                     std::min(report.smallest.hi, row.finding.proven.hi)};
  report.unbounded += std::isfinite(row.claimed.width()) ? 0 : 1;
  switch (row.finding.verdict) {
    case Verdict::proved: ++report.proved; break;
    case Verdict::refuted: ++report.refuted; break;
    case Verdict::unproved: ++report.unproved; break;
  }
  if (row.finding.verdict == Verdict::proved) {
    report.largest_width = std::max(report.largest_width, row.claimed.width());
  } else if (!report.first || comes_first(row, *report.first)) {
    report.first = row;
  }
}

std::string verdicts_in_words(std::string_view claims, const VerdictCounts& counts) {
  std::string text = fmt::format("{:<21}{}\n", claims, counts.all());
  text += fmt::format("  {:<19}{}\n", to_string(Verdict::proved), counts.proved);
  text += fmt::format("  {:<19}{}\n", to_string(Verdict::refuted), counts.refuted);
  return text + fmt::format("  {:<19}{}\n", to_string(Verdict::unproved), counts.unproved);
}

std::string reason(const Enclosure& claimed, const Finding& finding) {
  const Enclosure& proven = finding.proven;
  if (finding.verdict == Verdict::refuted) {
    if (claimed.lo > claimed.hi) return "lo is above hi: no number lies between them";
    if (proven.lo > claimed.hi) return fmt::format("hi is wrong: the exact distance is at least {:.17g}", proven.lo);
    return fmt::format("lo is wrong: the exact distance is at most {:.17g}", proven.hi);
  }
  const bool lo_open = proven.lo < claimed.lo;
  const bool hi_open = proven.hi > claimed.hi;
  if (lo_open && hi_open) return "the certificate proves neither lo nor hi";
  return fmt::format("the certificate does not prove {}", lo_open ? "lo" : "hi");
}

std::string unbounded_in_words(std::uint64_t count) {
  if (count == 0) return {};
  return fmt::format("  WITHOUT AN END     {}: of these nothing is claimed on one side at least\n", count);
}

std::string unbounded_above_in_words(std::uint64_t count) {
  if (count == 0) return {};
  return fmt::format("  WITHOUT AN END     {}: of these nothing is claimed from above\n", count);
}

std::string claims_in_words(const JudgedAnswer& judged, const std::function<std::string(const JudgedClaim&)>& words,
                            const std::function<std::string(std::uint64_t)>& unbounded,
                            const std::function<std::string(const JudgedClaim&)>& units) {
  std::string text = verdicts_in_words("claims", counted(judged.claims, &JudgedClaim::finding));
  text += unbounded(judged.unbounded());
  for (const JudgedClaim& claim : judged.claims) {
    text += fmt::format("  {:<8} {}\n", to_string(claim.finding.verdict), words(claim));
    if (claim.finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}{}\n", exact_text(claim.finding.proven), units(claim));
  }
  return text;
}

JsonValue claims_of(const JudgedAnswer& judged, const std::function<JsonObject(const JudgedClaim&)>& head) {
  JsonValue::Array claims;
  for (const JudgedClaim& claim : judged.claims) {
    JsonObject object = head(claim);
    object.set("verdict", to_string(claim.finding.verdict));
    object.set("claimed", claim.claimed);
    object.set("proven", claim.finding.proven);
    claims.push_back(std::move(object));
  }
  return claims;
}

ExitStatus proved_again(const JudgedKind& kind, const CheckArguments& arguments) {
  watch_for_interruption();
  const Stopwatch time;
  std::optional<ProgressBar> bar(std::in_place, !arguments.no_progress, kind.elements);
  const auto show = [&](double done) {
    if (kind.count == 0) return bar->update_state(kind.steps, done);
    bar->update(static_cast<std::uint64_t>(done * static_cast<double>(kind.count)), done);
  };
  const JudgedAnswer judged = kind.judge(
      {.in_parallel = in_parallel<std::function<void(std::size_t)>>, .interrupted = arguments.ended, .progress = show});
  bar.reset();  // the line is cleared before anything else is said
  const double seconds = time.seconds();
  if (arguments.json) {
    JsonObject object = kind.members(judged);
    object.set("seconds", seconds);
    object.set("interrupted", judged.interrupted);
    object.set("certificate", arguments.certificate);
    fmt::print("{}\n", object.text());
  } else {
    fmt::print("{}time                 {:.3g} s\ncertificate          {}{}\n", kind.words(judged), seconds,
               quotation(arguments.certificate), mark_of_end(judged.interrupted));
  }
  if (judged.interrupted) return status_of_end();
  return judged.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

std::string exact_text(const Enclosure& enclosure) {
  return fmt::format("[{:.17g}, {:.17g}]", enclosure.lo, enclosure.hi);
}

std::string verdicts_in_words(const CheckReport& report) {
  return fmt::format("{:<21}{}\n", plural(report.elements), report.rows()) +
         fmt::format("  proved             {}\n", report.proved) +
         fmt::format("  refuted            {}\n", report.refuted) +
         fmt::format("  unproved           {}\n", report.unproved) + unbounded_in_words(report.unbounded);
}

std::string readable(const CheckedRow& row, MapElements elements) {
  const auto position = std::visit([](const auto& element) { return digits_of(element); }, row.element);
  auto text = fmt::format("first {} {}, index {}, at {}: {}\n", to_string(row.finding.verdict), singular(elements),
                          row.index, position, reason(row.claimed, row.finding));
  text += fmt::format("  claimed            {}\n", exact_text(row.claimed));
  text += fmt::format("  proven             {}\n", exact_text(row.finding.proven));
  return text;
}

JsonObject object_of(const CheckedRow& row, MapElements elements) {
  return {{"verdict", to_string(row.finding.verdict)},
          {"index", row.index},
          {singular(elements), std::visit([](const auto& element) { return JsonValue(element); }, row.element)},
          {"claimed", row.claimed},
          {"proven", row.finding.proven},
          {"reason", reason(row.claimed, row.finding)}};
}

std::string readable(const CheckReport& report) {
  const auto units = units_behind(report.units);
  std::string text = verdicts_in_words(report);
  if (report.missing > 0) text += fmt::format("  missing            {} (the map ends before)\n", report.missing);
  if (report.proved > 0)
    text += fmt::format("largest width proved {}{}\n", upper_digits(report.largest_width, 3), units);
  if (tells_smallest(report)) {
    const bool meets = report.elements == MapElements::triangles && report.smallest.hi == 0.0;
    text += fmt::format("smallest distance    {}{} of these {}{}, proved\n", exact_text(report.smallest), units,
                        plural(report.elements), meets ? ", of which one meets the model" : "");
  }
  text += fmt::format("time                 {:.3g} s, {} {}/s\n", report.seconds, with_prefix(rows_per_second(report)),
                      plural(report.elements));
  text += fmt::format("map                  {}{}\n", quotation(report.map), mark_of_end(report.interrupted));
  if (report.first) text += readable(*report.first, report.elements);
  if (report.falsified) text += readable(*report.falsified);
  return text;
}

JsonObject object_of(const CheckReport& report) {
  return {
      {plural(report.elements), report.rows()},
      {"proved", report.proved},
      {"refuted", report.refuted},
      {"unproved", report.unproved},
      {"missing", report.missing},
      {"without_an_end", report.unbounded},
      {"largest_width_proved", report.largest_width},
      {"smallest_distance_proved", tells_smallest(report) ? JsonValue(report.smallest) : JsonValue()},
      {"units", report.units},
      {"seconds", report.seconds},
      {fmt::format("{}_per_second", plural(report.elements)), rows_per_second(report)},
      {"interrupted", report.interrupted},
      {"map", report.map},
      {"first", report.first ? object_of(*report.first, report.elements) : JsonValue()},
      {"falsified", report.falsified ? object_of(*report.falsified) : JsonValue()},
  };
}

std::string json(const CheckReport& report) {
  return object_of(report).text() + "\n";
}

namespace {

void refuse_other_count(std::span<const SubjectFile> expected, const CertificateCheckArguments& arguments) {
  if (arguments.models.size() != expected.size()) {
    refuse(fmt::format("{}: is about {} models: give a --model for each, in its order, not {}", arguments.certificate,
                       expected.size(), arguments.models.size()));
  }
}

/// A claim about how deep two models reach into each other, beside their distance.
struct JudgedPenetration {
  Enclosure claimed;
  Finding finding;
};

std::string readable(const JudgedPenetration& judged, bool ended_early, const std::string& units) {
  std::string text =
      fmt::format("penetration depth  {}\n", ended_early ? "not judged" : to_string(judged.finding.verdict));
  text += fmt::format("  claimed          {}{}\n", exact_text(judged.claimed), units);
  text += fmt::format("  proven           {}{}\n", exact_text(judged.finding.proven), units);
  if (!std::isfinite(judged.claimed.hi)) text += "  WITHOUT AN END   nothing is claimed from above\n";
  return text;
}

JsonValue json_of(const std::optional<JudgedPenetration>& judged, bool ended_early) {
  if (!judged) return {};
  return JsonObject{{"verdict", ended_early ? JsonValue() : JsonValue(to_string(judged->finding.verdict))},
                    {"claimed", judged->claimed},
                    {"proven", judged->finding.proven}};
}

struct CertificateReport {
  std::string certificate;
  std::vector<std::string> models;
  std::string units;
  Pose pose;
  Enclosure claimed;
  Finding finding;
  std::optional<JudgedPenetration> penetration;
  double seconds;
  bool ended_early;  ///< before it was judged
};

std::string reason_of(const CertificateReport& report) {
  if (report.ended_early) return std::string(reason_of_end());
  return report.finding.verdict == Verdict::proved ? std::string() : reason(report.claimed, report.finding);
}

std::string readable(const CertificateReport& report) {
  const std::string units = units_behind(report.units);
  std::string text =
      fmt::format("verdict            {}\n", report.ended_early ? "not judged" : to_string(report.finding.verdict));
  if (const std::string why = reason_of(report); !why.empty()) text += fmt::format("  reason           {}\n", why);
  text += fmt::format("  claimed          {}{}\n", exact_text(report.claimed), units);
  text += fmt::format("  proven           {}{}\n", exact_text(report.finding.proven), units);
  if (!std::isfinite(report.claimed.hi)) text += "  WITHOUT AN END   nothing is claimed from above\n";
  if (report.penetration) text += readable(*report.penetration, report.ended_early, units);
  text += fmt::format("of                 the distance of two models\n");
  for (const std::string& model : report.models) text += fmt::format("  model            {}\n", quotation(model));
  text += fmt::format("  pose             {} of the second one: translation, quaternion\n", option_text(report.pose));
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  return text +
         fmt::format("certificate        {}{}\n", quotation(report.certificate), mark_of_end(report.ended_early));
}

std::string json(const CertificateReport& report) {
  const std::string why = reason_of(report);
  const JsonObject object{{"kind", "pair"},
                          {"verdict", report.ended_early ? JsonValue() : JsonValue(to_string(report.finding.verdict))},
                          {"claimed", report.claimed},
                          {"proven", report.finding.proven},
                          {"reason", why.empty() ? JsonValue() : JsonValue(why)},
                          {"penetration_depth", json_of(report.penetration, report.ended_early)},
                          {"units", report.units},
                          {"models", report.models},
                          {"pose", report.pose},
                          {"seconds", report.seconds},
                          {"interrupted", report.ended_early},
                          {"certificate", report.certificate}};
  return object.text() + "\n";
}

void refuse_points(const CheckArguments& arguments) {
  const auto refuse_option = [](const char* option) { refuse(fmt::format("{}: only with --map", option)); };
  if (!arguments.inputs.mesh.empty()) refuse_option("--mesh");
  if (!arguments.inputs.points.empty()) refuse_option("--points");
  if (arguments.point_radius != 0.0) refuse_option("--point-radius");
}

}  // namespace

TwoModels models_of(const std::array<SubjectFile, 2>& subjects, const std::string& stated_units,
                    const CertificateCheckArguments& arguments) {
  refuse_other_count(subjects, arguments);
  const auto model = [&](std::size_t i) {
    return subject_model(arguments.models[i], subjects[i], arguments.certificate);
  };
  TwoModels models{model(0), model(1)};
  const std::string units = common_units(models[0], models[1], arguments.models[0], arguments.models[1]);
  refuse_other_units(units, "models", stated_units, arguments.certificate);
  return models;
}

void refuse_other_poses(const std::string& file, std::span<const Pose> poses, const std::string& certificate) {
  if (file.empty()) return;
  const std::vector<Pose> given = read_poses(file);
  if (given.size() != poses.size())
    refuse(fmt::format("{}: {} is of {} poses, not of {}", file, certificate, poses.size(), given.size()));
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (given[k].translation == poses[k].translation && given[k].quaternion == poses[k].quaternion) continue;
    refuse(fmt::format("{}: {} is of other poses: pose {} is {}, not {}", file, certificate, k, option_text(poses[k]),
                       option_text(given[k])));
  }
}

std::string meant_in_words(const std::string& file, std::string_view way) {
  if (!file.empty()) return fmt::format("  is that of         {}, pose by pose\n", quotation(file));
  return fmt::format("  is it the {} that was meant? That is not proved, but for you to see, or by --poses\n", way);
}

void refuse_other_units(const std::string& units, const char* what, const std::string& stated,
                        const std::string& certificate) {
  if (units == stated) return;
  refuse(fmt::format("{}: units = {}: are not those of the {}, {}", certificate, quotation(stated), what,
                     quotation(units)));
}

CertificateCheckArguments arguments_of_two_models(const CheckArguments& arguments) {
  if (arguments.models.empty()) refuse("--model is required");
  if (!arguments.map.empty() || !arguments.surface_map.empty())
    refuse(fmt::format("--map: {} is of two models, not of a map", arguments.certificate));
  refuse_points(arguments);
  if (arguments.inputs.pose) refuse("--pose: only with --map or --octree");
  return {arguments.certificate, arguments.models, arguments.poses, arguments.json, arguments.ended};
}

ExitStatus run_check(const PairAnswer& answer, const CheckArguments& given) {
  const CertificateCheckArguments arguments = arguments_of_two_models(given);
  const auto [a, b] = models_of(answer.models, answer.units, arguments);
  refuse_other_poses(arguments.poses, std::span(&answer.pose, 1), arguments.certificate);
  const Stopwatch time;
  watch_for_interruption();
  const Finding finding = PairChecker(a, b)(answer.pose, answer.distance, answer.certificate, arguments.ended);
  std::optional<JudgedPenetration> penetration;
  if (const auto& claimed = answer.penetration) {
    const PenetrationChecker checker(a, b);
    penetration = {claimed->depth, checker(answer.pose, claimed->depth, claimed->certificate, arguments.ended)};
  }
  const bool is_open =
      finding.verdict == Verdict::unproved || (penetration && penetration->finding.verdict == Verdict::unproved);
  const bool ended_early = is_open && arguments.ended();
  const CertificateReport report{arguments.certificate, arguments.models, answer.units,
                                 answer.pose,           answer.distance,  finding,
                                 penetration,           time.seconds(),   ended_early};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (ended_early) return status_of_end();
  const auto is_proved = [](const Enclosure& claimed, const Finding& found) {
    return found.verdict == Verdict::proved && std::isfinite(claimed.hi);
  };
  const bool all =
      is_proved(answer.distance, finding) && (!penetration || is_proved(penetration->claimed, penetration->finding));
  return all ? ExitStatus::verified : ExitStatus::unverified;
}

ExitStatus run_check(const PoseAnswers& answers, const CheckArguments& given) {
  const CertificateCheckArguments arguments = arguments_of_two_models(given);
  const auto [a, b] = models_of(answers.models, answers.units, arguments);
  std::vector<Pose> poses;
  for (const PosedAnswer& answer : answers.answers) poses.push_back(answer.pose);
  refuse_other_poses(arguments.poses, poses, arguments.certificate);
  watch_for_interruption();
  const PosesReport report = checked_poses(a, b, answers, arguments);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (report.interrupted) return status_of_end();
  const bool all = report.proved == answers.answers.size() && report.unbounded == 0;
  return all ? ExitStatus::verified : ExitStatus::unverified;
}

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
  if (report.interrupted) return status_of_end();
  return report.rows() > 0 && report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
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
  return std::visit([&](const auto& kind) { return run_check(kind, arguments); }, answer);
}

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
  add_time_limit(options, arguments.time_limit, "what was checked by then is printed");
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

}  // namespace

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
  Deadline limit(given.time_limit, interrupted);
  limit.start();
  arguments.ended = limit.stop();
  if (!given.models.empty()) arguments.inputs.model = given.models.front();
  if (!given.certificate.empty()) return check_certificate(arguments);
  if (given.models.empty()) refuse("--model is required");
  if (given.models.size() != 1) refuse("--model: give one, that of the --map or --octree");
  if (!given.octree.empty()) {
    refuse_points(given);
    return run_octree_check({given.octree, given.models.front(), given.inputs.pose, given.sample, given.json,
                             given.no_progress, arguments.ended});
  }
  return check_map_file(arguments);
}

Command check_command() {
  return command("check", "Prove a finished map again from its certificates, without OpenCL", declare_check, run_check);
}

}  // namespace verisq::command_line
