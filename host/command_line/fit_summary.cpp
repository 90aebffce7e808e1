/// The certified summary of a fit, and of the instrument that prepares the implant's bed.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <tuple>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>

#include "host/command_line/fit_command.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq::command_line {

std::vector<Instrument> read_instruments(const FitProblem& problem, const FitArguments& arguments) {
  if (arguments.instruments.empty()) return {};
  if (arguments.instruments.size() != arguments.implants.size()) {
    refuse(fmt::format("--instrument: give one for each --implant, in the same order: {} for {}",
                       arguments.instruments.size(), arguments.implants.size()));
  }
  if (problem.mesh.triangles.empty()) {
    refuse(fmt::format("--instrument: {} has no triangles to cut", arguments.mesh));
  }
  std::vector<Instrument> instruments;
  for (const std::string& file : arguments.instruments) {
    instruments.push_back({file, read_model(file)});
    const std::string& units = instruments.back().model.units;
    if (units == problem.units || units.empty()) continue;
    refuse(fmt::format("{}: units = {}: are not those of the implants, {}", file, quotation(units),
                       quotation(problem.units)));
  }
  return instruments;
}

InstrumentClearance prove_instrument(const FitProblem& problem, const Fit& fit, const Instrument& instrument,
                                     const std::function<bool()>& stop) {
  MapOptions options{};  // the tolerance is the problem's
  options.interrupted = stop;
  return {instrument.file, prove_surface(problem, posed(instrument.model, fit.pose), options)};
}

