/// Parts are read one by one; what proves them need not prove anything.
#include "host/files/path_answer.hpp"

#include "host/files/certificate_fields.hpp"
#include "host/files/pair_proof.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

PathPart read_part(const JsonValue& value) {
  value.check_keys({"until", "proof"});
  return {nonnegative_number(value.at("until")), read_pair_proof(value.at("proof"))};
}

}  // namespace

PathAnswer read_path_answer(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "units", "path", "smallest", "first_contact", "nearest", "parts"});
  PathAnswer answer{.models = read_two_models(root.at("models")),
                    .units = units_of(root),
                    .path = read_path(root.at("path")),
                    .claims = {read_claim(root.at("smallest"))},
                    .certificate = {}};
  if (const auto contact = root.find("first_contact")) answer.claims.first_contact = read_claim(*contact);
  const JsonValue nearest = root.at("nearest");
  nearest.check_keys({"time", "proof"});
  answer.certificate.nearest = nonnegative_number(nearest.at("time"));
  answer.certificate.at_nearest = read_pair_proof(nearest.at("proof"));
  const JsonValue parts = root.at("parts");
  for (std::size_t k = 0; k < parts.size(); ++k) answer.certificate.parts.push_back(read_part(parts.element(k)));
  return answer;
}

}  // namespace verisq
