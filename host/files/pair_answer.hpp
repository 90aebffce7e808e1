/// Describes the kinds `pair`, `poses` and `path` of certificate files: distances of two models (docs/formats.md §9).
#pragma once

#include <algorithm>

#include "host/files/certificate_archive.hpp"

namespace verisq::certificates {

template <>
inline constexpr Kind kind_of<PairAnswer>{"pair", 2};
template <>
inline constexpr Kind kind_of<PoseAnswers>{"poses"};
template <>
inline constexpr Kind kind_of<PathAnswer>{"path"};

// Proofs of the distance of two models. No two separations, and no two divisions, are about the same primitives. So no
// file can require more work than there are pairs, and planes.

void describe(const auto& archive, Of<Separation> auto& separation) {
  archive.object(field("primitive_a", separation.primitive_a), field("primitive_b", separation.primitive_b),
                 field("vector", separation.vector), field("on_a", separation.on_a), field("on_b", separation.on_b));
}

void describe(const auto& archive, Of<std::vector<SectionCut>> auto& cuts) {
  archive.letters(cuts, ".ab", "must consist of the letters a, b and .");
}

void describe(const auto& archive, Of<SectionPlane> auto& plane) {
  auto& [x, y, z] = plane.normal;
  archive.array("must be an array of 5 numbers", x, y, z, plane.slope_a, plane.slope_b);
}

void describe(const auto& archive, Of<DividedSeparation> auto& division) {
  archive.object(field("primitive_a", division.primitive_a), field("primitive_b", division.primitive_b),
                 field("cuts", division.cuts), field("planes", division.planes));
  const auto expected = std::ranges::count(division.cuts, SectionCut::none);
  archive.require(std::ssize(division.planes) == expected, "planes", "must be {} planes, one for each . of the cuts",
                  expected);
}

void describe(const auto& archive, Of<EnclosingBall> auto& ball) {
  archive.object(field("primitive", ball.primitive), field("centre", ball.centre), field("multiplier", ball.multiplier),
                 field("distance", ball.distance), certificate_fields(ball.proof));
}

void describe(const auto& archive, Of<SurroundedPrimitive> auto& surrounded) {
  archive.object(field("primitive", surrounded.primitive), field("distance", surrounded.distance),
                 field("cover", surrounded.cover));
}

inline constexpr auto as_near_points = [](const auto& archive, auto& points) {
  archive.object(field("on_a", points[0]), field("on_b", points[1]));
};

void describe(const auto& archive, Of<PairCertificate> auto& proof) {
  archive.object(field("separations", proof.separations), unless_empty(field("divisions", proof.divisions)),
                 unless_empty(field("balls_a", proof.balls_a)), unless_empty(field("balls_b", proof.balls_b)),
                 unless_empty(field("covers_a", proof.covers_a)), unless_empty(field("covers_b", proof.covers_b)),
                 field_by("near_points", proof.near_points, as_near_points), field("common", proof.common));
  const auto primitives = [](const auto& of_two) { return std::pair(of_two.primitive_a, of_two.primitive_b); };
  const auto primitive = [](const auto& of_one) { return of_one.primitive; };
  const auto require_distinct = [&](const char* key, const auto& list, const auto& of, const auto& otherwise) {
    archive.each(key, "", list, distinct(list, of), "{}", otherwise);
  };
  constexpr const char* separated = "these two primitives have been separated before";
  require_distinct("separations", proof.separations, primitives, separated);
  require_distinct("divisions", proof.divisions, primitives, separated);
  require_distinct("balls_a", proof.balls_a, primitive, "this primitive has a ball before");
  require_distinct("balls_b", proof.balls_b, primitive, "this primitive has a ball before");
  require_distinct("covers_a", proof.covers_a, primitive, "this primitive has a cover before");
  require_distinct("covers_b", proof.covers_b, primitive, "this primitive has a cover before");
}

// Proofs of penetration depths.

inline constexpr auto as_triangle = [](const auto& archive, auto& corners) {
  archive.array("must be three indices of vertices", corners[0], corners[1], corners[2]);
};
inline constexpr auto as_triangles = [](const auto& archive, auto& triangles) { archive.list(as_triangle, triangles); };

void describe(const auto& archive, Of<DifferenceSurface> auto& difference) {
  archive.object(field("primitive_a", difference.primitive_a), field("primitive_b", difference.primitive_b),
                 field("vertices", difference.surface.vertices), field("on_a", difference.on_a),
                 field_by("triangles", difference.surface.triangles, as_triangles));
  const std::size_t vertices = difference.surface.vertices.size();
  archive.require(difference.on_a.size() == vertices, "on_a", "must be {} points, one for each vertex", vertices);
  const auto in_range = [&](std::size_t i) { return std::ranges::max(difference.surface.triangles[i]) < vertices; };
  archive.each("triangles", "", difference.surface.triangles, in_range, "must be indices below {}", vertices);
}

void describe(const auto& archive, Of<InnerBall> auto& ball) {
  archive.object(field("centre", ball.centre), field("radius", ball.radius, nonnegative),
                 certificate_fields(ball.proof));
}

inline constexpr auto as_balls = [](const auto& archive, auto& balls) {
  archive.object(field("in_a", balls[0]), field("in_b", balls[1]));
};

void describe(const auto& archive, Of<PartingTranslation> auto& parting) {
  archive.object(field("translation", parting.translation), field("proof", parting.proof));
}

void describe(const auto& archive, Of<PenetrationCertificate> auto& proof) {
  archive.object(field("direction", proof.direction), field("parting", proof.parting), field("surface", proof.surface),
                 field_by("balls", proof.balls, as_balls));
}

void describe(const auto& archive, Of<CertifiedPenetration> auto& penetration) {
  archive.object(field("depth", penetration.depth), field("proof", penetration.certificate));
}

// The kinds `pair` and `poses`.

template <class Posed>
auto fields_of_posed(Posed& answer) {
  return std::tuple_cat(field("pose", answer.pose), field("distance", answer.distance),
                        field("proof", answer.certificate));
}

void describe(const auto& archive, Of<PairAnswer> auto& answer) {
  archive.object(head_of_two_models(answer), fields_of_posed(answer), field("penetration", answer.penetration));
}

void describe(const auto& archive, Of<PosedAnswer> auto& answer) {
  archive.object(fields_of_posed(answer));
}

void describe(const auto& archive, Of<PoseAnswers> auto& answer) {
  archive.object(head_of_two_models(answer), lines("answers", answer.answers, "poses"));
  archive.require(!answer.answers.empty(), "answers", "must not be empty");
}

// The kind `path`.

inline constexpr auto as_nearest = [](const auto& archive, auto& certificate) {
  archive.object(field("time", certificate.nearest, nonnegative), field("proof", certificate.at_nearest));
};

void describe(const auto& archive, Of<PathPart> auto& part) {
  archive.object(field("until", part.until, nonnegative), field("proof", part.certificate));
}

void describe(const auto& archive, Of<PathAnswer> auto& answer) {
  archive.object(head_of_two_models(answer), field("path", answer.path, not_empty),
                 field("smallest", answer.claims.smallest), field("first_contact", answer.claims.first_contact),
                 field_by("nearest", answer.certificate, as_nearest),
                 lines("parts", answer.certificate.parts, "poses"));
}

}  // namespace verisq::certificates
