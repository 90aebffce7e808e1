/// Compares the models' digests with those of the certificate, has the answer proved, prints the verdict.
#include "host/command_line/certificate_check.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <verisq/certificate_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/pair_checker.hpp>
#include <verisq/pose_file.hpp>

#include "host/command_line/check_summary.hpp"
#include "host/command_line/common_units.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/poses_check.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

void refuse_other_models(std::span<const SubjectFile> expected, const CertificateCheckArguments& arguments) {
  if (arguments.models.size() != expected.size()) {
    refuse(fmt::format("{}: is about {} models: give a --model for each, in its order, not {}", arguments.certificate,
                       expected.size(), arguments.models.size()));
  }
  for (std::size_t i = 0; i < expected.size(); ++i)
    refuse_other_file(arguments.models[i], "model", expected[i], arguments.certificate);
}

struct CertificateReport {
  std::string certificate;
  std::vector<std::string> models;
  std::string units;
  Pose pose;
  Enclosure claimed;
  Finding finding;
  double seconds;
};

std::string reason_of(const CertificateReport& report) {
  return report.finding.verdict == Verdict::proved ? std::string() : reason(report.claimed, report.finding);
}

std::string readable(const CertificateReport& report) {
  const std::string units = report.units.empty() ? std::string() : " " + report.units;
  std::string text = fmt::format("verdict            {}\n", name_of(report.finding.verdict));
  if (const std::string why = reason_of(report); !why.empty()) text += fmt::format("  reason           {}\n", why);
  text += fmt::format("  claimed          {}{}\n", exact_text(report.claimed), units);
  text += fmt::format("  proven           {}{}\n", exact_text(report.finding.proven), units);
  if (!std::isfinite(report.claimed.hi)) text += "  WITHOUT AN END   nothing is claimed from above\n";
  text += fmt::format("of                 the distance of two models\n");
  for (const std::string& model : report.models) text += fmt::format("  model            {}\n", model);
  text += fmt::format("  pose             {} of the second one: translation, quaternion\n", option_text(report.pose));
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate        {}\n", report.certificate);
}

std::string json(const CertificateReport& report) {
  const std::string why = reason_of(report);
  const JsonObject object{{"kind", "pair"},
                          {"verdict", name_of(report.finding.verdict)},
                          {"claimed", report.claimed},
                          {"proven", report.finding.proven},
                          {"reason", why.empty() ? JsonValue() : JsonValue(why)},
                          {"units", report.units},
                          {"models", report.models},
                          {"pose", report.pose},
                          {"seconds", report.seconds},
                          {"certificate", report.certificate}};
  return object.text() + "\n";
}

ExitStatus check_pair(const PairAnswer& answer, const CertificateCheckArguments& arguments) {
  const auto [a, b] = models_of(answer.models, answer.units, arguments);
  refuse_other_poses(arguments.poses, std::span(&answer.pose, 1), arguments.certificate);
  const Stopwatch time;
  const Finding finding = PairChecker(a, b)(answer.pose, answer.distance, answer.certificate);
  const CertificateReport report{arguments.certificate, arguments.models, answer.units,  answer.pose,
                                 answer.distance,       finding,          time.seconds()};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  const bool all = finding.verdict == Verdict::proved && std::isfinite(answer.distance.hi);
  return all ? ExitStatus::verified : ExitStatus::unverified;
}

ExitStatus check_poses(const PoseAnswers& answers, const CertificateCheckArguments& arguments) {
  const auto [a, b] = models_of(answers.models, answers.units, arguments);
  std::vector<Pose> poses;
  for (const PosedAnswer& answer : answers.answers) poses.push_back(answer.pose);
  refuse_other_poses(arguments.poses, poses, arguments.certificate);
  watch_for_interruption();
  const PosesReport report = checked_poses(a, b, answers, arguments);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (report.interrupted) return ExitStatus::interrupted;
  const bool all = report.proved == answers.answers.size() && report.unbounded == 0;
  return all ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace

TwoModels models_of(const std::array<SubjectFile, 2>& subjects, const std::string& stated_units,
                    const CertificateCheckArguments& arguments) {
  refuse_other_models(subjects, arguments);
  TwoModels models{read_model(arguments.models[0]), read_model(arguments.models[1])};
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
  if (!file.empty()) return fmt::format("  is that of         {}, pose by pose\n", file);
  return fmt::format("  is it the {} that was meant? That is not proved, but for you to see, or by --poses\n", way);
}

void refuse_other_file(const std::string& file, const char* what, const SubjectFile& expected,
                       const std::string& certificate) {
  const SubjectFile given = subject_file(file);
  if (given.sha256 == expected.sha256) return;
  refuse(fmt::format("{}: {} is about another {}: its SHA-256 is {}, not {}", file, certificate, what, expected.sha256,
                     given.sha256));
}

void refuse_other_units(const std::string& units, const char* what, const std::string& stated,
                        const std::string& certificate) {
  if (units == stated) return;
  refuse(fmt::format("{}: units = \"{}\": are not those of the {}, \"{}\"", certificate, stated, what, units));
}

ExitStatus run_certificate_check(const Answer& answer, const CertificateCheckArguments& arguments) {
  if (const auto* const pair = std::get_if<PairAnswer>(&answer)) return check_pair(*pair, arguments);
  return check_poses(std::get<PoseAnswers>(answer), arguments);
}

}  // namespace verisq::command_line
