/// Reads two models and a pose, encloses their distance, prints it as text or JSON.
#include "host/command_line/distance_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/model_distance.hpp>
#include <verisq/model_file.hpp>
#include <verisq/signed_distance.hpp>

namespace verisq::command_line {
namespace {

constexpr double default_relative_tolerance = 1e-6;  // of the larger bounding radius

constexpr const char* closing_words =
    "The distance is [lo, hi], which contains the exact distance of A and of B moved by the pose: 0 where they meet. "
    "The\n"
    "closest points lie in the printed boxes, in the frame of A. \"undecided\": the models touch, or nearly, so that "
    "neither\n"
    "a gap nor a common point is proven.\n"
    "\n"
    "Exit status: 0 the enclosure is at most the tolerance wide, 3 it is wider, 2 bad usage or input.\n"
    "\n"
    "Examples:\n"
    "  verisq distance stem.json cup.json\n"
    "  verisq distance stem.json cup.json --pose 0,0,12.5,1,0,0,0 --json";

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

std::optional<double> finite_number(std::string_view text) {
  double value = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

double parse_tolerance(const std::string& text) {
  const auto value = finite_number(text);
  if (!value || *value < 0.0) refuse(fmt::format("--tol: {} is not a finite number of at least 0", text));
  return *value;
}

/// "tx,ty,tz,qw,qx,qy,qz"
Pose parse_pose(const std::string& text) {
  std::vector<double> numbers;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const auto number = finite_number(rest.substr(0, comma));
    if (!number) refuse(fmt::format("--pose: '{}' is not a finite number", rest.substr(0, comma)));
    numbers.push_back(*number);
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  if (numbers.size() != 7) {
    refuse(fmt::format("--pose: {} numbers where 7 are needed: tx,ty,tz,qw,qx,qy,qz", numbers.size()));
  }
  const Pose pose{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5], numbers[6]}};
  if (std::ranges::all_of(pose.quaternion, [](double q) { return q == 0.0; })) {
    refuse(fmt::format("--pose: {} has a zero quaternion", text));
  }
  return pose;
}

double default_tolerance(const Model& a, const Model& b) {
  const double tolerance = default_relative_tolerance * std::max(bounding_radius(a), bounding_radius(b));
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse("--tol: give one, because the size of the models overflows");
  return tolerance;
}

/// Lengths of two models can be compared only in one unit.
std::string common_units(const Model& a, const Model& b, const DistanceArguments& arguments) {
  if (!a.units.empty() && !b.units.empty() && a.units != b.units) {
    refuse(fmt::format("{}: units {} differ from {} of {}", arguments.model_b, b.units, a.units, arguments.model_a));
  }
  return a.units.empty() ? b.units : a.units;
}

struct DistanceReport {
  ModelDistance found;
  std::optional<ClosestPoints> closest;
  std::string units;
  double tolerance;
  bool with_certificate;
};

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
  return text;
}

std::string readable(const DistanceReport& report) {
  const auto& [distance, proximity, certificate] = report.found;
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  auto text = fmt::format("distance           {}{}\n", text_of(distance), units);
  text += fmt::format("width              {:.3g}{}, tolerance {:.3g}{}\n", distance.width(), units, report.tolerance,
                      units);
  text += fmt::format("proximity          {} ({})\n", word(proximity), explanation(proximity));
  if (certificate.common) text += fmt::format("common point       {}\n", text_of(*certificate.common));
  if (report.closest) {
    text += box_text("closest point of A", report.closest->on_a) + box_text("closest point of B", report.closest->on_b);
    text += fmt::format("uniqueness         {}\n",
                        report.closest->unique ? "proven: exactly one pair of closest points, in these boxes"
                                               : "not proven: these boxes contain every pair of closest points");
  }
  return report.with_certificate ? text + readable(certificate) : text;
}

nlohmann::ordered_json json_of(const std::array<Enclosure, 3>& box) {
  auto sides = nlohmann::ordered_json::array();
  for (const Enclosure& side : box) sides.push_back({side.lo, side.hi});
  return sides;
}

nlohmann::ordered_json json_of(const PairCertificate& certificate) {
  auto separations = nlohmann::ordered_json::array();
  for (const auto& [a, b, vector, on_a, on_b] : certificate.separations) {
    separations.push_back({{"primitive_a", a}, {"primitive_b", b}, {"vector", vector}, {"on_a", on_a}, {"on_b", on_b}});
  }
  return separations;
}

std::string json(const DistanceReport& report) {
  const auto& [distance, proximity, certificate] = report.found;
  nlohmann::ordered_json object{{"lo", distance.lo},
                                {"hi", distance.hi},
                                {"proximity", word(proximity)},
                                {"closest_points", nullptr},
                                {"unique", report.closest && report.closest->unique},
                                {"witness", nullptr},
                                {"units", report.units},
                                {"tolerance", report.tolerance}};
  if (report.closest) {
    object["closest_points"] = {{"on_a", json_of(report.closest->on_a)}, {"on_b", json_of(report.closest->on_b)}};
  }
  if (certificate.common) object["witness"] = *certificate.common;
  if (report.with_certificate) object["certificate"] = json_of(certificate);
  return object.dump(2) + "\n";
}

}  // namespace

const CLI::App& declare_distance(CLI::App& program, DistanceArguments& arguments) {
  CLI::App& distance = *program.add_subcommand("distance", "Enclose the distance of two models, and closest points");
  distance.footer(closing_words);
  distance.add_option("A", arguments.model_a, "Model file (verisq-model/1)")
      ->required()
      ->option_text("A.json REQUIRED");
  distance.add_option("B", arguments.model_b, "Model file")->required()->option_text("B.json REQUIRED");
  distance.add_option("--pose", arguments.pose, "Moves B: translation and quaternion of any length")
      ->option_text("tx,ty,tz,qw,qx,qy,qz");
  distance
      .add_option("--tol", arguments.tolerance,
                  "Width up to which the enclosure is called verified, in model units (default: 1e-6 of the larger "
                  "bounding radius)")
      ->option_text("T");
  distance.add_flag("--json", arguments.json, "Print one JSON object");
  distance.add_flag("--certificate", arguments.certificate, "Print what proves the enclosure again");
  return distance;
}

ExitStatus run_distance(const DistanceArguments& arguments) {
  const Pose pose = arguments.pose ? parse_pose(*arguments.pose) : Pose{};
  std::optional<double> tolerance;
  if (arguments.tolerance) tolerance = parse_tolerance(*arguments.tolerance);
  const Model a = read_model(arguments.model_a);
  const Model b = read_model(arguments.model_b);
  const PairDistance pair(a, b);
  const ModelDistance found = pair(pose);
  const DistanceReport report{found, pair.closest_points(found, pose), common_units(a, b, arguments),
                              tolerance ? *tolerance : default_tolerance(a, b), arguments.certificate};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return verified(found.distance, report.tolerance) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
