/// Counts, and the two forms of the summary.
#include "host/command_line/insert_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/json_value.hpp"

namespace verisq::command_line {

namespace {

Enclosure penetration(const Enclosure& distance) {
  return {std::max(0.0, -distance.hi), std::max(0.0, -distance.lo)};
}

std::string readable_surface(const InsertReport& report) {
  if (!report.surface) return {};
  const MeshClearance& surface = *report.surface;
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  return fmt::format("whole surface        deepest penetration {}{}\n",
                     outward_digits(penetration(surface.smallest_distance)), units) +
         fmt::format("  proven cut         {} triangles\n", surface.proven_too_deep) +
         fmt::format("  proven untouched   {} triangles\n", surface.proven_within) +
         fmt::format("  undecided          {} triangles\n", surface.undecided) +
         fmt::format("  samples            {}, {:.3g} s\n", surface.samples, report.surface_seconds);
}

std::string readable_volume(const InsertReport& report) {
  if (!report.removed) return {};
  const RemovedVolume& removed = *report.removed;
  const auto units = report.units.empty() ? std::string() : " " + report.units + "^3";
  const auto rims = std::accumulate(removed.rims.begin(), removed.rims.end(), std::size_t{0});
  return fmt::format("removed bone         {}{}{}\n", outward_digits(removed.volume), units,
                     removed.within_tolerance ? "" : ", wider than asked for") +
         (removed.volume.hi > 0.0 ? "" : "  no bone lies in the implant's way: are both in the same coordinates?\n") +
         fmt::format("  width asked for    {:.3g} of its lower end{}\n", report.volume_tolerance,
                     report.least_volume_tolerance > 0.0
                         ? fmt::format(", or {:.3g}{}", report.least_volume_tolerance, units)
                         : std::string()) +
         fmt::format("  closed over        {} {}\n", rims, rims == 1 ? "rim" : "rims") +
         fmt::format("  cubes              {}, {:.3g} s\n", removed.cubes, report.volume_seconds);
}

std::string numbers(const Point& v) {
  return fmt::format("{:.17g}, {:.17g}, {:.17g}", v[0], v[1], v[2]);
}

std::string readable_way(const InsertReport& report) {
  if (!report.way) return {};
  auto text = fmt::format("way in               along ({}), turning by {:.17g} degrees\n",
                          numbers(report.way->direction), report.way->turn_degrees);
  if (!report.search) return text;
  const auto units = report.units.empty() ? std::string() : " " + report.units + "^3";
  text += fmt::format("  off the given one  {:.4g} degrees\n", report.degrees_off);
  text += fmt::format("  the given one      takes away {}{}\n", outward_digits(report.search->of_middle), units);
  text += fmt::format("  best of            {} ways tried, {} of them proven worse\n", report.search->tried,
                      report.search->worse);
  return text;
}

std::optional<JsonObject> json_of_way(const InsertReport& report) {
  if (!report.way) return std::nullopt;
  return JsonObject{
      {"direction", report.way->direction}, {"length", report.way->length}, {"turn_degrees", report.way->turn_degrees}};
}

std::optional<JsonObject> json_of_search(const InsertReport& report) {
  if (!report.search) return std::nullopt;
  return JsonObject{{"removed_volume_of_given", report.search->of_middle},
                    {"degrees_off_given", report.degrees_off},
                    {"tried", report.search->tried},
                    {"proven_worse", report.search->worse}};
}

std::string subjects_of_certificate(const InsertReport& report) {
  if (!report.certified_points) return "the removed bone alone";
  std::string subjects = report.certified_surface ? "the distances of the points, and of the whole surface"
                                                  : "the distances of the points";
  if (report.certified_volume) return subjects + ", and of the removed bone";
  return report.certified_surface ? subjects : subjects + " alone";
}

bool is_surface_certified_less(const InsertReport& report) {
  return report.certified_surface && report.certified_surface->width() > report.surface->smallest_distance.width();
}

bool is_volume_certified_less(const InsertReport& report) {
  return report.certified_volume && report.certified_volume->width() > report.removed->volume.width();
}

}  // namespace

void count(const Insertion& insertion, InsertReport& report) {
  report.summary = insertion.summary;
  for (const MapResult& row : insertion.rows) {
    if (row.distance.hi < 0.0)
      ++report.proven_cut;
    else if (row.distance.lo >= 0.0)
      ++report.proven_untouched;
    else
      ++report.undecided;
  }
  report.deepest_penetration = penetration({report.summary.minimum_lo, report.summary.minimum_hi});
}

bool InsertReport::interrupted() const {
  return summary.interrupted || (surface && surface->interrupted) || (removed && removed->interrupted) ||
         (search && search->interrupted);
}

std::string readable(const InsertReport& report) {
  const auto& summary = report.summary;
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  const auto& [lo, hi] = report.deepest_penetration;
  auto text = fmt::format("points               {}\n", summary.points);
  text += fmt::format("  proven cut         {}\n", report.proven_cut);
  text += fmt::format("  proven untouched   {}\n", report.proven_untouched);
  text += fmt::format("  undecided          {}\n", report.undecided);
  text += fmt::format("deepest penetration  [{}, {}]{}\n", lo, hi, units);
  text += fmt::format("smallest distance    [{}, {}]{}\n", summary.minimum_lo, summary.minimum_hi, units);
  text += readable_surface(report);
  text += readable_volume(report);
  text += readable_way(report);
  text += fmt::format("poses of the path    {}, and all between them\n", report.poses);
  text += fmt::format("device               {}\n", summary.device);
  text += fmt::format("tolerance            {:.3g}{}\n", report.tolerance, units);
  text += fmt::format("  device-verified    {}\n", summary.device_verified);
  text += fmt::format("  host-verified      {}\n", summary.host_verified);
  text += fmt::format("  wide               {}\n", summary.wide);
  text += fmt::format("largest width        {}{}\n", upper_digits(summary.largest_width), units);
  text += fmt::format("time                 {:.3g} s (device {:.3g} s, host proofs {:.3g} s)\n", report.seconds,
                      summary.device_seconds, summary.host_seconds);
  text += fmt::format("map                  {}\n", report.output.empty() ? "not kept" : report.output);
  if (!report.certificate.empty()) {
    text += fmt::format("certificate          {}, of {}\n", report.certificate, subjects_of_certificate(report));
    if (report.looser_certificates > 0)
      text += fmt::format("  proves less        of {} points than the map says\n", report.looser_certificates);
    if (is_surface_certified_less(report))
      text += fmt::format("  proves less        of the whole surface: smallest distance {}\n",
                          outward_digits(*report.certified_surface));
    if (is_volume_certified_less(report))
      text += fmt::format("  proves less        of the removed bone: {}\n", outward_digits(*report.certified_volume));
  }
  if (!report.page.empty()) text += fmt::format("report               {}\n", report.page);
  if (!report.picture.empty()) text += fmt::format("picture              {}\n", report.picture);
  return text;
}

std::vector<ReportLine> report_lines(const InsertReport& report) {
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  std::vector<ReportLine> lines;
  if (report.removed)
    lines.push_back({"removed bone", outward_digits(report.removed->volume) + (units.empty() ? "" : units + "^3")});
  const Enclosure& deepest = report.surface ? report.surface->smallest_distance
                                            : Enclosure{report.summary.minimum_lo, report.summary.minimum_hi};
  lines.push_back({report.surface ? "deepest penetration, whole surface" : "deepest penetration, vertices",
                   outward_digits(penetration(deepest)) + units});
  if (report.way) {
    lines.push_back({"way in", fmt::format("along ({:.6g}), {:.6g}{} long, turning by {:.4g} degrees",
                                           fmt::join(report.way->direction, ", "), report.way->length, units,
                                           report.way->turn_degrees)});
  }
  if (report.search) {
    lines.push_back({"  best of", fmt::format("{} ways tried, {} of them proven worse", report.search->tried,
                                              report.search->worse)});
    lines.push_back(
        {"  the given one takes away", outward_digits(report.search->of_middle) + (units.empty() ? "" : units + "^3")});
  }
  lines.push_back({"vertices proven cut", fmt::format("{}", report.proven_cut)});
  lines.push_back({"vertices proven untouched", fmt::format("{}", report.proven_untouched)});
  lines.push_back({"undecided", fmt::format("{}", report.undecided)});
  lines.push_back({"wide", fmt::format("{}", report.summary.wide)});
  lines.push_back({"tolerance", fmt::format("{}", report.tolerance) + units});
  lines.push_back({"device", report.summary.device});
  return lines;
}

std::string json(const InsertReport& report) {
  const auto& summary = report.summary;
  std::optional<JsonObject> surface;
  if (report.surface) {
    surface = JsonObject{{"deepest_penetration", penetration(report.surface->smallest_distance)},
                         {"smallest_distance", report.surface->smallest_distance},
                         {"proven_cut", report.surface->proven_too_deep},
                         {"proven_untouched", report.surface->proven_within},
                         {"undecided", report.surface->undecided},
                         {"samples", report.surface->samples},
                         {"seconds", report.surface_seconds}};
  }
  std::optional<Enclosure> volume;
  std::optional<JsonObject> work;
  if (report.removed) {
    volume = report.removed->volume;
    work = JsonObject{{"within_tolerance", report.removed->within_tolerance},
                      {"relative_tolerance", report.volume_tolerance},
                      {"tolerance", report.least_volume_tolerance},
                      {"rims", report.removed->rims},
                      {"cubes", report.removed->cubes},
                      {"seconds", report.volume_seconds}};
  }
  JsonObject object{
      {"points", summary.points},
      {"proven_cut", report.proven_cut},
      {"proven_untouched", report.proven_untouched},
      {"undecided", report.undecided},
      {"deepest_penetration", report.deepest_penetration},
      {"smallest_distance", Enclosure{summary.minimum_lo, summary.minimum_hi}},
      {"whole_surface", surface},
      {"removed_volume", volume},
      {"removed_volume_proof", work},
      {"way", json_of_way(report)},
      {"way_search", json_of_search(report)},
      {"poses", report.poses},
      {"device_verified", summary.device_verified},
      {"host_verified", summary.host_verified},
      {"wide", summary.wide},
      {"device", summary.device},
      {"notice", summary.notice},
      {"units", report.units},
      {"tolerance", report.tolerance},
      {"largest_width", summary.largest_width},
      {"device_seconds", summary.device_seconds},
      {"host_seconds", summary.host_seconds},
      {"seconds", report.seconds},
      {"interrupted", report.interrupted()},
      {"output", report.output},
  };
  if (!report.certificate.empty()) {
    object.set("certificate", report.certificate);
    object.set("looser_certificates", report.looser_certificates);
    object.set("certified_surface", report.certified_surface ? JsonValue(*report.certified_surface) : JsonValue());
    object.set("certified_volume", report.certified_volume ? JsonValue(*report.certified_volume) : JsonValue());
  }
  if (!report.page.empty()) object.set("report", report.page);
  if (!report.picture.empty()) object.set("png", report.picture);
  return object.text() + "\n";
}

}  // namespace verisq::command_line
