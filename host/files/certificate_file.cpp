/// Certificate files, `verisq-certificate/1`: reads and writes all kinds by their descriptions (docs/formats.md §9).
#include <fmt/format.h>

#include <functional>
#include <numeric>
#include <span>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>
#include <verisq/certificate_file.hpp>

#include "host/files/body_answer.hpp"
#include "host/files/certificate_archive.hpp"
#include "host/files/deviation_answer.hpp"
#include "host/files/fit_answer.hpp"
#include "host/files/input_file.hpp"
#include "host/files/output_file.hpp"
#include "host/files/pair_answer.hpp"

namespace verisq {
namespace {

using certificates::certificate_format;

/// Checks the format, and returns the kind.
std::string checked_kind(const JsonValue& root) {
  if (!root.json().is_object()) root.fail("must be an object");
  if (const JsonValue format = root.at("format"); format.text() != certificate_format) {
    format.fail(fmt::format("must be \"{}\"", certificate_format));
  }
  return root.at("kind").text();
}

template <class Kind>
Kind read_kind(const JsonValue& root) {
  Kind answer{};
  describe(certificates::ReadingArchive(root), answer);
  return answer;
}

/// "pair", "poses" or "path"
template <class... Kinds>
std::string words_of(std::type_identity<std::variant<Kinds...>> /*kinds*/) {
  std::string text;
  std::size_t left = sizeof...(Kinds);
  ((text += fmt::format("\"{}\"{}", certificates::kind_of<Kinds>.word,
                        left > 2    ? ", "
                        : left == 2 ? " or "
                                    : ""),
    --left),
   ...);
  return text;
}

template <class... Kinds>
Answer read_any(const JsonValue& root, std::type_identity<std::variant<Kinds...>> kinds) {
  const std::string kind = checked_kind(root);
  Answer answer;
  const bool known = ((kind == certificates::kind_of<Kinds>.word && (answer = read_kind<Kinds>(root), true)) || ...);
  if (!known) root.at("kind").fail("must be " + words_of(kinds));
  return answer;
}

/// The whole file; the text is valid as long as `file`.
std::string_view whole(InputFile& file) {
  const std::string_view text = file.peek_text(largest_certificate + 1);
  if (text.size() > largest_certificate)
    file.fail_whole(fmt::format("larger than {} bytes: not a certificate", largest_certificate));
  return text;
}

template <class Kind>
std::string text_of_kind(const Kind& answer, const std::string& name) {
  certificates::Document document{name};
  describe(certificates::WritingArchive(document.head, &document), answer);
  if (!document.lines.empty()) return std::move(document.lines) + "}\n";
  constexpr int indentation = certificates::kind_of<Kind>.indentation;
  std::string text = certificates::text_of(document.head, indentation) + "\n";
  if (indentation < 0 && text.size() > largest_certificate)
    refuse(fmt::format("{}: takes more than the {} bytes of a certificate file", name, largest_certificate));
  return text;
}

std::vector<std::uint32_t> areas_of(std::span<const AreaRun> runs) {
  std::vector<std::uint32_t> areas;
  areas.reserve(points_of(runs));
  for (const auto& [area, points] : runs) areas.insert(areas.end(), points, area);
  return areas;
}

}  // namespace

Answer parse_answer(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  return read_any(JsonValue(document, name), std::type_identity<Answer>());
}

Answer read_answer(const std::filesystem::path& path) {
  InputFile file(path);
  return parse_answer(whole(file), path.string());
}

PairAnswer parse_pair_answer(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  if (checked_kind(root) != "pair") root.at("kind").fail("must be \"pair\"");
  return read_kind<PairAnswer>(root);
}

PairAnswer read_pair_answer(const std::filesystem::path& path) {
  InputFile file(path);
  return parse_pair_answer(whole(file), path.string());
}

std::string text_of(const Answer& answer, const std::string& name) {
  return std::visit([&](const auto& kind) { return text_of_kind(kind, name); }, answer);
}

std::string_view kind_of(const Answer& answer) {
  return std::visit([]<class Kind>(const Kind&) { return certificates::kind_of<Kind>.word; }, answer);
}

void write_answer(const std::filesystem::path& path, const Answer& answer) {
  const std::string text = text_of(answer, path.string());
  OutputFile file(path);
  file.write(text);
  file.finish();
}

// Numbers of answers that follow from their other members.

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

ClearanceTerms terms_of(const StatedTerms& stated) {
  return {stated.fitness, stated.penetration_limit, stated.areas, areas_of(stated.area_runs)};
}

BestFitClaim claim_of(const BestFitAnswer& answer) {
  return {.terms = terms_of(answer.terms), .range = answer.range, .centres = answer.centres, .upper = answer.upper};
}

ContactTerms terms_of(const ContactAnswer& answer) {
  return {answer.distance, areas_of(answer.region_runs), static_cast<std::uint32_t>(answer.regions.size()),
          answer.counted};
}

}  // namespace verisq
