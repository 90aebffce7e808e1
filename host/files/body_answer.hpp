/// Describes the kinds `equilibrium` and `features` of certificate files (docs/formats.md §9).
#pragma once

#include <algorithm>
#include <numeric>

#include "host/files/certificate_archive.hpp"
#include "host/files/model_file.hpp"

namespace verisq::certificates {

template <>
inline constexpr Kind kind_of<EquilibriumAnswer>{"equilibrium"};
template <>
inline constexpr Kind kind_of<FeaturesAnswer>{"features", 2};

// The kind `equilibrium`.

void describe(const auto& archive, Of<stance::JointControl> auto& control) {
  archive.word(control, {{"held", stance::JointControl::held}, {"proportional", stance::JointControl::proportional}},
               "must be \"held\" or \"proportional\"");
}

inline constexpr auto as_uncertain = [](const auto& archive, auto& parameter, auto& range) {
  archive.object(field("parameter", parameter, shown_name), field("lo", range.lo), field("hi", range.hi));
  archive.require(range.lo <= range.hi, "hi", "must not be below the lower end");
};
inline constexpr auto as_joint = [](const auto& archive, auto& joint, auto& position, auto& torque) {
  archive.object(field("joint", joint, shown_name), field("position", position), field("torque", torque));
};
inline constexpr auto as_cylinder = [](const auto& archive, auto& cylinder, auto& load) {
  archive.object(field("cylinder", cylinder, shown_name), field("force", load.force),
                 field("penetration", load.penetration));
};
inline constexpr auto as_centre_of_pressure = [](const auto& archive, auto& standing) {
  archive.object(field("x", standing.centre_of_pressure_x), field("z", standing.centre_of_pressure_z));
};

void describe_standing(const auto& archive, Of<EquilibriumAnswer> auto& answer, Of<stance::Standing> auto& standing) {
  const auto as_joints = [&](const auto& list, auto& names) {
    list.list(as_joint, names, standing.positions, standing.torques);
    list.each("", ".joint", names, distinct(names), "is named before");
  };
  const auto as_cylinders = [&](const auto& list, auto& names) {
    list.list(as_cylinder, names, standing.loads);
    list.each("", ".cylinder", names, distinct(names), "is named before");
  };
  archive.object(field_by("joints", answer.joints, as_joints), field_by("cylinders", answer.cylinders, as_cylinders),
                 field_by("centre_of_pressure", standing, as_centre_of_pressure),
                 field("least_penetration", standing.least_penetration));
}

inline constexpr auto as_posture = [](const auto& archive, auto& range) {
  archive.array("must be an array of 2 numbers", range.lo, range.hi);
  archive.require(range.lo <= range.hi, "[1]", "must not be below the lower end");
};
inline constexpr auto as_postures = [](const auto& archive, auto& ranges) { archive.list(as_posture, ranges); };

void describe(const auto& archive, Of<stance::EquilibriumPart> auto& part) {
  archive.object(field("halved", part.halved), unless_empty(field_by("postures", part.postures, as_postures)));
  archive.require(!part.halved || !archive.has("postures"), "postures", "must not be of a part that is halved");
  archive.require(!part.postures.empty() || !archive.has("postures"), "postures", "must not be empty");
}

/// Requires that the parts are one tree in preorder.
void require_tree(const auto& archive, const std::vector<stance::EquilibriumPart>& parts, std::size_t parameters) {
  const auto is_parameter = [&](std::size_t i) { return !parts[i].halved || *parts[i].halved < parameters; };
  archive.each("parts", ".halved", parts, is_parameter, "must be the index of an uncertain parameter");
  const auto is_of_tree = [&, expected = std::size_t{1}](std::size_t i) mutable {
    if (expected == 0) return false;
    expected = parts[i].halved ? expected + 1 : expected - 1;
    return true;
  };
  archive.each("parts", "", parts, is_of_tree, "is beyond the last part of the box");
  const auto halved = std::ranges::count_if(parts, [](const auto& part) { return part.halved.has_value(); });
  archive.require(std::ssize(parts) == 2 * halved + 1, "parts", "must have two parts for each that is halved");
}

template <class Archive>
void describe(const Archive& archive, Of<EquilibriumAnswer> auto& answer) {
  auto& claims = answer.claims;
  const auto as_box = [&](const auto& list, auto& names) {
    list.list(as_uncertain, names, claims.ranges);
    list.each("", ".parameter", names, distinct(names), "is named before");
  };
  const auto as_standing = [&](const auto& of, auto& standing) { describe_standing(of, answer, standing); };
  archive.object(heading<EquilibriumAnswer>(), field_by("models", answer.model, as_one_model),
                 field("joints", claims.control), field_by("uncertain", answer.parameters, as_box),
                 field("stands", claims.stands, nonnegative), field_by("standing", claims.standing, as_standing),
                 field("reference", answer.certificate.reference), lines("parts", answer.certificate.parts, "cells"));
  archive.require(claims.stands <= 1.0, "stands", "must be at most 1");
  require_tree(archive, answer.certificate.parts, answer.parameters.size());
  if constexpr (Archive::reads) {
    claims.uncertain.resize(claims.ranges.size());
    std::iota(claims.uncertain.begin(), claims.uncertain.end(), 0U);
  }
}

// The kind `features`.

void describe(const auto& archive, Of<FeatureUnit> auto& unit) {
  archive.word(unit, {{"mm", FeatureUnit::length}, {"degrees", FeatureUnit::degrees}}, "must be \"mm\" or \"degrees\"");
}

void describe(const auto& archive, Of<Side> auto& side) {
  archive.word(side, {{"left", Side::left}, {"right", Side::right}}, "must be \"left\" or \"right\"");
}

void describe(const auto& archive, Of<Feature> auto& feature) {
  archive.object(field("name", feature.name, shown_name), field("method", feature.method, shown_name),
                 field("unit", feature.unit), claim_fields(feature.value));
}

void describe(const auto& archive, Of<FrameAxis> auto& axis) {
  archive.object(field("direction", axis.direction), field("tilt_degrees", axis.tilt_degrees, nonnegative));
}

void describe(const auto& archive, Of<FemurFrame> auto& frame) {
  archive.object(field("origin", frame.origin), field("x", frame.x), field("y", frame.y), field("z", frame.z));
}

/// The points by their names; the head's radius is elsewhere.
template <class Archive>
void describe(const Archive& archive, Of<FemurLandmarks> auto& landmarks) {
  if constexpr (Archive::reads) {
    const std::optional<double> head_radius = landmarks.head_radius;
    landmarks = read_landmark_points(archive.json());
    landmarks.head_radius = head_radius;
  } else {
    std::apply([&](const auto&... named) { archive.object(field(named.name, landmarks.*named.point)...); },
               named_landmarks);
  }
}

template <class Archive>
void describe(const Archive& archive, Of<FeaturesAnswer> auto& answer) {
  auto& claims = answer.claims;
  std::vector<SubjectFile> models;  // one with an implant
  if (answer.implant) models.push_back(*answer.implant);
  std::optional<std::vector<Feature>> changes;
  if (claims.implant) changes = claims.changes;
  archive.object(heading<FeaturesAnswer>(), field("models", models), field("mesh", answer.mesh),
                 constant("units", "mm"), field("side", claims.side),
                 field("landmark_radius", claims.landmark_radius, nonnegative),
                 field("head_radius", claims.landmarks.head_radius, positive), field("landmarks", claims.landmarks),
                 field("features", claims.features), field("frame", claims.frame), field("implant", claims.implant),
                 field("changes", changes));
  archive.require(models.size() == (claims.implant ? 1U : 0U), "models",
                  "must be one model where there is an \"implant\", else none");
  archive.require(claims.implant.has_value() == changes.has_value(), "",
                  "must have both \"implant\" and \"changes\", or neither");
  if constexpr (Archive::reads) {
    if (!models.empty()) answer.implant = models.front();
    if (changes) claims.changes = *changes;
  }
  const auto told = [](const Feature& feature) { return std::pair(feature.name, feature.method); };
  archive.each("features", "", claims.features, distinct(claims.features, told), "is claimed before");
  archive.each("changes", "", claims.changes, distinct(claims.changes, told), "is claimed before");
  archive.require(!claims.features.empty() || !claims.changes.empty() || claims.frame, "features",
                  "must not be empty without a frame and changes");
}

}  // namespace verisq::certificates
