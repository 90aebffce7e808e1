/// Writes `verisq-certificate/1`: numbers with as many digits as their binary64 needs.
#include <cmath>
#include <nlohmann/json.hpp>
#include <verisq/certificate_file.hpp>

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

}  // namespace

void write_answer(const std::filesystem::path& path, const PairAnswer& answer) {
  OrderedJson document{{"format", "verisq-certificate/1"}, {"kind", "pair"}};
  document["models"] = {json_of(answer.models[0]), json_of(answer.models[1])};
  if (!answer.units.empty()) document["units"] = answer.units;
  document["pose"] = {{"translation", answer.pose.translation}, {"quaternion", answer.pose.quaternion}};
  document["distance"] = json_of(answer.distance);
  document["proof"] = json_of(answer.certificate);
  OutputFile file(path);
  file.write(document.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
  file.finish();
}

}  // namespace verisq
