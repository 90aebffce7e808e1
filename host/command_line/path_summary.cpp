/// The two forms of the answer along a path.
#include "host/command_line/path_summary.hpp"

#include <fmt/core.h>

#include <string_view>

#include "host/command_line/json_value.hpp"

namespace verisq::command_line {
namespace {

std::string_view word(PathProximity proximity) {
  switch (proximity) {
    case PathProximity::apart: return "apart";
    case PathProximity::meeting: return "meeting";
    case PathProximity::undecided: return "undecided";
  }
  return "";
}

std::string_view explanation(const PathReport& report) {
  switch (report.found.proximity) {
    case PathProximity::apart: return "proven: no common point at any time, between the poses neither";
    case PathProximity::meeting: return "proven: a common point at some time";
    case PathProximity::undecided: break;
  }
  return report.found.interrupted ? "interrupted: neither a gap all the way nor a common point is proven"
                                  : "touching, or nearly: neither a gap all the way nor a common point is proven";
}

/// Of a clearance that was asked for.
std::string_view verdict_on_clearance(const PathReport& report) {
  if (is_free(report)) return "proven at all times";
  return report.found.smallest.hi < report.clearance ? "proven NOT to be kept" : "open";
}

}  // namespace

bool is_free(const PathReport& report) {
  if (report.certified && !(report.certified->smallest.lo > 0.0 && report.certified->smallest.lo >= report.clearance))
    return false;
  return report.found.proximity == PathProximity::apart && report.found.smallest.lo >= report.clearance;
}

std::string readable(const PathReport& report) {
  const PathDistance& found = report.found;
  const std::string units = report.units.empty() ? std::string() : " " + report.units;
  std::string text = fmt::format("path               {} pose{}, times 0 to {}; looked at {} moments\n", report.poses,
                                 report.poses == 1 ? "" : "s", report.poses - 1, found.moments);
  text += fmt::format("smallest distance  [{:.17g}, {:.17g}]{} of all times; at most the upper end at time {:.17g}\n",
                      found.smallest.lo, found.smallest.hi, units, found.smallest_at);
  text += fmt::format("width              {:.3g}{}, tolerance {:.3g}{}\n", found.smallest.width(), units,
                      report.tolerance, units);
  text += fmt::format("proximity          {} ({})\n", word(found.proximity), explanation(report));
  if (found.meet_at) {
    text += fmt::format("first contact      in [{:.17g}, {:.17g}]: no common point before, one at the later time\n",
                        found.apart_before, *found.meet_at);
  }
  if (report.clearance > 0.0)
    text += fmt::format("clearance          {:.17g}{}: {}\n", report.clearance, units, verdict_on_clearance(report));
  text += fmt::format("the way            {}\n", is_free(report) ? "proven free" : "NOT proven free");
  if (report.certified) {
    text += fmt::format("certificate        {}: [{:.17g}, {:.17g}]{} of all times\n", report.certificate,
                        report.certified->smallest.lo, report.certified->smallest.hi, units);
    if (const auto& contact = report.certified->first_contact)
      text += fmt::format("  first contact    in [{:.17g}, {:.17g}]\n", contact->lo, contact->hi);
  }
  return text;
}

std::string json(const PathReport& report) {
  const PathDistance& found = report.found;
  const std::optional<PathClaims>& certified = report.certified;
  const std::optional<Enclosure> contact = certified ? certified->first_contact : std::nullopt;
  return JsonObject{{"lo", found.smallest.lo},
                    {"hi", found.smallest.hi},
                    {"smallest_at", found.smallest_at},
                    {"proximity", word(found.proximity)},
                    {"apart_before", found.apart_before},
                    {"meet_at", found.meet_at},
                    {"free", is_free(report)},
                    {"clearance", report.clearance},
                    {"status", found.reached ? "verified" : "wide"},
                    {"interrupted", found.interrupted},
                    {"poses", report.poses},
                    {"moments", found.moments},
                    {"units", report.units},
                    {"tolerance", report.tolerance},
                    {"certified", certified ? JsonValue(certified->smallest) : JsonValue()},
                    {"certified_contact", contact ? JsonValue(*contact) : JsonValue()},
                    {"certificate", certified ? JsonValue(report.certificate) : JsonValue()}}
             .indented_text() +
         "\n";
}

}  // namespace verisq::command_line
