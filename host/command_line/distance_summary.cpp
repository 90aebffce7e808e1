/// The two forms of the answer for one pose.
#include "host/command_line/distance_summary.hpp"

#include <fmt/core.h>

#include <string_view>

#include "host/command_line/json_value.hpp"

namespace verisq::command_line {
namespace {

std::string_view word(Proximity proximity) {
  switch (proximity) {
    case Proximity::separated: return "separated";
    case Proximity::overlapping: return "overlapping";
    case Proximity::undecided: return "undecided";
  }
  return "";
}

std::string_view explanation(Proximity proximity) {
  switch (proximity) {
    case Proximity::separated: return "proven: no common point";
    case Proximity::overlapping: return "proven: a common point";
    case Proximity::undecided: return "touching, or nearly: neither a gap nor a common point is proven";
  }
  return "";
}

std::string_view explanation_of_uncertain(Proximity proximity) {
  switch (proximity) {
    case Proximity::separated: return "proven: no common point, whatever the uncertain numbers are";
    case Proximity::overlapping: return "proven: a common point, whatever the uncertain numbers are";
    case Proximity::undecided: return "neither is proven of all that the uncertain numbers allow";
  }
  return "";
}

std::string text_of(const Enclosure& e) {
  return fmt::format("[{:.17g}, {:.17g}]", e.lo, e.hi);
}

std::string text_of(const Point& x) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g})", x[0], x[1], x[2]);
}

std::string box_text(std::string_view name, const std::array<Enclosure, 3>& box) {
  return fmt::format("{:<19}x {}\n{:<19}y {}\n{:<19}z {}\n", name, text_of(box[0]), "", text_of(box[1]), "",
                     text_of(box[2]));
}

std::string readable(const PairCertificate& certificate) {
  std::string text;
  for (const auto& [a, b, vector, on_a, on_b] : certificate.separations) {
    text += fmt::format("certificate        primitives {} and {}: vector {}, point of A {}, point of B {}\n", a, b,
                        text_of(vector), text_of(on_a), text_of(on_b));
  }
  for (const auto& [a, b, cuts, planes] : certificate.divisions) {
    text += fmt::format("certificate        primitives {} and {}: {} plane{} between sections\n", a, b, planes.size(),
                        planes.size() == 1 ? "" : "s");
  }
  return text;
}

/// Each side as an array of its ends.
JsonValue json_of(const std::array<Enclosure, 3>& box) {
  JsonValue::Array sides;
  for (const Enclosure& side : box) sides.push_back(std::array{side.lo, side.hi});
  return sides;
}

JsonValue json_of(const PairCertificate& certificate) {
  JsonValue::Array separations;
  for (const auto& [a, b, vector, on_a, on_b] : certificate.separations) {
    separations.push_back(
        JsonObject{{"primitive_a", a}, {"primitive_b", b}, {"vector", vector}, {"on_a", on_a}, {"on_b", on_b}});
  }
  for (const auto& [a, b, cuts, planes] : certificate.divisions) {
    separations.push_back(JsonObject{{"primitive_a", a}, {"primitive_b", b}, {"planes", planes.size()}});
  }
  return separations;
}

/// A common point says more.
std::optional<std::array<Point, 2>> shown_near_points(const DistanceReport& report) {
  return report.common ? std::nullopt : report.near_points;
}

std::string_view status_word(const DistanceReport& report) {
  if (report.tightest) return "tightest";
  return is_verified(report) ? "verified" : "wide";
}

}  // namespace

std::string readable(const DistanceReport& report) {
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  auto text = fmt::format("distance           {}{}\n", text_of(report.distance), units);
  text += fmt::format("width              {:.3g}{}, tolerance {:.3g}{}{}\n", report.distance.width(), units,
                      report.tolerance, units, report.tightest ? ": the tightest" : "");
  text += fmt::format("proximity          {} ({})\n", word(report.proximity),
                      report.uncertain ? explanation_of_uncertain(report.proximity) : explanation(report.proximity));
  if (report.common) text += fmt::format("common point       {}\n", text_of(*report.common));
  if (report.closest) {
    text += box_text("closest point of A", report.closest->on_a) + box_text("closest point of B", report.closest->on_b);
    text += fmt::format("uniqueness         {}\n",
                        report.closest->unique ? "proven: exactly one pair of closest points, in these boxes"
                                               : "not proven: these boxes contain every pair of closest points");
  }
  if (const auto near = shown_near_points(report)) {
    const auto& [on_a, on_b] = *near;
    text += fmt::format("near point of A    {}\nnear point of B    {} in its own frame; {:.17g}{} apart at most\n",
                        text_of(on_a), text_of(on_b), report.distance.hi, units);
  }
  if (report.uncertain) text += "closest points     not enclosed, because the models are uncertain\n";
  if (report.searched) text += "closest points     not enclosed, because a model is bent or built by set operations\n";
  if (report.certified) text += fmt::format("certified          {}{}\n", text_of(*report.certified), units);
  return report.certificate ? text + readable(*report.certificate) : text;
}

std::string json(const DistanceReport& report) {
  JsonObject object{{"lo", report.distance.lo},
                    {"hi", report.distance.hi},
                    {"status", status_word(report)},
                    {"proximity", word(report.proximity)},
                    {"uncertain", report.uncertain},
                    {"searched", report.searched},
                    {"interrupted", report.interrupted},
                    {"closest_points", JsonValue()},
                    {"unique", report.closest && report.closest->unique},
                    {"near_points", JsonValue()},
                    {"witness", report.common},
                    {"units", report.units},
                    {"tolerance", report.tolerance}};
  if (report.closest) {
    object.set("closest_points",
               JsonObject{{"on_a", json_of(report.closest->on_a)}, {"on_b", json_of(report.closest->on_b)}});
  }
  if (const auto near = shown_near_points(report)) {
    object.set("near_points", JsonObject{{"on_a", (*near)[0]}, {"on_b", (*near)[1]}});
  }
  if (report.certified) object.set("certified", *report.certified);
  if (report.certificate) object.set("certificate", json_of(*report.certificate));
  return object.indented_text() + "\n";
}

}  // namespace verisq::command_line
