/// Separations, divisions by planes, and points.
#include "host/files/pair_proof.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "host/files/certificate_fields.hpp"

namespace verisq {
namespace {

constexpr std::string_view letters = ".ab";  // of SectionCut

/// One after the other, each of two primitives of its own.
template <class Read>
void read_each(const JsonValue& values, const Read& read) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const JsonValue value = values.element(i);
    const auto& found = read(value);
    if (!seen.insert({found.primitive_a, found.primitive_b}).second) {
      value.fail("these two primitives have been separated before");
    }
  }
}

Separation read_separation(const JsonValue& value) {
  value.check_keys({"primitive_a", "primitive_b", "vector", "on_a", "on_b"});
  return {read_index(value.at("primitive_a")), read_index(value.at("primitive_b")),
          finite_numbers<3>(value.at("vector")), finite_numbers<3>(value.at("on_a")),
          finite_numbers<3>(value.at("on_b"))};
}

std::vector<SectionCut> read_cuts(const JsonValue& value) {
  std::vector<SectionCut> cuts;
  for (const char letter : value.text()) {
    const std::size_t index = letters.find(letter);
    if (index == std::string_view::npos) value.fail("must consist of the letters a, b and .");
    cuts.push_back(static_cast<SectionCut>(index));
  }
  return cuts;
}

SectionPlane read_plane(const JsonValue& value) {
  const std::array<double, 5> numbers = finite_numbers<5>(value);
  return {{numbers[0], numbers[1], numbers[2]}, numbers[3], numbers[4]};
}

DividedSeparation read_division(const JsonValue& value) {
  value.check_keys({"primitive_a", "primitive_b", "cuts", "planes"});
  DividedSeparation division{
      read_index(value.at("primitive_a")), read_index(value.at("primitive_b")), read_cuts(value.at("cuts")), {}};
  const JsonValue planes = value.at("planes");
  if (const auto expected = std::ranges::count(division.cuts, SectionCut::none);
      planes.size() != static_cast<std::size_t>(expected)) {
    planes.fail(fmt::format("must be {} planes, one for each . of the cuts", expected));
  }
  for (std::size_t i = 0; i < planes.size(); ++i) division.planes.push_back(read_plane(planes.element(i)));
  return division;
}

std::vector<EnclosingBall> read_balls(const JsonValue& proof, std::string_view key) {
  const auto values = proof.find(key);
  if (!values) return {};
  std::vector<EnclosingBall> balls;
  std::set<std::uint32_t> seen;
  for (std::size_t i = 0; i < values->size(); ++i) {
    const JsonValue value = values->element(i);
    value.check_keys({"primitive", "centre", "multiplier", "distance", "normals", "escape", "witness", "cover"});
    balls.push_back({read_index(value.at("primitive")), finite_numbers<3>(value.at("centre")),
                     value.at("multiplier").number(), value.at("distance").number(), read_certificate(value)});
    if (!seen.insert(balls.back().primitive).second) value.fail("this primitive has a ball before");
  }
  return balls;
}

std::vector<SurroundedPrimitive> read_covers(const JsonValue& proof, std::string_view key) {
  const auto values = proof.find(key);
  if (!values) return {};
  std::vector<SurroundedPrimitive> result;
  std::set<std::uint32_t> seen;
  for (std::size_t i = 0; i < values->size(); ++i) {
    const JsonValue value = values->element(i);
    value.check_keys({"primitive", "distance", "cover"});
    result.push_back({read_index(value.at("primitive")), value.at("distance").number(), read_cover(value.at("cover"))});
    if (!seen.insert(result.back().primitive).second) value.fail("this primitive has a cover before");
  }
  return result;
}

}  // namespace

PairCertificate read_pair_proof(const JsonValue& value) {
  value.check_keys({"separations", "divisions", "balls_a", "balls_b", "covers_a", "covers_b", "near_points", "common"});
  PairCertificate result;
  read_each(value.at("separations"), [&](const JsonValue& each) -> const Separation& {
    return result.separations.emplace_back(read_separation(each));
  });
  if (const auto divisions = value.find("divisions")) {
    read_each(*divisions, [&](const JsonValue& each) -> const DividedSeparation& {
      return result.divisions.emplace_back(read_division(each));
    });
  }
  result.balls_a = read_balls(value, "balls_a");
  result.balls_b = read_balls(value, "balls_b");
  result.covers_a = read_covers(value, "covers_a");
  result.covers_b = read_covers(value, "covers_b");
  if (const auto near = value.find("near_points")) {
    near->check_keys({"on_a", "on_b"});
    result.near_points = {finite_numbers<3>(near->at("on_a")), finite_numbers<3>(near->at("on_b"))};
  }
  if (const auto common = value.find("common")) result.common = finite_numbers<3>(*common);
  return result;
}

std::string text_of(const std::vector<SectionCut>& cuts) {
  std::string text;
  for (const SectionCut cut : cuts) text += letters[static_cast<std::size_t>(cut)];
  return text;
}

}  // namespace verisq
