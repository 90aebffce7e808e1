/// The certificate format `verisq-certificate/1`: what docs/formats.md §9 accepts and refuses.
#include <fmt/format.h>

#include <utility>
#include <verisq/certificate_file.hpp>

#include "host/files/best_fit_answer.hpp"
#include "host/files/certificate_fields.hpp"
#include "host/files/certificate_size.hpp"
#include "host/files/contact_answer.hpp"
#include "host/files/deviation_answer.hpp"
#include "host/files/equilibrium_answer.hpp"
#include "host/files/features_answer.hpp"
#include "host/files/fit_answer.hpp"
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

/// All of it, whose text is valid as long as `file`.
std::string_view whole(InputFile& file) {
  const std::string_view text = file.peek(largest_certificate + 1);
  if (text.size() > largest_certificate)
    file.fail_whole(fmt::format("larger than {} bytes: not a certificate", largest_certificate));
  return text;
}

}  // namespace

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
  if (kind == "best_fit") return read_best_fit(root);
  if (kind == "insertion") return read_insertion(root);
  if (kind == "deviation") return read_deviation(root);
  if (kind == "contact") return read_contact(root);
  if (kind == "features") return read_features(root);
  if (kind == "equilibrium") return read_equilibrium(root);
  if (kind == "path") return read_path_answer(root);
  root.at("kind").fail(
      "must be \"pair\", \"poses\", \"path\", \"fit\", \"best_fit\", \"insertion\", \"deviation\", \"contact\", "
      "\"features\" or \"equilibrium\"");
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