namespace {

using Lines = std::vector<ReportLine>;

std::string units_of(const FitSummary& summary) {
  return units_behind(summary.units);
}

/// Rounded down, so that "100.0 %" is said of all points only.
std::string percentage(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  const double share = static_cast<double>(part) / static_cast<double>(whole);
  return fmt::format("{:.1f} %", std::floor(1000.0 * share) / 10.0);
}

/// Rounded up, so that "0.0 %" is said of no point only.
std::string percentage_up(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  const double share = static_cast<double>(part) / static_cast<double>(whole);
  return fmt::format("{:.1f} %", std::ceil(1000.0 * share) / 10.0);
}

std::uint64_t undecided_depths(const Clearance& clearance) {
  return clearance.map.points - clearance.proven_too_deep - clearance.proven_shallow;
}

std::string verdict(const FitSummary& summary) {
  const auto& [clearance, surface] = std::tie(summary.clearance, summary.surface);
  if (clearance.proven_too_deep > 0) return fmt::format("EXCEEDED, proven of {} points", clearance.proven_too_deep);
  if (surface && surface->proven_too_deep > 0)
    return fmt::format("EXCEEDED between points, proven of {} triangles", surface->proven_too_deep);
  if (undecided_depths(clearance) > 0) return fmt::format("not decided of {} points", undecided_depths(clearance));
  if (surface && surface->undecided > 0) return fmt::format("not decided of {} triangles", surface->undecided);
  return surface ? "kept, proven of the whole surface" : "kept, proven of every vertex";
}

std::string numbers(std::span<const double> values) {
  return fmt::format("({:.17g})", fmt::join(values, ", "));
}

Lines pose_lines(const FitSummary& summary) {
  const Pose& pose = summary.fit.pose;
  Lines lines{{"implant", quotation(summary.implant)},
              {"translation", numbers(pose.translation) + units_of(summary)},
              {"quaternion", numbers(pose.quaternion)}};
  const auto& [centre, rotation, at_limits] = summary.fit.movement;
  lines.push_back({"moved", fmt::format("({:.4g}){} of its centre, from the start; turned by {:.4g} degrees about it",
                                        fmt::join(centre, ", "), summary.units.empty() ? " units" : units_of(summary),
                                        std::hypot(rotation[0], rotation[1], rotation[2]))});
  if (!at_limits.empty()) lines.push_back({"  ended by the range", quotation(at_limits)});
  if (!summary.sized) return lines;
  for (const Primitive& primitive : summary.fit.model.primitives) {
    lines.push_back({"semi-axes", fmt::format("{}{} of {}", numbers(primitive.superquadric.semi_axes),
                                              units_of(summary), quotation(primitive.name))});
  }
  return lines;
}

Lines surface_lines(const MeshClearance& surface, const std::string& units) {
  return {{"whole surface", fmt::format("smallest distance {}{}", outward_digits(surface.smallest_distance), units)},
          {"  proven within", fmt::format("{} triangles", surface.proven_within)},
          {"  proven too deep", fmt::format("{} triangles", surface.proven_too_deep)},
          {"  undecided", fmt::format("{} triangles", surface.undecided)}};
}

/// The statement about the bone's surface; about bone deeper inside, the instrument's clearance says nothing.
Lines instrument_lines(const FitSummary& summary) {
  if (!summary.instrument) return {};
  const auto& [file, surface] = *summary.instrument;
  const std::string units = units_of(summary);
  return {{"instrument", fmt::format("{}, where the implant lies", quotation(file))},
          {"  bone's surface", fmt::format("nowhere deeper inside it than {}{}, proven",
                                           upper_digits(std::max(0.0, -surface.smallest_distance.lo)), units)},
          {"  smallest distance", outward_digits(surface.smallest_distance) + units},
          {"  enters it",
           fmt::format("{} triangles{}, proven, and {} undecided; the other {} do not", surface.proven_too_deep,
                       summary.penetration_limit > 0.0
                           ? fmt::format(" by more than {:.10g}{}", summary.penetration_limit, units)
                           : "",
                       surface.undecided, surface.proven_within)}};
}

Lines joined(std::initializer_list<Lines> parts) {
  Lines lines;
  for (const Lines& part : parts) lines.insert(lines.end(), part.begin(), part.end());
  return lines;
}

std::string_view surface_name(FitSurface surface) {
  return surface == FitSurface::cavity ? "cavity" : "bone";
}

/// Describes the finding, after the primitive's name.
std::string in_words(SideFinding finding, SurfaceSide required, FitSurface surface) {
  const std::string_view side = to_string(required);
  const std::string_view other = required == SurfaceSide::inside ? "outside" : "inside";
  const std::string_view name = surface_name(surface);
  switch (finding) {
    case SideFinding::kept: return fmt::format("is proven to lie {} the {}", side, name);
    case SideFinding::other_side: return fmt::format("is proven to lie {} the {}, at least in part", other, name);
    case SideFinding::enters_surface:
      return fmt::format("is not proven to lie {} the {}: it is not proven to keep off its surface", side, name);
    case SideFinding::reaches_through:
      return fmt::format("is not proven to lie {} the {}: it is not proven to keep off the openings", side, name);
    case SideFinding::no_deep_point:
      return fmt::format("is not proven to lie {} the {}: its centre is not proven to lie deeper than the limit", side,
                         name);
    case SideFinding::on_the_surface:
      return fmt::format("is not proven to lie {} the {}: the side of its centre is not decided", side, name);
    case SideFinding::strongly_bent:
      return fmt::format("is not proven to lie {} the {}: its bend is too strong for the limit", side, name);
    case SideFinding::several_parts:
      return fmt::format("is not proven to lie {} the {}, which is in several parts", side, name);
    case SideFinding::no_volume:
      return fmt::format("is not proven to lie {} the {}, which encloses nothing", side, name);
  }
  return "";
}

/// The names of those primitives.
template <class Holds>
std::string names_where(const FitSummary& summary, const Holds& holds) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < summary.required_sides.size(); ++k) {
    if (holds(summary.required_sides[k], summary.sides->of_primitives[k]))
      names.push_back(name_of_primitive(summary.fit.model, k));
  }
  return quotation(names);
}

/// The part of a primitive that the limit of penetration exempts from a proof; "" if the limit is 0.
std::string exemption(const FitSummary& summary) {
  if (summary.penetration_limit == 0.0) return "";
  return fmt::format(", but for what lies at most {:.10g}{} deep in them,", summary.penetration_limit,
                     units_of(summary));
}

Lines side_lines(const FitSummary& summary) {
  if (!summary.sides) return {};
  Lines lines;
  for (const SurfaceSide side : {SurfaceSide::inside, SurfaceSide::outside}) {
    if (std::ranges::find(summary.required_sides, side) == summary.required_sides.end()) continue;
    const std::string proven = names_where(summary, [&](SurfaceSide required, SideFinding found) {
      return required == side && found == SideFinding::kept;
    });
    const std::string open = names_where(summary, [&](SurfaceSide required, SideFinding found) {
      return required == side && found != SideFinding::kept;
    });
    std::string text = proven.empty() ? "" : fmt::format("proven{} of {}", exemption(summary), proven);
    if (!open.empty()) text += fmt::format("{}NOT PROVEN of {}", proven.empty() ? "" : "; ", open);
    lines.push_back({fmt::format("{} the {}", to_string(side), surface_name(summary.side_of)), text});
  }
  const std::string anywhere =
      names_where(summary, [](SurfaceSide required, SideFinding) { return required == SurfaceSide::any; });
  if (!anywhere.empty()) lines.push_back({"  not asked", fmt::format("{}, which may pass the opening", anywhere)});
  return lines;
}

