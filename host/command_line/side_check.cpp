/// Primitives by their names, one after the other.
#include "host/command_line/side_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <string_view>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/side_checker.hpp>

#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stated_terms.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

std::vector<std::string> names_of(const Model& model) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < model.primitives.size(); ++k) names.push_back(name_of_primitive(model, k));
  return names;
}

void refuse_other_primitives(const FitAnswer& answer, const Model& model, const CheckArguments& arguments) {
  for (const SideClaim& claim : answer.sides) {
    if (claim.primitive >= model.primitives.size()) {
      refuse(fmt::format("{}: sides: primitive {} of {}, which has {}", arguments.certificate, claim.primitive,
                         arguments.models.front(), model.primitives.size()));
    }
  }
}

/// Which surface that is: how it is turned, and how it is closed where it is not.
std::string mesh_in_words(const SideCheckReport& report) {
  std::string text = "the mesh";
  if (report.outward) text += fmt::format(", whose normals point {}", *report.outward ? "outward" : "inward");
  if (report.rims == 0) return text;
  const std::string over = report.rims == 1 ? "its rim" : fmt::format("its {} rims", report.rims);
  return text + fmt::format(", closed over {} by fans", over);
}

/// What lies less deep may be anywhere.
std::string depth_in_words(const FitAnswer& answer) {
  const double limit = answer.terms.penetration_limit;
  if (limit == 0.0) return "all of it";
  return fmt::format("all of it that is deeper in it than {}", with_units(fmt::format("{}", limit), answer.units));
}

/// What is wrong with the mesh is told with its name.
SideChecker checker_of(const Model& model, const CheckArguments& arguments, double penetration_limit) try {
  return {model, read_mesh(arguments.inputs.mesh), penetration_limit};
} catch (const Error& error) {
  const bool is_named = std::string_view(error.what()).starts_with(arguments.inputs.mesh);
  if (error.kind() != ErrorKind::input || is_named) throw;
  refuse(fmt::format("{}: {}", arguments.inputs.mesh, error.what()));
}

/// Primitives of which nothing is claimed.
std::vector<std::string> others_of(const FitAnswer& answer, const SideCheckReport& report) {
  std::vector<std::string> others = report.names;
  for (const SideClaim& claim : answer.sides) others[claim.primitive].clear();
  std::erase(others, "");
  return others;
}

}  // namespace

bool SideCheckReport::all_proved() const {
  return std::ranges::all_of(verdicts, [](Verdict verdict) { return verdict == Verdict::proved; });
}

SideCheckReport checked_sides(const FitAnswer& answer, const CheckArguments& arguments) {
  SideCheckReport report;
  if (answer.sides.empty()) return report;
  const Model model = read_model(arguments.models.front());
  refuse_other_primitives(answer, model, arguments);
  report.names = names_of(model);
  const SideChecker checker = checker_of(model, arguments, answer.terms.penetration_limit);
  report.rims = checker.rims();
  report.outward = checker.faces_outward();
  ProgressBar bar(!arguments.no_progress, "%");
  const CheckOptions options{.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                             .interrupted = interrupted,
                             .progress = [&bar](double done) { bar.update_state("sides", done); }};
  for (const SideClaim& claim : answer.sides) report.verdicts.push_back(verdict_of(checker(claim, options)));
  report.interrupted = interrupted();
  if (report.interrupted) report.verdicts.clear();
  return report;
}

std::string sides_in_words(const FitAnswer& answer, const SideCheckReport& report) {
  if (answer.sides.empty()) return "";
  if (report.interrupted) return fmt::format("sides                {}, not judged\n", answer.sides.size());
  std::string text = verdicts_in_words("sides of the mesh", counted(report.verdicts, [](Verdict verdict) {
                                         return Finding{verdict, {}};
                                       }));
  for (std::size_t i = 0; i < answer.sides.size(); ++i) {
    const auto& [primitive, side] = answer.sides[i];
    text += fmt::format("  {:<8} {}: {} lies {} of {}\n", name_of(report.verdicts[i]), report.names[primitive],
                        depth_in_words(answer), to_string(side), mesh_in_words(report));
  }
  const std::vector<std::string> others = others_of(answer, report);
  if (!others.empty())
    text += fmt::format("  of {} nothing is claimed: may lie on any side\n", fmt::join(others, ", "));
  return text + "  are these the sides and the limit that were meant? That is not proved, but for you to see\n";
}

JsonValue sides_of(const FitAnswer& answer, const SideCheckReport& report) {
  if (answer.sides.empty()) return {};
  JsonValue::Array claims;
  for (std::size_t i = 0; i < answer.sides.size(); ++i) {
    const auto& [primitive, side] = answer.sides[i];
    claims.push_back(JsonObject{
        {"primitive", report.names[primitive]},
        {"side", std::string(to_string(side))},
        {"verdict", report.interrupted ? JsonValue() : JsonValue(std::string(name_of(report.verdicts[i])))}});
  }
  return JsonObject{{"rims", report.rims},
                    {"faces_outward", report.outward ? JsonValue(*report.outward) : JsonValue()},
                    {"penetration_limit", answer.terms.penetration_limit},
                    {"claims", claims},
                    {"not_claimed", others_of(answer, report)}};
}

}  // namespace verisq::command_line
