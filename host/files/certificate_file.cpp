/// The certificate format `verisq-certificate/1`: what docs/formats.md §9 accepts and refuses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <utility>
#include <verisq/certificate_file.hpp>

#include "host/files/certificate_fields.hpp"
#include "host/files/certificate_size.hpp"
#include "host/files/deviation_answer.hpp"
#include "host/files/equilibrium_answer.hpp"
#include "host/files/features_answer.hpp"
#include "host/files/input_file.hpp"
#include "host/files/insertion_answer.hpp"
#include "host/files/json_document.hpp"
#include "host/files/pair_proof.hpp"
#include "host/files/path_answer.hpp"
#include "host/files/sha256.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

constexpr std::string_view certificate_format = "verisq-certificate/1";

/// Of the kind that it returns.
std::string checked_kind(const JsonValue& root) {
  if (!root.json().is_object()) root.fail("must be an object");
  if (const JsonValue format = root.at("format"); format.text() != certificate_format) {
    format.fail(fmt::format("must be \"{}\"", certificate_format));
  }
  return root.at("kind").text();
}

PosedAnswer read_posed(const JsonValue& value) {
  return {read_pose_object(value.at("pose")), read_claim(value.at("distance")), read_pair_proof(value.at("proof"))};
}

PairAnswer read_pair(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "units", "pose", "distance", "proof"});
  auto [pose, distance, certificate] = read_posed(root);
  return {read_two_models(root.at("models")), units_of(root), pose, distance, std::move(certificate)};
}

PoseAnswers read_poses(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "units", "answers"});
  PoseAnswers result{read_two_models(root.at("models")), units_of(root), {}};
  const JsonValue answers = root.at("answers");
  if (answers.size() == 0) answers.fail("must not be empty");
  result.answers.reserve(answers.size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const JsonValue answer = answers.element(i);
    answer.check_keys({"pose", "distance", "proof"});
    result.answers.push_back(read_posed(answer));
  }
  return result;
}

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

/// In all no more points than a mesh has indices for.
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

FitAnswer read_fit(const JsonValue& root) {
  root.check_keys(
      {"format", "kind", "models", "mesh", "units", "criterion", "penetration_limit", "areas", "area_runs", "claims"});
  const JsonValue models = root.at("models");
  if (models.size() != 1) models.fail("must be an array of one model");
  FitAnswer answer{.model = read_subject_file(models.element(0)),
                   .mesh = read_subject_file(root.at("mesh")),
                   .units = units_of(root),
                   .fitness = read_criterion(root.at("criterion")),
                   .penetration_limit = nonnegative_number(root.at("penetration_limit")),
                   .areas = read_claimed_areas(root.at("areas")),
                   .area_runs = {},
                   .claims = read_clearance_claims(root.at("claims"))};
  answer.area_runs = read_area_runs(root.at("area_runs"), answer.areas.size());
  return answer;
}

/// All of it, whose text is valid as long as `file`.
std::string_view whole(InputFile& file) {
  const std::string_view text = file.peek(largest_certificate + 1);
  if (text.size() > largest_certificate)
    file.fail_whole(fmt::format("larger than {} bytes: not a certificate", largest_certificate));
  return text;
}

}  // namespace

std::uint64_t points_of(const FitAnswer& answer) {
  return std::transform_reduce(answer.area_runs.begin(), answer.area_runs.end(), std::uint64_t{0}, std::plus<>(),
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

ClearanceTerms terms_of(const FitAnswer& answer) {
  ClearanceTerms terms{answer.fitness, answer.penetration_limit, answer.areas, {}};
  terms.area_of.reserve(points_of(answer));
  for (const auto& [area, points] : answer.area_runs) terms.area_of.insert(terms.area_of.end(), points, area);
  return terms;
}

SubjectFile subject_file(const std::filesystem::path& path) {
  InputFile file(path);
  constexpr std::size_t block = std::size_t{1} << 16U;
  Sha256 hash;
  for (std::string_view bytes = file.peek(block); !bytes.empty(); bytes = file.peek(block)) {
    hash.add(std::as_bytes(std::span(bytes)));
    (void)file.take(bytes.size(), "the file");
  }
  return {path.filename().string(), hash.digest()};
}

Answer parse_answer(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  const std::string kind = checked_kind(root);
  if (kind == "pair") return read_pair(root);
  if (kind == "poses") return read_poses(root);
  if (kind == "fit") return read_fit(root);
  if (kind == "insertion") return read_insertion(root);
  if (kind == "deviation") return read_deviation(root);
  if (kind == "features") return read_features(root);
  if (kind == "equilibrium") return read_equilibrium(root);
  if (kind == "path") return read_path_answer(root);
  root.at("kind").fail(
      "must be \"pair\", \"poses\", \"path\", \"fit\", \"insertion\", \"deviation\", \"features\" or \"equilibrium\"");
}

Answer read_answer(const std::filesystem::path& path) {
  InputFile file(path);
  return parse_answer(whole(file), path.string());
}

PairAnswer parse_pair_answer(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  if (checked_kind(root) != "pair") root.at("kind").fail("must be \"pair\"");
  return read_pair(root);
}

PairAnswer read_pair_answer(const std::filesystem::path& path) {
  InputFile file(path);
  return parse_pair_answer(whole(file), path.string());
}

}  // namespace verisq
