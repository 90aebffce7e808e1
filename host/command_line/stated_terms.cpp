/// Numbers as the file has them.
#include "host/command_line/stated_terms.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/command_line/check_summary.hpp"

namespace verisq::command_line {
namespace {

std::vector<std::uint64_t> points_by_area(const StatedTerms& terms) {
  std::vector<std::uint64_t> points(terms.areas.size(), 0);
  for (const AreaRun& run : terms.area_runs) points[run.area] += run.points;
  return points;
}

}  // namespace

std::string with_units(const std::string& number, const std::string& units) {
  return units.empty() ? number : fmt::format("{} {}", number, units);
}

std::string criterion_in_words(const StatedTerms& terms, const std::string& units) {
  std::string text = fmt::format(
      "criterion            distances in {} serve; F adds up weight times f, which is 1 at "
      "{} and 1/2 at {} from there\n",
      with_units(exact_text(terms.fitness.serves), units), with_units(fmt::format("{}", terms.fitness.target), units),
      with_units(fmt::format("{}", terms.fitness.scale), units));
  const std::vector<std::uint64_t> points = points_by_area(terms);
  for (std::size_t i = 0; i < terms.areas.size(); ++i) {
    text += fmt::format("area {:<15} weight {}, {} vertices, which the certificate names\n", terms.areas[i].name,
                        terms.areas[i].weight, points[i]);
  }
  return text;
}

JsonValue areas_of(const StatedTerms& terms) {
  JsonValue::Array areas;
  const std::vector<std::uint64_t> points = points_by_area(terms);
  for (std::size_t i = 0; i < terms.areas.size(); ++i) {
    areas.push_back(
        JsonObject{{"name", terms.areas[i].name}, {"weight", terms.areas[i].weight}, {"points", points[i]}});
  }
  return areas;
}

}  // namespace verisq::command_line
