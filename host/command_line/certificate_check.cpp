/// Compares the models' digests with those of the certificate, has the answer proved, prints the verdict.
#include "host/command_line/certificate_check.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <span>
#include <verisq/certificate_file.hpp>
#include <verisq/model_file.hpp>

#include "host/command_line/check_summary.hpp"
#include "host/command_line/common_units.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

void refuse_other_models(std::span<const SubjectFile> expected, const CertificateCheckArguments& arguments) {
  if (arguments.models.size() != expected.size()) {
    refuse(fmt::format("{}: is about {} models: give a --model for each, in its order, not {}", arguments.certificate,
                       expected.size(), arguments.models.size()));
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const SubjectFile given = subject_file(arguments.models[i]);
    if (given.sha256 == expected[i].sha256) continue;
    refuse(fmt::format("{}: {} is about another model: its SHA-256 is {}, not {}", arguments.models[i],
                       arguments.certificate, expected[i].sha256, given.sha256));
  }
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
  text += fmt::format("of                 the distance of two models\n");
  for (const std::string& model : report.models) text += fmt::format("  model            {}\n", model);
  const auto& [t, q] = report.pose;
  text += fmt::format("  pose             {},{},{},{},{},{},{} of the second one: translation, quaternion\n", t[0],
                      t[1], t[2], q[0], q[1], q[2], q[3]);
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate        {}\n", report.certificate);
}

std::string json(const CertificateReport& report) {
  const std::string why = reason_of(report);
  const JsonObject object{
      {"kind", "pair"},
      {"verdict", name_of(report.finding.verdict)},
      {"claimed", report.claimed},
      {"proven", report.finding.proven},
      {"reason", why.empty() ? JsonValue() : JsonValue(why)},
      {"units", report.units},
      {"models", report.models},
      {"pose", JsonObject{{"translation", report.pose.translation}, {"quaternion", report.pose.quaternion}}},
      {"seconds", report.seconds},
      {"certificate", report.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_certificate_check(const CertificateCheckArguments& arguments) {
  const PairAnswer answer = read_pair_answer(arguments.certificate);
  refuse_other_models(answer.models, arguments);
  const Model a = read_model(arguments.models[0]);
  const Model b = read_model(arguments.models[1]);
  for (const auto& [model, file] : {std::pair(&a, arguments.models[0]), std::pair(&b, arguments.models[1])}) {
    if (!is_union_of_convex(*model)) {
      refuse(
          fmt::format("{}: pairs of bent models, or of csg other than the union of all primitives, have no "
                      "certificates to check",
                      file));
    }
  }
  const std::string units = common_units(a, b, arguments.models[0], arguments.models[1]);
  if (answer.units != units) {
    refuse(fmt::format("{}: units = \"{}\": are not those of the models, \"{}\"", arguments.certificate, answer.units,
                       units));
  }
  const Stopwatch time;
  const Finding finding = check(a, b, answer.pose, answer.distance, answer.certificate);
  const CertificateReport report{arguments.certificate, arguments.models, answer.units,  answer.pose,
                                 answer.distance,       finding,          time.seconds()};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return finding.verdict == Verdict::proved ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
