/// The range, and how it is halved; whether that makes sense is the checker's to see.
#include "host/files/best_fit_answer.hpp"

#include <string_view>

#include "host/files/certificate_fields.hpp"
#include "host/files/fit_answer.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

constexpr std::string_view letters_of_divisions = "xyzuvw.";  // of PoseDivision

PoseRange read_range(const JsonValue& value) {
  value.check_keys({"start", "translation", "rotation_degrees"});
  const PoseRange range{.start = read_pose_object(value.at("start")),
                        .translation = nonnegative_number(value.at("translation")),
                        .rotation_degrees = nonnegative_number(value.at("rotation_degrees"))};
  if (range.rotation_degrees > 180.0) value.at("rotation_degrees").fail("must be at most 180");
  return range;
}

std::vector<PoseDivision> read_divisions(const JsonValue& value) {
  const std::string text = value.text();
  std::vector<PoseDivision> divisions;
  divisions.reserve(text.size());
  for (const char letter : text) {
    const std::size_t index = letters_of_divisions.find(letter);
    if (index == std::string_view::npos) value.fail("must consist of the letters x, y, z, u, v, w and .");
    divisions.push_back(static_cast<PoseDivision>(index));
  }
  return divisions;
}

/// Finite, or minus infinity: that no pose keeps the limit. Plus infinity would claim nothing.
double read_upper(const JsonValue& value) {
  const double upper = value.number_or_infinity();
  if (upper == infinity) value.fail("must be a number, or \"-inf\"");
  return upper;
}

/// As many as there are models.
void require_one_a_model(const JsonValue& value, std::size_t models) {
  if (value.size() != models) value.fail("must be " + std::to_string(models) + ", one a model");
}

}  // namespace

BestFitAnswer read_best_fit(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "mesh", "units", "criterion", "penetration_limit", "areas", "area_runs",
                   "range", "centres", "upper", "ranges"});
  const JsonValue models = root.at("models");
  const std::size_t count = models.size();
  if (count == 0) models.fail("must not be empty");
  BestFitAnswer answer{.models = {},
                       .mesh = read_subject_file(root.at("mesh")),
                       .units = units_of(root),
                       .terms = read_terms(root),
                       .range = read_range(root.at("range")),
                       .centres = {},
                       .upper = read_upper(root.at("upper")),
                       .certificate = {}};
  const JsonValue centres = root.at("centres");
  const JsonValue ranges = root.at("ranges");
  require_one_a_model(centres, count);
  require_one_a_model(ranges, count);
  for (std::size_t i = 0; i < count; ++i) {
    answer.models.push_back(read_subject_file(models.element(i)));
    answer.centres.push_back(finite_numbers<3>(centres.element(i)));
    answer.certificate.ranges.push_back(read_divisions(ranges.element(i)));
  }
  return answer;
}

std::string text_of(const std::vector<PoseDivision>& divisions) {
  std::string text;
  text.reserve(divisions.size());
  for (const PoseDivision division : divisions) text += letters_of_divisions[static_cast<std::size_t>(division)];
  return text;
}

BestFitClaim claim_of(const BestFitAnswer& answer) {
  return {.terms = terms_of(answer.terms), .range = answer.range, .centres = answer.centres, .upper = answer.upper};
}

}  // namespace verisq