std::string unit_of(const Feature& feature, const FitSummary& summary) {
  return feature.unit == FeatureUnit::degrees ? " degrees" : units_of(summary);
}

std::string in_words(const KeptFeature& kept) {
  return fmt::format("{:.10g} to {:.10g}", kept.range.lo, kept.range.hi);
}

/// The condition under which proven changes hold; "" if landmarks are exact.
std::string condition(const FitSummary& summary) {
  if (summary.landmark_radius == 0.0) return "";
  return fmt::format(" for all landmarks within {:.10g}{}", summary.landmark_radius, units_of(summary));
}

std::string verdict(const FitSummary& summary, const Enclosure& value, const KeptFeature& kept) {
  const std::optional<bool> within = is_within(value, kept.range);
  if (!within) return fmt::format("{}: not decided", in_words(kept));
  return fmt::format("{}: {}, proven{}", in_words(kept), *within ? "kept" : "BROKEN", condition(summary));
}

/// Returns whether a range is required of that change.
bool is_asked(const FitSummary& summary, const Feature& change) {
  return std::ranges::find(summary.kept, change.name, &KeptFeature::name) != summary.kept.end();
}

/// True if it is proven to be within all ranges required of it, false if it is proven not to be; nothing if that is
/// open.
std::optional<bool> is_kept(const FitSummary& summary, const Feature& change) {
  bool decided = true;
  for (const KeptFeature& kept : summary.kept) {
    if (kept.name != change.name) continue;
    const std::optional<bool> within = is_within(change.value, kept.range);
    if (within == false) return false;
    decided = decided && within.has_value();
  }
  return decided ? std::optional(true) : std::nullopt;
}

Lines change_lines(const FitSummary& summary) {
  Lines lines;
  for (const Feature& change : summary.changes.features) {
    std::string text = outward_digits(change.value) + unit_of(change, summary);
    for (const KeptFeature& kept : summary.kept) {
      if (kept.name == change.name) text += "; " + verdict(summary, change.value, kept);
    }
    lines.push_back({change.name, text});
  }
  return lines;
}

std::string end_of_bound(const FitBound& bound) {
  if (bound.interrupted) return ", interrupted";
  return bound.out_of_time ? ", out of time" : "";
}

/// One digit after the point, rounded up.
std::string percent_up(double share) {
  return fmt::format("{:.1f} %", std::ceil(1000.0 * share * (1.0 + 0x1p-50)) / 10.0);
}

Lines bound_lines(const FitSummary& summary) {
  if (!summary.best) return {};
  const auto& [bound, asked, gap, seconds] = *summary.best;
  if (bound.upper == -infinity)
    return {{"best possible", "no pose of the range keeps the limit at the vertices, proven"}};
  Lines lines{{"best possible",
               fmt::format("at most {} in any pose of the range that keeps the limit at the vertices, proven{}",
                           upper_digits(bound.upper), end_of_bound(bound))}};
  lines.push_back({"  fit is within", gap ? fmt::format("{} of the best possible, proven", percent_up(*gap))
                                          : "not said: the limit is not proven to be kept, or F not to be positive"});
  return lines;
}

/// The verdict on the requirement of contact, after its enclosure.
std::string verdict_of_contact(const FitSummary& summary, const std::string& name) {
  std::string text;
  for (const FitCondition& condition : summary.conditions) {
    if (condition.name != name || condition.unit != ConditionUnit::percent) continue;
    const char* const broken_or_kept = condition.kept == true ? "kept, proven" : "BROKEN, proven";
    text += fmt::format("; {:.10g} to {:.10g} %: {}", condition.range->lo, condition.range->hi,
                        condition.kept ? broken_or_kept : "not decided");
  }
  return text;
}

ReportLine contact_line(const FitSummary& summary, const std::string& name, const AreaWithin& contact) {
  constexpr int digits = 4;
  const std::size_t colon = name.find(':');
  const std::string area =
      colon == std::string::npos ? "" : fmt::format("; area {}", quotation(std::string_view(name).substr(colon + 1)));
  return {fmt::format("  {}", name.substr(0, colon)),
          fmt::format("{} %, {} of {}{}{}{}", outward_digits(claim_of(contact).percent, digits),
                      outward_digits(contact.within, digits), outward_digits(contact.area, digits),
                      units_behind(summary.units, 2), verdict_of_contact(summary, name), area)};
}

