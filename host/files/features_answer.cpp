/// Landmarks as landmark files have them, features by name and method.
#include "host/files/features_answer.hpp"

#include <set>
#include <string>
#include <utility>

#include "host/files/certificate_fields.hpp"
#include "host/files/landmark_points.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

Feature read_feature(const JsonValue& value) {
  value.check_keys({"name", "method", "unit", "lo", "hi"});
  const JsonValue unit = value.at("unit");
  if (unit.text() != "mm" && unit.text() != "degrees") unit.fail("must be \"mm\" or \"degrees\"");
  return {value.at("name").name(),
          value.at("method").name(),
          unit.text() == "mm" ? FeatureUnit::length : FeatureUnit::degrees,
          {value.at("lo").number_or_infinity(), value.at("hi").number_or_infinity()}};
}

std::vector<Feature> read_claims(const JsonValue& value) {
  std::vector<Feature> features;
  std::set<std::pair<std::string, std::string>> seen;
  for (std::size_t i = 0; i < value.size(); ++i) {
    features.push_back(read_feature(value.element(i)));
    if (!seen.insert({features.back().name, features.back().method}).second) value.element(i).fail("is claimed before");
  }
  return features;
}

FrameAxis read_axis(const JsonValue& value) {
  value.check_keys({"direction", "tilt_degrees"});
  return {finite_numbers<3>(value.at("direction")), nonnegative_number(value.at("tilt_degrees"))};
}

FemurFrame read_frame(const JsonValue& value) {
  value.check_keys({"origin", "x", "y", "z"});
  return {finite_numbers<3>(value.at("origin")), read_axis(value.at("x")), read_axis(value.at("y")),
          read_axis(value.at("z"))};
}

}  // namespace

FeaturesAnswer read_features(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "mesh", "units", "side", "landmark_radius", "landmarks", "head_radius",
                   "implant", "features", "frame", "changes"});
  if (units_of(root) != "mm") root.at("units").fail("must be \"mm\"");
  FeaturesAnswer answer;
  FeatureClaims& claims = answer.claims;
  claims.landmarks = read_landmark_points(root.at("landmarks"));
  claims.side = read_side(root);
  claims.landmark_radius = nonnegative_number(root.at("landmark_radius"));
  if (const auto radius = root.find("head_radius")) {
    claims.landmarks.head_radius = radius->number();
    if (!(*claims.landmarks.head_radius > 0.0)) radius->fail("must be positive");
  }
  claims.features = read_claims(root.at("features"));
  if (const auto frame = root.find("frame")) claims.frame = read_frame(*frame);
  const JsonValue models = root.at("models");
  const auto implant = root.find("implant");
  const auto changes = root.find("changes");
  if (models.size() != (implant ? 1U : 0U)) models.fail("must be one model where there is an \"implant\", else none");
  if (implant.has_value() != changes.has_value()) root.fail("must have both \"implant\" and \"changes\", or neither");
  if (implant) {
    answer.implant = read_subject_file(models.element(0));
    claims.implant = read_landmark_points(*implant);
    claims.changes = read_claims(*changes);
  }
  if (claims.features.empty() && claims.changes.empty() && !claims.frame) {
    root.at("features").fail("must not be empty without a frame and changes");
  }
  if (const auto mesh = root.find("mesh")) answer.mesh = read_subject_file(*mesh);
  return answer;
}

}  // namespace verisq
