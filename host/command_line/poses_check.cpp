/// All processors check, one thread counts.
#include "host/command_line/poses_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>
#include <verisq/pair_checker.hpp>

#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

void count(const Finding& finding, std::size_t index, const PosedAnswer& answer, PosesReport& report) {
  report.unbounded += std::isfinite(answer.distance.hi) ? 0 : 1;
  switch (finding.verdict) {
    case Verdict::proved:
      ++report.proved;
      report.largest_width = std::max(report.largest_width, answer.distance.width());
      return;
    case Verdict::refuted: ++report.refuted; break;
    case Verdict::unproved: ++report.unproved; break;
  }
  const bool is_first_refuted = finding.verdict == Verdict::refuted && report.refuted == 1;
  if (!report.first || is_first_refuted) report.first = {index, answer, finding};
}

std::string readable(const PosesReport::Open& open) {
  const auto& [index, answer, finding] = open;
  return fmt::format("first {} pose, index {}, {}: {}\n  claimed          {}\n  proven           {}\n",
                     name_of(finding.verdict), index, option_text(answer.pose), reason(answer.distance, finding),
                     exact_text(answer.distance), exact_text(finding.proven));
}

JsonValue object_of(const std::optional<PosesReport::Open>& open) {
  if (!open) return {};
  const auto& [index, answer, finding] = *open;
  return JsonObject{
      {"verdict", name_of(finding.verdict)}, {"index", index},           {"pose", answer.pose},
      {"claimed", answer.distance},          {"proven", finding.proven}, {"reason", reason(answer.distance, finding)}};
}

}  // namespace

PosesReport checked_poses(const Model& a, const Model& b, const PoseAnswers& answers,
                          const CertificateCheckArguments& arguments) {
  PosesReport report{.arguments = arguments, .units = answers.units};
  std::vector<std::optional<Finding>> findings(answers.answers.size());
  const Stopwatch time;
  const PairChecker check(a, b);
  in_parallel(findings.size(), [&](std::size_t i) {
    if (interrupted()) return;
    const PosedAnswer& answer = answers.answers[i];
    findings[i] = check(answer.pose, answer.distance, answer.certificate);
  });
  report.seconds = time.seconds();
  report.interrupted = interrupted();
  for (std::size_t i = 0; i < findings.size(); ++i)
    if (findings[i]) count(*findings[i], i, answers.answers[i], report);
  return report;
}

std::string readable(const PosesReport& report) {
  const std::string units = report.units.empty() ? std::string() : " " + report.units;
  std::string text = fmt::format("poses              {}\n", report.proved + report.refuted + report.unproved);
  text += fmt::format("  proved           {}\n", report.proved);
  text += fmt::format("  refuted          {}\n", report.refuted);
  text += fmt::format("  unproved         {}\n", report.unproved);
  if (report.unbounded > 0)
    text += fmt::format("  WITHOUT AN END   {}: of these nothing is claimed from above\n", report.unbounded);
  if (report.proved > 0)
    text += fmt::format("  largest width    {:.3g}{} of the proved ones\n", report.largest_width, units);
  text += fmt::format("of                 the distances of two models\n");
  for (const std::string& model : report.arguments.models) text += fmt::format("  model            {}\n", model);
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  text += fmt::format("certificate        {}{}\n", report.arguments.certificate,
                      report.interrupted ? " (interrupted)" : "");
  if (report.first) text += readable(*report.first);
  return text;
}

std::string json(const PosesReport& report) {
  const JsonObject object{{"kind", "poses"},
                          {"proved", report.proved},
                          {"refuted", report.refuted},
                          {"unproved", report.unproved},
                          {"without_an_end", report.unbounded},
                          {"largest_width", report.largest_width},
                          {"first", object_of(report.first)},
                          {"units", report.units},
                          {"models", report.arguments.models},
                          {"seconds", report.seconds},
                          {"interrupted", report.interrupted},
                          {"certificate", report.arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace verisq::command_line