Lines contact_lines(const FitSummary& summary) {
  if (!summary.contact) return {};
  const auto& [of_mesh, by_region, of_implant, samples, interrupted] = *summary.contact;
  Lines lines{
      {"area in contact", fmt::format("at most {:.10g}{} apart, proven", summary.contact_distance, units_of(summary))},
      contact_line(summary, "contact", of_mesh)};
  for (std::size_t k = 0; k < by_region.size() && by_region.size() > 1; ++k) {
    if (by_region[k].area.hi > 0.0)
      lines.push_back(contact_line(summary, "contact:" + summary.clearance.areas[k].area.name, by_region[k]));
  }
  if (of_implant) lines.push_back(contact_line(summary, "implant_contact", *of_implant));
  return lines;
}

enum class Readers { people, programs };

/// Conditions, ranges and sizes: for people with names in quotation marks, behind the numbers.
std::vector<std::string> what_binds(const FitSummary& summary, Readers readers) {
  const bool people = readers == Readers::people;
  std::vector<std::string> names;
  for (const FitCondition& condition : summary.conditions) {
    if (!condition.binds) continue;
    const double end = *condition.binds == RangeEnd::lower ? condition.range->lo : condition.range->hi;
    names.push_back(people ? fmt::format("at {:.10g} {}", end, quotation(condition.name))
                           : fmt::format("{} at {:.10g}", condition.name, end));
  }
  for (const std::string& limit : summary.fit.movement.at_limits) names.push_back(people ? quotation(limit) : limit);
  return names;
}

Lines binding_lines(const FitSummary& summary) {
  const std::vector<std::string> names = what_binds(summary, Readers::people);
  return {{"binding", names.empty() ? "no condition, no range" : fmt::format("{}", fmt::join(names, ", "))}};
}

std::string volume(const FitSummary& summary, double size) {
  return fmt::format("about {:.4g}{}", size, units_behind(summary.units, 3));
}

Lines size_lines(const FitSummary& summary) {
  if (summary.maximised != FitObjective::size) return {};
  const double size = implant_size(summary.fit.model);
  const bool all_kept =
      std::ranges::all_of(summary.conditions, [](const FitCondition& condition) { return condition.kept == true; });
  const auto larger = std::ranges::count_if(summary.trials, [&](const FitTrial& trial) { return trial.size > size; });
  std::string text = fmt::format("{}, the volumes of the primitives; ", volume(summary, size));
  if (!all_kept)
    text += "NOT PROVEN to keep all that is asked, nor is any other";
  else if (larger == 0)
    text += summary.implants > 1 ? "the largest of the series" : "the largest that the search found";
  else
    text += fmt::format("of {} larger no pose was found that is proven to keep all that is asked", larger);
  return {{"size", text}};
}

/// Describes the results for a pose that was not chosen.
std::string in_words(const FitSummary& summary, const FitTrial& trial) {
  const FitFinalist& found = trial.fit;
  std::string text = fmt::format("F about {:.6g}", found.objective);
  if (summary.maximised == FitObjective::size || summary.implants > 1) text += ", size " + volume(summary, trial.size);
  if (found.deepest_penetration > summary.penetration_limit)
    text += fmt::format(", bone about {:.3g}{} deep in it", found.deepest_penetration, units_of(summary));
  for (const Feature& change : trial.changes.features)
    text += fmt::format("; {} {}{}", change.name, outward_digits(change.value, 4), unit_of(change, summary));
  if (!trial.open.empty()) text += fmt::format("; not proven: {}", quotation(trial.open));
  if (!trial.kept) text += "; limit, sides and contact not tried to be proven";
  return text + "; " + quotation(std::filesystem::path(summary.names[found.implant]).filename().string());
}

Lines trial_lines(const FitSummary& summary) {
  Lines lines;
  for (const FitTrial& trial : summary.trials)
    lines.push_back({fmt::format("finalist {}", lines.size() + 2), in_words(summary, trial)});
  return lines;
}

