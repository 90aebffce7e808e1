/// Criterion, areas and claims are read one by one.
#include "host/files/fit_answer.hpp"

#include <fmt/format.h>

#include <functional>
#include <numeric>
#include <set>
#include <utility>

#include "host/files/certificate_fields.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

std::uint32_t read_area_index(const JsonValue& value, std::size_t areas) {
  const std::uint32_t index = read_index(value);
  if (index >= areas) value.fail(fmt::format("must be below {}, the number of areas", areas));
  return index;
}

Fitness read_criterion(const JsonValue& value) {
  value.check_keys({"target", "scale", "serves"});
  const Fitness fitness{nonnegative_number(value.at("target")), value.at("scale").number(),
                        read_claim(value.at("serves"))};
  if (!(fitness.scale > 0.0)) value.at("scale").fail("must be above 0");
  if (fitness.serves.lo > fitness.serves.hi) value.at("serves").fail("must have lo no larger than hi");
  return fitness;
}

std::vector<Area> read_claimed_areas(const JsonValue& value) {
  std::vector<Area> areas;
  std::set<std::string> names;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const JsonValue area = value.element(i);
    area.check_keys({"name", "weight"});
    areas.push_back({area.at("name").name(), nonnegative_number(area.at("weight"))});
    if (!names.insert(areas.back().name).second) area.at("name").fail("is the name of an area before");
  }
  return areas;
}

std::vector<ClearanceClaim> read_clearance_claims(const JsonValue& value) {
  std::vector<ClearanceClaim> claims;
  std::set<std::pair<std::string, std::string>> seen;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const JsonValue claim = value.element(i);
    claim.check_keys({"what", "area", "lo", "hi"});
    const auto area = claim.find("area");
    claims.push_back({claim.at("what").name(),
                      area ? area->name() : std::string(),
                      {claim.at("lo").number_or_infinity(), claim.at("hi").number_or_infinity()}});
    if (!seen.insert({claims.back().what, claims.back().area}).second) claim.fail("is claimed before");
  }
  if (claims.empty()) value.fail("must not be empty");
  return claims;
}

SurfaceSide read_surface_side(const JsonValue& value) {
  const std::string side = value.name();
  for (const SurfaceSide known : {SurfaceSide::inside, SurfaceSide::outside}) {
    if (side == to_string(known)) return known;
  }
  value.fail("must be inside or outside");
}

/// Missing: none.
std::vector<SideClaim> read_side_claims(const JsonValue& root) {
  std::vector<SideClaim> claims;
  const auto sides = root.find("sides");
  if (!sides) return claims;
  std::set<std::size_t> seen;
  for (std::size_t i = 0; i < sides->size(); ++i) {
    const JsonValue claim = sides->element(i);
    claim.check_keys({"primitive", "side"});
    claims.push_back({read_index(claim.at("primitive")), read_surface_side(claim.at("side"))});
    if (!seen.insert(claims.back().primitive).second) claim.fail("is of a primitive before");
  }
  return claims;
}

}  // namespace

std::vector<AreaRun> read_area_runs(const JsonValue& value, std::size_t areas) {
  constexpr std::uint64_t most_points = std::uint64_t{1} << 32U;
  std::vector<AreaRun> runs;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const JsonValue run = value.element(i);
    if (run.size() != 2) run.fail("must be an area's index and a number of points");
    runs.push_back({read_area_index(run.element(0), areas), read_index(run.element(1))});
    points += runs.back().points;
    if (points > most_points) run.fail(fmt::format("must leave no more than {} points in all", most_points));
  }
  return runs;
}

StatedTerms read_terms(const JsonValue& root) {
  StatedTerms terms{.fitness = read_criterion(root.at("criterion")),
                    .penetration_limit = nonnegative_number(root.at("penetration_limit")),
                    .areas = read_claimed_areas(root.at("areas")),
                    .area_runs = {}};
  terms.area_runs = read_area_runs(root.at("area_runs"), terms.areas.size());
  return terms;
}

FitAnswer read_fit(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "mesh", "units", "criterion", "penetration_limit", "areas", "area_runs",
                   "claims", "sides"});
  const JsonValue models = root.at("models");
  if (models.size() != 1) models.fail("must be an array of one model");
  return {.model = read_subject_file(models.element(0)),
          .mesh = read_subject_file(root.at("mesh")),
          .units = units_of(root),
          .terms = read_terms(root),
          .claims = read_clearance_claims(root.at("claims")),
          .sides = read_side_claims(root)};
}

std::uint64_t points_of(const StatedTerms& stated) {
  return points_of(stated.area_runs);
}

std::uint64_t points_of(std::span<const AreaRun> runs) {
  return std::transform_reduce(runs.begin(), runs.end(), std::uint64_t{0}, std::plus<>(),
                               [](const AreaRun& run) { return run.points; });
}

std::vector<AreaRun> runs_of(std::span<const std::uint32_t> area_of) {
  std::vector<AreaRun> runs;
  for (const std::uint32_t area : area_of) {
    if (runs.empty() || runs.back().area != area) runs.push_back({area, 0});
    ++runs.back().points;
  }
  return runs;
}

std::vector<std::uint32_t> areas_of(std::span<const AreaRun> runs) {
  std::vector<std::uint32_t> areas;
  areas.reserve(points_of(runs));
  for (const auto& [area, points] : runs) areas.insert(areas.end(), points, area);
  return areas;
}

ClearanceTerms terms_of(const StatedTerms& stated) {
  return {stated.fitness, stated.penetration_limit, stated.areas, areas_of(stated.area_runs)};
}

}  // namespace verisq
