/// Writes `verisq-certificate/1`: numbers with as many digits as their binary64 needs.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <verisq/certificate_file.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/certificate_size.hpp"
#include "host/files/output_file.hpp"

namespace verisq {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson json_of(const SubjectFile& file) {
  return {{"file", file.name}, {"sha256", file.sha256}};
}

OrderedJson end_of_claim(double end) {
  if (std::isfinite(end)) return end;
  return end > 0.0 ? "inf" : "-inf";
}

OrderedJson json_of(const Enclosure& claim) {
  return {{"lo", end_of_claim(claim.lo)}, {"hi", end_of_claim(claim.hi)}};
}

OrderedJson json_of(const Separation& separation) {
  return {{"primitive_a", separation.primitive_a},
          {"primitive_b", separation.primitive_b},
          {"vector", separation.vector},
          {"on_a", separation.on_a},
          {"on_b", separation.on_b}};
}

OrderedJson json_of(const PairCertificate& certificate) {
  OrderedJson proof{{"separations", OrderedJson::array()}};
  for (const Separation& separation : certificate.separations) proof["separations"].push_back(json_of(separation));
  if (certificate.common) proof["common"] = *certificate.common;
  return proof;
}

/// Of what `answer` claims and by what.
template <class Posed>
void add_claim(OrderedJson& object, const Posed& answer) {
  object["pose"] = {{"translation", answer.pose.translation}, {"quaternion", answer.pose.quaternion}};
  object["distance"] = json_of(answer.distance);
  object["proof"] = json_of(answer.certificate);
}

template <class AboutTwoModels>
OrderedJson head_of(const AboutTwoModels& answer, const char* kind) {
  OrderedJson document{{"format", "verisq-certificate/1"}, {"kind", kind}};
  document["models"] = {json_of(answer.models[0]), json_of(answer.models[1])};
  if (!answer.units.empty()) document["units"] = answer.units;
  return document;
}

std::string text_of(const OrderedJson& document, int indentation) {
  return document.dump(indentation, ' ', false, OrderedJson::error_handler_t::replace);
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.finish();
}

}  // namespace

void write_answer(const std::filesystem::path& path, const PairAnswer& answer) {
  OrderedJson document = head_of(answer, "pair");
  add_claim(document, answer);
  write_text(path, text_of(document, 2) + "\n");
}

void write_answer(const std::filesystem::path& path, const FitAnswer& answer) {
  OrderedJson document{{"format", "verisq-certificate/1"}, {"kind", "fit"}};
  document["models"] = OrderedJson::array({json_of(answer.model)});
  document["mesh"] = json_of(answer.mesh);
  if (!answer.units.empty()) document["units"] = answer.units;
  document["criterion"] = {
      {"target", answer.fitness.target}, {"scale", answer.fitness.scale}, {"serves", json_of(answer.fitness.serves)}};
  document["penetration_limit"] = answer.penetration_limit;
  document["areas"] = OrderedJson::array();
  for (const Area& area : answer.areas) document["areas"].push_back({{"name", area.name}, {"weight", area.weight}});
  document["area_runs"] = OrderedJson::array();
  for (const auto& [area, points] : answer.area_runs) document["area_runs"].push_back({area, points});
  document["claims"] = OrderedJson::array();
  for (const ClearanceClaim& claim : answer.claims) {
    OrderedJson object{{"what", claim.what}};
    if (!claim.area.empty()) object["area"] = claim.area;
    object.update(json_of(claim.value));
    document["claims"].push_back(std::move(object));
  }
  const std::string text = text_of(document, -1) + "\n";
  if (text.size() > largest_certificate)
    refuse(fmt::format("{}: takes more than the {} bytes of a certificate file", path.string(), largest_certificate));
  write_text(path, text);
}

/// A line each, and none of them as a document in memory beside the text.
void write_answer(const std::filesystem::path& path, const PoseAnswers& answers) {
  const std::string ending = "\n]}\n";
  std::string text = text_of(head_of(answers, "poses"), -1);
  text.back() = ',';  // instead of the brace
  text += "\n\"answers\": [";
  for (std::size_t i = 0; i < answers.answers.size(); ++i) {
    OrderedJson object;
    add_claim(object, answers.answers[i]);
    text += (i == 0 ? "\n" : ",\n") + text_of(object, -1);
    if (text.size() + ending.size() > largest_certificate) {
      refuse(fmt::format(
          "{}: the first {} of {} answers take more than the {} bytes of a certificate file: give fewer poses",
          path.string(), i + 1, answers.answers.size(), largest_certificate));
    }
  }
  write_text(path, text + ending);
}

}  // namespace verisq