Lines proven_lines(const FitSummary& summary) {
  const Clearance& clearance = summary.clearance;
  const std::string units = units_of(summary);
  Lines lines{{"objective", fmt::format("{} of at most {}", outward_digits(clearance.objective),
                                        upper_digits(largest_objective(clearance)))},
              {"smallest distance", outward_digits(clearance.smallest_distance) + units},
              {"deepest penetration", outward_digits(clearance.deepest_penetration) + units},
              {"penetration limit", fmt::format("{:.10g}{}: {}", summary.penetration_limit, units, verdict(summary))},
              {"  proven within", fmt::format("{} points", clearance.proven_shallow)},
              {"  proven too deep", fmt::format("{} points", clearance.proven_too_deep)},
              {"  undecided", fmt::format("{} points", undecided_depths(clearance))}};
  if (summary.surface) {
    const Lines of_surface = surface_lines(*summary.surface, units);
    lines.insert(lines.end(), of_surface.begin(), of_surface.end());
  }
  return joined({size_lines(summary), side_lines(summary), bound_lines(summary), lines, change_lines(summary),
                 contact_lines(summary), binding_lines(summary), instrument_lines(summary)});
}

Lines point_lines(const FitSummary& summary) {
  const MapSummary& map = summary.clearance.map;
  return {{"points", fmt::format("{}", map.points)},
          {"  device-verified", fmt::format("{}", map.device_verified)},
          {"  host-verified", fmt::format("{}", map.host_verified)},
          {"  wide", fmt::format("{}", map.wide)},
          {"tolerance", fmt::format("{:.3g}{}", summary.tolerance, units_of(summary))}};
}

Lines area_lines(const FitSummary& summary) {
  Lines lines;
  for (const AreaClearance& area : summary.clearance.areas) {
    std::string text =
        fmt::format("{} points of weight {:.10g}: {} proven within, {} proven outside, {} undecided", area.points,
                    area.area.weight, percentage(area.proven_within, area.points),
                    percentage_up(area.proven_outside, area.points), percentage_up(area.undecided, area.points));
    if (area.points > 0) {
      const std::string units = units_of(summary);
      text += fmt::format("; smallest distance {}{}, mean {}{}, median {}{}, of 95 % of the points at most {}{}",
                          outward_digits(area.smallest_distance), units, outward_digits(area.mean_distance), units,
                          outward_digits(area.median_distance), units, outward_digits(area.distance_of_95), units);
    }
    lines.push_back({"area", text + "; named " + quotation(area.area.name)});
  }
  return lines;
}

Lines run_lines(const FitSummary& summary) {
  const auto& [fit, clearance] = std::tie(summary.fit, summary.clearance);
  Lines lines{
      {"search", fmt::format("{:.3g} s, {} poses on {}", summary.search_seconds,
                             with_prefix(static_cast<double>(fit.poses)), quotation(fit.device))},
      {"proof", fmt::format("{:.3g} s (device {:.3g} s, host proofs {:.3g} s) on {}", summary.proof_seconds,
                            clearance.map.device_seconds, clearance.map.host_seconds, quotation(clearance.map.device))},
      {"fitted model", quotation(summary.output)}};
  if (summary.best) {
    lines.push_back({"bound", fmt::format("{:.3g} s, {} boxes of poses", summary.best->seconds,
                                          with_prefix(static_cast<double>(summary.best->bound.boxes)))});
  }
  if (!summary.map.empty()) lines.push_back({"map", quotation(summary.map)});
  if (!summary.surface_map.empty()) lines.push_back({"map of triangles", quotation(summary.surface_map)});
  if (!summary.certificate_file.empty()) lines.push_back({"certificate", quotation(summary.certificate_file)});
  if (summary.certified_upper) {
    const double upper = *summary.certified_upper;
    lines.push_back(
        {"certificate of bound", fmt::format("{}, {}",
                                             upper == -infinity ? "no pose keeps the limit"
                                                                : fmt::format("of F at most {}", upper_digits(upper)),
                                             quotation(summary.bound_certificate))});
  }
  if (!summary.contact_certificate.empty())
    lines.push_back({"contact certificate", quotation(summary.contact_certificate)});
  return lines;
}

std::string text_of(const Lines& lines) {
  std::string text;
  for (const auto& [label, value] : lines) text += fmt::format("{:<21}{}\n", label, value);
  return text;
}

/// A row for each area that has points, in units of the model.
std::string distance_table(const FitSummary& summary) {
  constexpr int digits = 4;
  std::string text = fmt::format("{:<20}{:<20}{:<28}area\n", "mean distance", "median", "95 % of the points at most");
  for (const AreaClearance& area : summary.clearance.areas) {
    if (area.points == 0) continue;
    text += fmt::format("{:<20}{:<20}{:<28}{}\n", outward_digits(area.mean_distance, digits),
                        outward_digits(area.median_distance, digits),
                        outward_digits(area.distance_of_95, digits) + units_of(summary), quotation(area.area.name));
  }
  return text;
}

