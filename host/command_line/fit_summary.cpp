/// The forms of the summary.
#include "host/command_line/fit_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/progress_bar.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq::command_line {
namespace {

using Lines = std::vector<ReportLine>;

std::string units_of(const FitSummary& summary) {
  return summary.units.empty() ? std::string() : " " + summary.units;
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
  Lines lines{{"implant", summary.implant},
              {"translation", numbers(pose.translation) + units_of(summary)},
              {"quaternion", numbers(pose.quaternion)}};
  if (!summary.sized) return lines;
  for (const Primitive& primitive : summary.fit.model.primitives) {
    lines.push_back({"semi-axes", fmt::format("{} {}{}", primitive.name, numbers(primitive.superquadric.semi_axes),
                                              units_of(summary))});
  }
  return lines;
}

Lines surface_lines(const MeshClearance& surface, const std::string& units) {
  return {{"whole surface", fmt::format("smallest distance {}{}", outward_digits(surface.smallest_distance), units)},
          {"  proven within", fmt::format("{} triangles", surface.proven_within)},
          {"  proven too deep", fmt::format("{} triangles", surface.proven_too_deep)},
          {"  undecided", fmt::format("{} triangles", surface.undecided)}};
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
  return lines;
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
      text += fmt::format("; smallest distance {}{}", outward_digits(area.smallest_distance), units_of(summary));
    }
    lines.push_back({"area " + area.area.name, text});
  }
  return lines;
}

Lines run_lines(const FitSummary& summary) {
  const auto& [fit, clearance] = std::tie(summary.fit, summary.clearance);
  Lines lines{{"search", fmt::format("{:.3g} s on {}, {} poses", summary.search_seconds, fit.device,
                                     with_prefix(static_cast<double>(fit.poses)))},
              {"proof", fmt::format("{:.3g} s on {} (device {:.3g} s, host proofs {:.3g} s)", summary.proof_seconds,
                                    clearance.map.device, clearance.map.device_seconds, clearance.map.host_seconds)},
              {"fitted model", summary.output}};
  if (!summary.map.empty()) lines.push_back({"map", summary.map});
  return lines;
}

Lines joined(std::initializer_list<Lines> parts) {
  Lines lines;
  for (const Lines& part : parts) lines.insert(lines.end(), part.begin(), part.end());
  return lines;
}

std::string text_of(const Lines& lines) {
  std::string text;
  for (const auto& [label, value] : lines) text += fmt::format("{:<21}{}\n", label, value);
  return text;
}

std::string area_table(const FitSummary& summary) {
  std::size_t widest = 4;
  for (const AreaClearance& area : summary.clearance.areas) widest = std::max(widest, area.area.name.size());
  std::string text = fmt::format("\n{:<{}}{:>10}{:>10}{:>10}{:>10}{:>11}  smallest distance\n", "area", widest,
                                 "weight", "points", "within", "outside", "undecided");
  for (const AreaClearance& area : summary.clearance.areas) {
    text += fmt::format("{:<{}}{:>10.6g}{:>10}{:>10}{:>10}{:>11}  {}\n", area.area.name, widest, area.area.weight,
                        area.points, percentage(area.proven_within, area.points),
                        percentage_up(area.proven_outside, area.points), percentage_up(area.undecided, area.points),
                        area.points > 0 ? outward_digits(area.smallest_distance) + units_of(summary) : "-");
  }
  return text + "\n";
}

JsonValue sizes(const FitSummary& summary) {
  JsonValue::Array sizes;
  for (const Primitive& primitive : summary.fit.model.primitives) {
    sizes.push_back(JsonObject{{"name", primitive.name}, {"semi_axes", primitive.superquadric.semi_axes}});
  }
  return sizes;
}

JsonObject surface_json(const MeshClearance& surface) {
  return {{"smallest_distance", surface.smallest_distance},
          {"proven_within_limit", surface.proven_within},
          {"proven_too_deep", surface.proven_too_deep},
          {"undecided", surface.undecided}};
}

JsonValue areas(const FitSummary& summary) {
  JsonValue::Array areas;
  for (const AreaClearance& area : summary.clearance.areas) {
    areas.push_back(JsonObject{{"name", area.area.name},
                               {"weight", area.area.weight},
                               {"points", area.points},
                               {"proven_within", area.proven_within},
                               {"proven_outside", area.proven_outside},
                               {"undecided", area.undecided},
                               {"smallest_distance", area.points > 0 ? area.smallest_distance : JsonValue()}});
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

std::vector<ReportLine> report_lines(const FitSummary& summary) {
  return joined({proven_lines(summary), area_lines(summary), pose_lines(summary), point_lines(summary)});
}

std::string readable(const FitSummary& summary) {
  return text_of(joined({pose_lines(summary), proven_lines(summary), point_lines(summary)})) + area_table(summary) +
         text_of(run_lines(summary));
}

std::string json(const FitSummary& summary) {
  const auto& [fit, clearance, map] = std::tie(summary.fit, summary.clearance, summary.clearance.map);
  const JsonObject object{
      {"implant", summary.implant},
      {"implant_index", fit.implant},
      {"implants", summary.implants},
      {"pose", JsonObject{{"translation", fit.pose.translation}, {"quaternion", fit.pose.quaternion}}},
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
      {"areas", areas(summary)},
      {"points", map.points},
      {"device_verified", map.device_verified},
      {"host_verified", map.host_verified},
      {"wide", map.wide},
      {"largest_width", map.largest_width},
      {"tolerance", summary.tolerance},
      {"units", summary.units},
      {"search", JsonObject{{"objective", fit.objective},
                            {"deepest_penetration", fit.deepest_penetration},
                            {"within_limit", fit.within_limit},
                            {"poses", fit.poses},
                            {"device", fit.device},
                            {"notice", fit.notice},
                            {"seconds", summary.search_seconds},
                            {"interrupted", fit.interrupted}}},
      {"proof", JsonObject{{"device", map.device},
                           {"notice", map.notice},
                           {"seconds", summary.proof_seconds},
                           {"device_seconds", map.device_seconds},
                           {"host_seconds", map.host_seconds}}},
      {"interrupted", fit.interrupted},
      {"output", summary.output},
      {"map", summary.map},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
