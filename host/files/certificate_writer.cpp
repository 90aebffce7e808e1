/// Writes `verisq-certificate/1`: numbers with as many digits as their binary64 needs.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <verisq/certificate_file.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/certificate_size.hpp"
#include "host/files/cover_digits.hpp"
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

OrderedJson json_of(const Pose& pose) {
  return {{"translation", pose.translation}, {"quaternion", pose.quaternion}};
}

/// What of it an insertion needs.
void add_certificate(OrderedJson& object, const Certificate& certificate) {
  object["normals"] = OrderedJson::array();
  for (const auto& [primitive, v] : certificate.normals)
    object["normals"].push_back(OrderedJson::array({primitive, v[0], v[1], v[2]}));
  if (certificate.escape) object["escape"] = *certificate.escape;
  if (certificate.witness) object["witness"] = *certificate.witness;
  if (!certificate.cover.empty()) object["cover"] = digits_of_cover(certificate.cover);
}

OrderedJson json_of(const WayPart& part) {
  OrderedJson object{{"until", part.until}, {"segment", part.segment}};
  add_certificate(object, part.certificate);
  return object;
}

OrderedJson json_of(const InsertionAnswer::Row& row) {
  OrderedJson object = json_of(row.distance);
  object["deepest"] = {{"time", row.certificate.deepest}};
  add_certificate(object["deepest"], row.certificate.at_deepest);
  object["parts"] = OrderedJson::array();
  for (const WayPart& part : row.certificate.parts) object["parts"].push_back(json_of(part));
  return object;
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
  object["pose"] = json_of(answer.pose);
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

/// `head` with the `count` objects of `key` at its end, a line each, and none of them as a document in memory beside
/// the text. Of `fewer` it asks where they are too many.
template <class Object>
void write_lines(const std::filesystem::path& path, const OrderedJson& head, const char* key, std::size_t count,
                 const char* fewer, const Object& object) {
  const std::string ending = "\n]}\n";
  std::string text = text_of(head, -1);
  text.back() = ',';  // instead of the brace
  text += fmt::format("\n\"{}\": [", key);
  for (std::size_t i = 0; i < count; ++i) {
    text += (i == 0 ? "\n" : ",\n") + text_of(object(i), -1);
    if (text.size() + ending.size() > largest_certificate) {
      refuse(fmt::format("{}: the first {} of {} {} take more than the {} bytes of a certificate file: give fewer {}",
                         path.string(), i + 1, count, key, largest_certificate, fewer));
    }
  }
  write_text(path, text + ending);
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

void write_answer(const std::filesystem::path& path, const PoseAnswers& answers) {
  write_lines(path, head_of(answers, "poses"), "answers", answers.answers.size(), "poses", [&](std::size_t i) {
    OrderedJson object;
    add_claim(object, answers.answers[i]);
    return object;
  });
}

void write_answer(const std::filesystem::path& path, const InsertionAnswer& answer) {
  OrderedJson head{{"format", "verisq-certificate/1"}, {"kind", "insertion"}};
  head["models"] = OrderedJson::array({json_of(answer.model)});
  head["mesh"] = json_of(answer.mesh);
  if (!answer.units.empty()) head["units"] = answer.units;
  if (answer.pose) head["pose"] = json_of(*answer.pose);
  head["path"] = OrderedJson::array();
  for (const Pose& pose : answer.path) head["path"].push_back(json_of(pose));
  write_lines(path, head, "rows", answer.rows.size(), "vertices",
              [&](std::size_t i) { return json_of(answer.rows[i]); });
}

}  // namespace verisq