std::string area_table(const FitSummary& summary) {
  std::string text = fmt::format("\n{:<10}{:>10}{:>10}{:>10}{:>11}  {:<28}area\n", "weight", "points", "within",
                                 "outside", "undecided", "smallest distance");
  for (const AreaClearance& area : summary.clearance.areas) {
    text += fmt::format("{:<10.6g}{:>10}{:>10}{:>10}{:>11}  {:<28}{}\n", area.area.weight, area.points,
                        percentage(area.proven_within, area.points), percentage_up(area.proven_outside, area.points),
                        percentage_up(area.undecided, area.points),
                        area.points > 0 ? outward_digits(area.smallest_distance) + units_of(summary) : "-",
                        quotation(area.area.name));
  }
  return text + "\n" + distance_table(summary) + "\n";
}

JsonValue sizes(const FitSummary& summary) {
  JsonValue::Array sizes;
  for (const Primitive& primitive : summary.fit.model.primitives) {
    if (primitive.mesh) continue;
    sizes.push_back(JsonObject{{"name", primitive.name}, {"semi_axes", primitive.superquadric.semi_axes}});
  }
  return sizes;
}

JsonObject moved(const FitMovement& movement) {
  JsonValue::Array at_limits;
  for (const std::string& limit : movement.at_limits) at_limits.emplace_back(limit);
  return {{"centre", movement.centre}, {"rotation_degrees", movement.rotation_degrees}, {"at_limits", at_limits}};
}

JsonObject surface_json(const MeshClearance& surface) {
  return {{"smallest_distance", surface.smallest_distance},
          {"proven_within_limit", surface.proven_within},
          {"proven_too_deep", surface.proven_too_deep},
          {"undecided", surface.undecided}};
}

JsonValue instrument_json(const FitSummary& summary) {
  if (!summary.instrument) return {};
  return JsonObject{{"file", summary.instrument->file}, {"surface", surface_json(summary.instrument->surface)}};
}

/// True if the requested gap is proven, or none was requested.
bool is_good_enough(const FitSummary& summary) {
  return !summary.best || (summary.best->gap && *summary.best->gap <= summary.best->asked);
}

JsonValue bound_json(const FitSummary& summary) {
  if (!summary.best) return {};
  const auto& [bound, asked, gap, seconds] = *summary.best;
  return JsonObject{{"upper", std::isfinite(bound.upper) ? JsonValue(bound.upper) : JsonValue()},
                    {"asked", asked},
                    {"gap", gap ? JsonValue(*gap) : JsonValue()},
                    {"reached", is_good_enough(summary)},
                    {"boxes", bound.boxes},
                    {"seconds", seconds},
                    {"interrupted", bound.interrupted},
                    {"out_of_time", bound.out_of_time}};
}

JsonValue sides_json(const FitSummary& summary) {
  if (!summary.sides) return {};
  JsonValue::Array sides;
  for (std::size_t k = 0; k < summary.required_sides.size(); ++k) {
    const bool asked = summary.required_sides[k] != SurfaceSide::any;
    sides.push_back(JsonObject{
        {"primitive", name_of_primitive(summary.fit.model, k)},
        {"required", std::string(to_string(summary.required_sides[k]))},
        {"found", asked ? JsonValue(std::string(to_string(summary.sides->of_primitives[k]))) : JsonValue()}});
  }
  return JsonObject{{"of", std::string(surface_name(summary.side_of))},
                    {"rims", summary.sides->rims},
                    {"kept", summary.sides->kept()},
                    {"primitives", sides}};
}

JsonValue changes_json(const FitSummary& summary) {
  JsonValue::Array changes;
  for (const Feature& change : summary.changes.features) {
    JsonValue::Array asked;
    for (const KeptFeature& kept : summary.kept) {
      if (kept.name == change.name) asked.emplace_back(kept.range);
    }
    const std::optional<bool> kept = is_kept(summary, change);
    changes.push_back(JsonObject{{"name", change.name},
                                 {"unit", change.unit == FeatureUnit::degrees ? "degrees" : "length"},
                                 {"value", change.value},
                                 {"asked", asked},
                                 {"kept", is_asked(summary, change) && kept ? JsonValue(*kept) : JsonValue()}});
  }
  return changes;
}

JsonValue unit_json(ConditionUnit unit) {
  switch (unit) {
    case ConditionUnit::length: return "length";
    case ConditionUnit::degrees: return "degrees";
    case ConditionUnit::percent: return "percent";
    case ConditionUnit::none: break;
  }
  return {};
}

