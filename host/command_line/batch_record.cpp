/// The format `verisq-batch-case/1`.
#include "host/command_line/batch_record.hpp"

#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <verisq/error.hpp>
#include <verisq/version.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view record_format = "verisq-batch-case/1";

Json json_of(const std::vector<SubjectFile>& files) {
  Json list = Json::array();
  for (const SubjectFile& file : files) list.push_back({{"file", file.name}, {"sha256", file.sha256}});
  return list;
}

/// What a record must say to be one of this case.
Json identity(const BatchCase& of, const std::vector<SubjectFile>& inputs) {
  return {{"format", record_format}, {"version", VERISQ_VERSION}, {"case", of.name},
          {"command", of.command},   {"arguments", of.arguments}, {"inputs", json_of(inputs)}};
}

std::optional<std::uint64_t> count_in(const Json& object, std::initializer_list<const char*> names) {
  for (const char* const name : names) {
    const auto found = object.find(name);
    if (found != object.end() && found->is_number_unsigned()) return found->get<std::uint64_t>();
  }
  return std::nullopt;
}

/// JSON has no infinity: summaries give null.
double end_in(const Json& object, const char* name, double unbounded) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number() ? found->get<double>() : unbounded;
}

std::optional<Enclosure> enclosure_in(const Json& object) {
  if (!object.is_object() || !object.contains("lo") || !object.contains("hi")) return std::nullopt;
  return Enclosure{end_in(object, "lo", -infinity), end_in(object, "hi", infinity)};
}

/// Of `map`, `fit`, `insert`; of `distance` and `path`, whose answer it is.
std::optional<Enclosure> smallest_in(const Json& summary) {
  const auto found = summary.find("smallest_distance");
  return found != summary.end() ? enclosure_in(*found) : enclosure_in(summary);
}

CaseResult result_in(const Json& summary, CaseOutcome outcome) {
  CaseResult result{.outcome = outcome};
  result.smallest = smallest_in(summary);
  result.rows = count_in(summary, {"points", "triangles", "poses"});
  result.wide_rows = count_in(summary, {"wide"});
  if (const auto units = summary.find("units"); units != summary.end() && units->is_string()) {
    result.units = units->get<std::string>();
  }
  if (const auto width = summary.find("largest_width"); width != summary.end() && width->is_number()) {
    result.largest_width = width->get<double>();
  }
  return result;
}

std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::string_view to_string(CaseOutcome outcome) {
  switch (outcome) {
    case CaseOutcome::verified: return "verified";
    case CaseOutcome::wide: return "wide";
    case CaseOutcome::failed: return "failed";
    case CaseOutcome::not_run: break;
  }
  return "not-run";
}

CaseResult result_of(std::string_view json, CaseOutcome outcome, std::string_view name) {
  const Json summary = Json::parse(json, nullptr, false);
  if (!summary.is_object()) refuse(fmt::format("{}: printed no summary", name));
  return result_in(summary, outcome);
}

std::string text_of(const CaseResult& result) {
  const auto end = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  Json summary{{"outcome", to_string(result.outcome)}, {"message", result.message}, {"seconds", result.seconds}};
  if (result.smallest)
    summary["smallest_distance"] = {{"lo", end(result.smallest->lo)}, {"hi", end(result.smallest->hi)}};
  if (result.rows) summary["points"] = *result.rows;
  if (result.wide_rows) summary["wide"] = *result.wide_rows;
  if (result.largest_width) summary["largest_width"] = *result.largest_width;
  summary["units"] = result.units;
  return summary.dump(-1, ' ', false, Json::error_handler_t::replace);
}

CaseResult result_from(std::string_view text) {
  const Json summary = Json::parse(text);
  CaseResult result = result_in(summary, CaseOutcome::not_run);
  for (const CaseOutcome outcome : {CaseOutcome::verified, CaseOutcome::wide, CaseOutcome::failed}) {
    if (summary.at("outcome") == to_string(outcome)) result.outcome = outcome;
  }
  result.message = summary.at("message").get<std::string>();
  result.seconds = summary.at("seconds").get<double>();
  return result;
}

std::vector<std::filesystem::path> inputs_of(const BatchCase& of, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const std::string& argument : of.arguments) {
    if (argument.starts_with("--output=")) continue;
    const std::size_t equals = argument.starts_with("--") ? argument.find('=') : std::string::npos;
    const std::filesystem::path named = equals == std::string::npos ? argument : argument.substr(equals + 1);
    std::error_code none;
    if (std::filesystem::is_regular_file(folder / named, none)) files.push_back(folder / named);
  }
  return files;
}

void write_record(const std::filesystem::path& path, const BatchCase& of, const std::vector<SubjectFile>& inputs,
                  CaseOutcome outcome, double seconds, std::string_view json) {
  Json record = identity(of, inputs);
  record["outcome"] = to_string(outcome);
  record["seconds"] = seconds;
  record["summary"] = Json::parse(json);
  OutputFile file(path);
  file.write(record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  file.finish();
}

std::optional<CaseResult> read_record(const std::filesystem::path& path, const BatchCase& of,
                                      const std::vector<SubjectFile>& inputs) {
  const Json record = Json::parse(text_of_file(path), nullptr, false);
  if (!record.is_object()) return std::nullopt;
  const Json expected = identity(of, inputs);
  for (const auto& [key, value] : expected.items()) {
    if (!record.contains(key) || record[key] != value) return std::nullopt;
  }
  if (!record.contains("outcome") || !record.contains("summary") || !record["summary"].is_object()) return std::nullopt;
  for (const CaseOutcome outcome : {CaseOutcome::verified, CaseOutcome::wide}) {
    if (record["outcome"] != std::string(to_string(outcome))) continue;
    CaseResult result = result_in(record["summary"], outcome);
    result.seconds = end_in(record, "seconds", 0.0);
    return result;
  }
  return std::nullopt;
}

}  // namespace verisq::command_line
