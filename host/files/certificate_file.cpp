/// The certificate format `verisq-certificate/1`: what docs/formats.md §9 accepts and refuses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <verisq/certificate_file.hpp>

#include "host/files/certificate_size.hpp"
#include "host/files/input_file.hpp"
#include "host/files/json_document.hpp"
#include "host/files/sha256.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

constexpr std::string_view certificate_format = "verisq-certificate/1";

template <std::size_t N>
std::array<double, N> finite_numbers(const JsonValue& value) {
  if (value.size() != N) value.fail(fmt::format("must be an array of {} numbers", N));
  std::array<double, N> result{};
  for (std::size_t k = 0; k < N; ++k) result[k] = value.element(k).number();
  return result;
}

Enclosure read_claim(const JsonValue& value) {
  value.check_keys({"lo", "hi"});
  return {value.at("lo").number_or_infinity(), value.at("hi").number_or_infinity()};
}

std::array<SubjectFile, 2> read_two_models(const JsonValue& value) {
  if (value.size() != 2) value.fail("must be an array of two models");
  return {read_subject_file(value.element(0)), read_subject_file(value.element(1))};
}

Pose read_second_pose(const JsonValue& value) {
  value.check_keys({"translation", "quaternion"});
  const Pose pose{finite_numbers<3>(value.at("translation")), finite_numbers<4>(value.at("quaternion"))};
  if (std::ranges::all_of(pose.quaternion, [](double c) { return c == 0.0; })) {
    value.at("quaternion").fail("must not be zero");
  }
  return pose;
}

std::uint32_t read_index(const JsonValue& value) {
  if (!value.json().is_number_unsigned() || value.json().get<std::uint64_t>() > 0xffffffffU) {
    value.fail("must be an index");
  }
  return value.json().get<std::uint32_t>();
}

Separation read_separation(const JsonValue& value) {
  value.check_keys({"primitive_a", "primitive_b", "vector", "on_a", "on_b"});
  return {read_index(value.at("primitive_a")), read_index(value.at("primitive_b")),
          finite_numbers<3>(value.at("vector")), finite_numbers<3>(value.at("on_a")),
          finite_numbers<3>(value.at("on_b"))};
}

PairCertificate read_pair_proof(const JsonValue& value) {
  value.check_keys({"separations", "common"});
  PairCertificate result;
  if (const auto common = value.find("common")) result.common = finite_numbers<3>(*common);
  const JsonValue separations = value.at("separations");
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::size_t i = 0; i < separations.size(); ++i) {
    const Separation separation = read_separation(separations.element(i));
    // So that no more work can be asked for than there are pairs.
    if (!seen.insert({separation.primitive_a, separation.primitive_b}).second) {
      separations.element(i).fail("these two primitives have been separated before");
    }
    result.separations.push_back(separation);
  }
  return result;
}

/// Of the kind that it returns.
std::string checked_kind(const JsonValue& root) {
  if (!root.json().is_object()) root.fail("must be an object");
  if (const JsonValue format = root.at("format"); format.text() != certificate_format) {
    format.fail(fmt::format("must be \"{}\"", certificate_format));
  }
  return root.at("kind").text();
}

std::string units_of(const JsonValue& root) {
  const auto units = root.find("units");
  return units ? units->text() : std::string();
}

PosedAnswer read_posed(const JsonValue& value) {
  return {read_second_pose(value.at("pose")), read_claim(value.at("distance")), read_pair_proof(value.at("proof"))};
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

/// All of it, whose text is valid as long as `file`.
std::string_view whole(InputFile& file, std::string_view what) {
  const std::string_view text = file.peek(largest_certificate + 1);
  if (text.size() > largest_certificate)
    file.fail_whole(fmt::format("larger than {} bytes: {}", largest_certificate, what));
  return text;
}

}  // namespace

SubjectFile subject_file(const std::filesystem::path& path) {
  InputFile file(path);
  return {path.filename().string(), sha256(whole(file, "not a model"))};
}

Answer parse_answer(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  const std::string kind = checked_kind(root);
  if (kind == "pair") return read_pair(root);
  if (kind == "poses") return read_poses(root);
  root.at("kind").fail("must be \"pair\" or \"poses\"");
}

Answer read_answer(const std::filesystem::path& path) {
  InputFile file(path);
  return parse_answer(whole(file, "not a certificate"), path.string());
}

PairAnswer parse_pair_answer(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  if (checked_kind(root) != "pair") root.at("kind").fail("must be \"pair\"");
  return read_pair(root);
}

PairAnswer read_pair_answer(const std::filesystem::path& path) {
  InputFile file(path);
  return parse_pair_answer(whole(file, "not a certificate"), path.string());
}

}  // namespace verisq