JsonValue constraints_json(const FitSummary& summary) {
  JsonValue::Array constraints;
  for (const FitCondition& condition : summary.conditions) {
    JsonValue binds;
    if (condition.binds) binds = condition.binds == RangeEnd::lower ? "lower" : "upper";
    constraints.push_back(JsonObject{{"name", condition.name},
                                     {"unit", unit_json(condition.unit)},
                                     {"value", condition.value ? JsonValue(*condition.value) : JsonValue()},
                                     {"asked", condition.range ? JsonValue(*condition.range) : JsonValue()},
                                     {"kept", condition.kept ? JsonValue(*condition.kept) : JsonValue()},
                                     {"binds", binds}});
  }
  return constraints;
}

JsonObject contact_json(const std::string& name, const AreaWithin& contact) {
  return {{"name", name}, {"area", contact.area}, {"within", contact.within}, {"percent", claim_of(contact).percent}};
}

JsonValue contacts_json(const FitSummary& summary) {
  if (!summary.contact) return {};
  JsonValue::Array shares;
  shares.push_back(contact_json("contact", summary.contact->of_mesh));
  for (std::size_t k = 0; k < summary.contact->by_region.size(); ++k) {
    shares.push_back(contact_json("contact:" + summary.clearance.areas[k].area.name, summary.contact->by_region[k]));
  }
  if (summary.contact->of_model) shares.push_back(contact_json("implant_contact", *summary.contact->of_model));
  return JsonObject{{"distance", summary.contact_distance}, {"shares", shares}};
}

JsonObject finalist_json(const FitSummary& summary, const FitTrial& trial) {
  JsonValue::Array changes;
  for (const Feature& change : trial.changes.features)
    changes.push_back(JsonObject{{"name", change.name}, {"value", change.value}});
  JsonValue::Array open;
  for (const std::string& name : trial.open) open.emplace_back(name);
  const FitFinalist& found = trial.fit;
  return {{"implant", summary.names[found.implant]},
          {"implant_index", found.implant},
          {"pose", found.pose},
          {"size", trial.size},
          {"objective", found.objective},
          {"deepest_penetration", found.deepest_penetration},
          {"within_limit", found.within_limit},
          {"changes", changes},
          {"kept", trial.kept ? JsonValue(*trial.kept) : JsonValue()},
          {"not_proven", open}};
}

JsonValue finalists_json(const FitSummary& summary) {
  JsonValue::Array finalists;
  for (const FitTrial& trial : summary.trials) finalists.push_back(finalist_json(summary, trial));
  return finalists;
}

JsonValue binding_json(const FitSummary& summary) {
  JsonValue::Array names;
  for (const std::string& name : what_binds(summary, Readers::programs)) names.emplace_back(name);
  return names;
}

JsonValue areas(const FitSummary& summary) {
  JsonValue::Array areas;
  for (const AreaClearance& area : summary.clearance.areas) {
    const auto of_points = [&](const Enclosure& distance) {
      return area.points > 0 ? JsonValue(distance) : JsonValue();
    };
    areas.push_back(JsonObject{{"name", area.area.name},
                               {"weight", area.area.weight},
                               {"points", area.points},
                               {"proven_within", area.proven_within},
                               {"proven_outside", area.proven_outside},
                               {"undecided", area.undecided},
                               {"smallest_distance", of_points(area.smallest_distance)},
                               {"mean_distance", of_points(area.mean_distance)},
                               {"median_distance", of_points(area.median_distance)},
                               {"distance_of_95", of_points(area.distance_of_95)}});
  }
  return areas;
}

}  // namespace

double largest_objective(const Clearance& clearance) {
  double sum = 0.0;
  for (const AreaClearance& area : clearance.areas) {  // rounded up: sum of nonnegative terms
    const double of_area = verify::multiply(static_cast<double>(area.points), area.area.weight, verify::Direction::up);
    sum = verify::add(sum, of_area, verify::Direction::up);
  }
  return sum;
}

std::vector<std::string> broken_features(const FitSummary& summary) {
  std::vector<std::string> sentences;
  for (const KeptFeature& kept : summary.kept) {
    if (std::ranges::find(summary.changes.features, kept.name, &Feature::name) == summary.changes.features.end())
      sentences.push_back(fmt::format("{} is not known in this pose, which --keep asks of", quotation(kept.name)));
  }
  for (const Feature& change : summary.changes.features) {
    const std::optional<bool> kept = is_kept(summary, change);
    if (!is_asked(summary, change) || kept == true) continue;
    sentences.push_back(fmt::format("{}: {} within what --keep asks{} of {}", outward_digits(change.value),
                                    kept ? "proven not to be" : "not proven to be", kept ? condition(summary) : "",
                                    quotation(change.name)));
  }
  return sentences;
}

