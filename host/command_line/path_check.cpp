/// All processors prove the parts of the path; then each claim is compared with what these say together.
#include "host/command_line/path_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/path_certificate.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/path_extent.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

struct Claim {
  std::string_view what;
  std::string_view unit;
  Enclosure value;
  Finding finding;
};

struct PathCheckReport {
  std::vector<Claim> claims;  ///< none of an interrupted check
  std::string units;
  double seconds = 0.0;
  bool interrupted = false;

  [[nodiscard]] VerdictCounts counts() const { return counted(claims, &Claim::finding); }
  [[nodiscard]] bool all_proved() const { return !interrupted && counts().are_all_proved(); }
};

PathCheckReport checked(const PathAnswer& answer, const TwoModels& models, const CheckArguments& arguments) {
  PathCheckReport report{.claims = {}, .units = answer.units};
  ProgressBar bar(!arguments.no_progress, "parts");
  const Stopwatch time;
  const auto parts = static_cast<double>(answer.certificate.parts.size());
  const PathClaims proven =
      PathChecker(models[0], models[1], answer.path)
          .prove(answer.certificate,
                 {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                  .interrupted = interrupted,
                  .progress = [&](double done) { bar.update(static_cast<std::uint64_t>(done * parts), done); }});
  report.seconds = time.seconds();
  report.interrupted = interrupted();
  if (report.interrupted) return report;
  const PathFindings findings = check(answer.claims, proven);
  report.claims.push_back({"smallest distance of all times", answer.units, answer.claims.smallest, findings.smallest});
  if (findings.first_contact)
    report.claims.push_back({"time of the first contact", "", *answer.claims.first_contact, *findings.first_contact});
  return report;
}

/// What the claims say of a contact, where they are proved.
std::string_view contact_in_words(const PathClaims& claims) {
  if (claims.smallest.lo > 0.0) return "apart at all times, between the poses too";
  if (!claims.first_contact) return "whether they meet is NOT claimed";
  if (std::isfinite(claims.first_contact->hi)) return "meet: no common point before the first contact";
  if (claims.first_contact->lo == infinity) return "no common point at any time, between the poses too";
  return "apart before the time of the first contact; whether they ever meet is NOT claimed";
}

/// The same in one word, of claims that are all proved: infinite ends of claims are null in JSON.
std::string_view contact_in_a_word(const PathClaims& claims) {
  const auto& contact = claims.first_contact;
  if (claims.smallest.lo > 0.0 || (contact && contact->lo == infinity)) return "never";
  return contact && std::isfinite(contact->hi) ? "meets" : "not_claimed";
}

std::string readable(const PathAnswer& answer, const PathCheckReport& report, const CheckArguments& arguments) {
  std::string text = verdicts_in_words("claims", report.counts());
  for (const auto& [what, unit, value, finding] : report.claims) {
    text += fmt::format("  {:<8} {}: {}{}{}\n", name_of(finding.verdict), what, exact_text(value),
                        unit.empty() ? "" : " ", unit);
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", exact_text(finding.proven));
  }
  if (!std::isfinite(answer.claims.smallest.hi))
    text += "  WITHOUT AN END     nothing is claimed of the smallest distance from above\n";
  if (report.all_proved()) text += fmt::format("the models           {}\n", contact_in_words(answer.claims));
  text += fmt::format("of                   {}, which rests\n", arguments.models[0]);
  text += fmt::format("  and                {}, which moves\n", arguments.models[1]);
  text += path_in_words(answer.path, "path", "the moving model's", report.units.empty() ? "" : " " + report.units);
  text += "  between the poses  steady: straight, and about one axis by the smaller angle\n";
  text += meant_in_words(arguments.poses, "path");
  text += fmt::format("parts                {}\n", answer.certificate.parts.size());
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  return text +
         fmt::format("certificate          {}{}\n", arguments.certificate, report.interrupted ? " (interrupted)" : "");
}

std::string json(const PathAnswer& answer, const PathCheckReport& report, const CheckArguments& arguments) {
  JsonValue::Array claims;
  for (const auto& [what, unit, value, finding] : report.claims) {
    claims.push_back(JsonObject{
        {"what", what}, {"verdict", name_of(finding.verdict)}, {"claimed", value}, {"proven", finding.proven}});
  }
  const JsonObject object{{"kind", "path"},
                          {"claims", claims},
                          {"contact", report.all_proved() ? JsonValue(contact_in_a_word(answer.claims)) : JsonValue()},
                          {"path_begin", answer.path.front()},
                          {"path_end", answer.path.back()},
                          {"poses", answer.path.size()},
                          {"path_length", length_of(answer.path)},
                          {"path_degrees", degrees_of(answer.path)},
                          {"parts", answer.certificate.parts.size()},
                          {"units", report.units},
                          {"models", arguments.models},
                          {"seconds", report.seconds},
                          {"interrupted", report.interrupted},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_path_check(const PathAnswer& answer, const CheckArguments& arguments) {
  const TwoModels models =
      models_of(answer.models, answer.units, {arguments.certificate, arguments.models, arguments.poses});
  refuse_other_poses(arguments.poses, answer.path, arguments.certificate);
  watch_for_interruption();
  const PathCheckReport report = checked(answer, models, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.interrupted) return ExitStatus::interrupted;
  const bool all = report.all_proved() && std::isfinite(answer.claims.smallest.hi);
  return all ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