std::vector<std::string> broken_contacts(const FitSummary& summary) {
  std::vector<std::string> sentences;
  for (const FitCondition& condition : summary.conditions) {
    if (condition.unit != ConditionUnit::percent || condition.kept == true) continue;
    sentences.push_back(fmt::format("{} %: {} within what --keep asks of {}", outward_digits(*condition.value, 4),
                                    condition.kept ? "proven not to be" : "not proven to be",
                                    quotation(condition.name)));
  }
  return sentences;
}

std::vector<std::string> broken_sides(const FitSummary& summary) {
  std::vector<std::string> sentences;
  for (std::size_t k = 0; k < summary.required_sides.size(); ++k) {
    const SideFinding found = summary.sides->of_primitives[k];
    if (found == SideFinding::kept) continue;
    sentences.push_back(fmt::format("{} {}", quotation(name_of_primitive(summary.fit.model, k)),
                                    in_words(found, summary.required_sides[k], summary.side_of)));
  }
  return sentences;
}

std::vector<ReportLine> report_lines(const FitSummary& summary) {
  return joined(
      {proven_lines(summary), area_lines(summary), pose_lines(summary), trial_lines(summary), point_lines(summary)});
}

std::string readable(const FitSummary& summary) {
  return text_of(joined({pose_lines(summary), proven_lines(summary), point_lines(summary)})) + area_table(summary) +
         text_of(joined({trial_lines(summary), run_lines(summary)}));
}

namespace {

JsonObject search_json(const FitSummary& summary) {
  const Fit& fit = summary.fit;
  return {{"objective", fit.objective},
          {"deepest_penetration", fit.deepest_penetration},
          {"within_limit", fit.within_limit},
          {"poses", fit.poses},
          {"device", fit.device},
          {"notice", fit.notice},
          {"seconds", summary.search_seconds},
          {"interrupted", fit.interrupted},
          {"out_of_time", fit.out_of_time}};
}

JsonObject proof_json(const FitSummary& summary) {
  const MapSummary& map = summary.clearance.map;
  return {{"device", map.device},
          {"notice", map.notice},
          {"seconds", summary.proof_seconds},
          {"device_seconds", map.device_seconds},
          {"host_seconds", map.host_seconds},
          {"unfinished", summary.unfinished}};
}

}  // namespace

std::string json(const FitSummary& summary) {
  const auto& [fit, clearance, map] = std::tie(summary.fit, summary.clearance, summary.clearance.map);
  const JsonObject object{
      {"implant", summary.implant},
      {"implant_index", fit.implant},
      {"implants", summary.implants},
      {"pose", fit.pose},
      {"moved", moved(summary.fit.movement)},
      {"sizes", sizes(summary)},
      {"objective", clearance.objective},
      {"largest_objective", largest_objective(clearance)},
      {"smallest_distance", clearance.smallest_distance},
      {"deepest_penetration", clearance.deepest_penetration},
      {"penetration_limit", summary.penetration_limit},
      {"proven_within_limit", clearance.proven_shallow},
      {"proven_too_deep", clearance.proven_too_deep},
      {"undecided", undecided_depths(clearance)},
      {"surface", summary.surface ? surface_json(*summary.surface) : JsonValue()},
      {"instrument", instrument_json(summary)},
      {"bound", bound_json(summary)},
      {"sides", sides_json(summary)},
      {"changes", changes_json(summary)},
      {"landmark_radius", summary.landmark_radius},
      {"contact", contacts_json(summary)},
      {"constraints", constraints_json(summary)},
      {"binding", binding_json(summary)},
      {"maximised", summary.maximised == FitObjective::size ? "size" : "fitness"},
      {"size", implant_size(fit.model)},
      {"finalists", finalists_json(summary)},
      {"areas", areas(summary)},
      {"points", map.points},
      {"device_verified", map.device_verified},
      {"host_verified", map.host_verified},
      {"wide", map.wide},
      {"largest_width", map.largest_width},
      {"tolerance", summary.tolerance},
      {"units", summary.units},
      {"search", search_json(summary)},
      {"proof", proof_json(summary)},
      {"interrupted", fit.interrupted},
      {"output", summary.output},
      {"map", summary.map},
      {"surface_map", summary.surface_map},
      {"certificate_file", summary.certificate_file},
      {"bound_certificate_file", summary.certified_upper ? summary.bound_certificate : std::string()},
      {"contact_certificate_file", summary.contact_certificate},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
