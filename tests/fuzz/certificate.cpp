/// Fuzz target of parse_answer.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>
#include <verisq/certificate_file.hpp>

#include "tests/fuzz/promise.hpp"
#include "tests/fuzz/targets.hpp"

namespace verisq::fuzz {

namespace {

bool finite(const Point& x) {
  return std::ranges::all_of(x, [](double c) { return std::isfinite(c); });
}

void check_certificate(const PairCertificate& certificate) {
  check(!certificate.common || finite(*certificate.common), "a common point is finite");
  for (const Separation& separation : certificate.separations) {
    check(finite(separation.vector) && finite(separation.on_a) && finite(separation.on_b), "separations are finite");
  }
  for (const DividedSeparation& division : certificate.divisions) {
    const auto uncut = std::ranges::count(division.cuts, SectionCut::none);
    check(division.planes.size() == static_cast<std::size_t>(uncut), "each pair of sections has a plane");
    for (const auto& [normal, slope_a, slope_b] : division.planes)
      check(finite({slope_a, slope_b, 0.0}) && finite(normal), "planes are finite");
  }
  for (const auto* const balls : {&certificate.balls_a, &certificate.balls_b}) {
    for (const EnclosingBall& ball : *balls)
      check(finite(ball.centre) && finite({ball.multiplier, ball.distance, 0.0}), "balls are finite");
  }
  for (const auto* const covers : {&certificate.covers_a, &certificate.covers_b}) {
    for (const SurroundedPrimitive& of : *covers)
      check(std::isfinite(of.distance) && !of.cover.empty(), "a cover has a cell");
  }
  if (const auto& near = certificate.near_points) {
    check(finite((*near)[0]) && finite((*near)[1]), "near points are finite");
  }
}

void check_pose(const Pose& pose) {
  check(finite(pose.translation), "a pose is finite");
  check(std::ranges::any_of(pose.quaternion, [](double c) { return c != 0.0; }), "a quaternion is not zero");
}

/// Of a pair, or of one of many poses.
template <class Posed>
void check_claim(const Posed& answer) {
  check(!std::isnan(answer.distance.lo) && !std::isnan(answer.distance.hi), "a claim has two ends");
  check_pose(answer.pose);
  check_certificate(answer.certificate);
}

void check_answer(const PathAnswer& answer) {
  check(!answer.path.empty(), "there is a path");
  for (const Pose& pose : answer.path) check_pose(pose);
  const auto has_ends = [](const Enclosure& claim) { return !std::isnan(claim.lo) && !std::isnan(claim.hi); };
  check(has_ends(answer.claims.smallest), "a claim has two ends");
  check(!answer.claims.first_contact || has_ends(*answer.claims.first_contact), "a claim has two ends");
  check(answer.certificate.nearest >= 0.0, "a time is not negative");
  check_certificate(answer.certificate.at_nearest);
  for (const PathPart& part : answer.certificate.parts) {
    check(part.until >= 0.0, "a time is not negative");
    check_certificate(part.certificate);
  }
}

void check_answer(const PairAnswer& answer) {
  check_claim(answer);
}

void check_answer(const PoseAnswers& answers) {
  check(!answers.answers.empty(), "there are poses");
  for (const PosedAnswer& answer : answers.answers) check_claim(answer);
}

void check_terms(const StatedTerms& terms) {
  check(terms.fitness.scale > 0.0 && terms.penetration_limit >= 0.0, "a criterion is one");
  for (const AreaRun& run : terms.area_runs) check(run.area < terms.areas.size(), "an area is there");
  check(points_of(terms) <= std::uint64_t{1} << 32U, "as many points as a mesh may have");
}

void check_answer(const BestFitAnswer& answer) {
  check_terms(answer.terms);
  check(!answer.models.empty() && answer.centres.size() == answer.models.size(), "each implant has a centre");
  check(answer.certificate.ranges.size() == answer.models.size(), "each implant's range is divided");
  check_pose(answer.range.start);
  check(answer.range.translation >= 0.0 && answer.range.rotation_degrees <= 180.0, "a range is one");
  check(!std::isnan(answer.upper), "a claim is a number");
}

void check_answer(const FitAnswer& answer) {
  check(!answer.claims.empty(), "something is claimed");
  check_terms(answer.terms);
  for (const ClearanceClaim& claim : answer.claims) {
    check(!std::isnan(claim.value.lo) && !std::isnan(claim.value.hi), "a claim has two ends");
  }
  for (const SideClaim& claim : answer.sides) check(claim.side != SurfaceSide::any, "a side is one");
}

void check_answer(const InsertionAnswer& answer) {
  check(!answer.path.empty() && (!answer.rows.empty() || answer.removed), "there are a way, and vertices or a volume");
  if (const auto& removed = answer.removed) {
    check(!std::isnan(removed->volume.lo) && !std::isnan(removed->volume.hi), "a claim has two ends");
    check(finite(removed->certificate.centre) && removed->certificate.half_width >= 0.0, "a cube is finite");
    check(removed->certificate.cubes.size() <= most_cubes_of_certificate, "cubes are not too many");
    if (const auto& plane = removed->resection)
      check(finite(plane->point) && finite(plane->normal) && plane->normal != Point{}, "a resection is a plane");
  }
  for (const Pose& pose : answer.path) check_pose(pose);
  for (const auto& [claim, certificate] : answer.rows) {
    check(!std::isnan(claim.lo) && !std::isnan(claim.hi), "a claim has two ends");
    check(certificate.deepest >= 0.0, "a time is not negative");
    for (const WayPart& part : certificate.parts)
      check(part.until >= 0.0 && finite(part.segment[0]) && finite(part.segment[1]), "a part of a way is finite");
  }
}

void check_summary(const DistanceSummary& summary, std::size_t percentiles) {
  check(summary.percentiles.size() == percentiles, "each percentile is claimed");
  check(!std::isnan(summary.largest.lo) && !std::isnan(summary.mean.hi), "a claim has two ends");
}

void check_cover(const SurfaceCover& cover) {
  std::ptrdiff_t off = 0;
  std::ptrdiff_t on = 0;
  for (const std::vector<PatchProof>& patches : cover.patches) {
    off += std::ranges::count(patches, PatchProof::off);
    on += std::ranges::count(patches, PatchProof::on);
  }
  check(cover.off.size() == static_cast<std::size_t>(off), "each patch off the boundary has a point");
  check(cover.on.size() == static_cast<std::size_t>(on), "each patch on the boundary has a point");
}

void check_answer(const DeviationAnswer& answer) {
  const auto& [vertices, triangles, surface] = answer.certificate;
  check(!vertices.empty(), "there are vertices");
  check(answer.from_mesh.has_value() == !triangles.empty(), "triangles are claimed where there are some");
  check_summary(answer.of_vertices, answer.percentiles.size());
  if (answer.from_mesh) check_summary(*answer.from_mesh, answer.percentiles.size());
  for (const auto& [pieces, samples] : triangles) {
    const auto with = pieces.size() - static_cast<std::size_t>(std::ranges::count(pieces, PieceProof::corners));
    check(samples.size() == with, "each piece that needs one has a sample");
  }
  check(answer.from_model.has_value() == surface.has_value() && answer.hausdorff.has_value() == surface.has_value(),
        "what is claimed of the model's surface has patches");
  check(!answer.statistics_from_model || surface, "so has what is claimed of its mean");
  if (surface) check_cover(surface->cover);
}

void check_answer(const ContainmentAnswer& answer) {
  for (const Separation& separation : answer.certificate.apart) check(finite(separation.vector), "a vector is finite");
  for (const CommonPoint& common : answer.certificate.common) check(finite(common.point), "a common point is finite");
}

void check_answer(const ContactAnswer& answer) {
  check(answer.distance >= 0.0, "a distance is not negative");
  check(answer.claims.by_region.size() == answer.regions.size(), "each region is claimed");
  for (const AreaRun& run : answer.region_runs) check(run.area < answer.regions.size(), "a region is there");
  check(points_of(answer.region_runs) <= std::uint64_t{1} << 32U, "as many triangles as a mesh may have");
  check(!std::isnan(answer.claims.of_mesh.within.lo), "a claim has two ends");
  const auto& [vertices, triangles, surface] = answer.certificate;
  check(answer.claims.of_model.has_value() == surface.has_value(),
        "what is claimed of the model's surface has patches");
  if (surface) check_cover(*surface);
  check(!surface || answer.counted.size() == surface->patches.size(), "each primitive counts, or does not");
  for (const auto& [own, told_by] : vertices)
    check(own || (told_by < vertices.size() && vertices[told_by].own), "a vertex is told");
  for (const auto& [triangle, proof] : triangles) {
    const auto without = std::ranges::count(proof.pieces, PieceProof::corners);
    check(proof.samples.size() + static_cast<std::size_t>(without) == proof.pieces.size(),
          "each piece that needs one has a sample");
  }
}

void check_answer(const FeaturesAnswer& answer) {
  const FeatureClaims& claims = answer.claims;
  check(claims.landmark_radius >= 0.0, "a radius is not negative");
  check(claims.implant.has_value() == answer.implant.has_value(), "an implant is a model with points");
  const std::vector<Finding> findings = verisq::check(claims).all();
  check(findings.size() == claims.features.size() + claims.changes.size() + (claims.frame ? 3 : 0), "all are judged");
}

void check_answer(const EquilibriumAnswer& answer) {
  const auto is_range = [](const Enclosure& range) { return std::isfinite(range.width()) && range.lo <= range.hi; };
  check(answer.parameters.size() == answer.claims.ranges.size(), "each range has a parameter");
  check(std::ranges::all_of(answer.claims.ranges, is_range), "a box is finite");
  check(answer.claims.stands >= 0.0 && answer.claims.stands <= 1.0, "a share is one");
  check(finite(answer.certificate.reference), "a reference point is finite");
  if (const auto& standing = answer.claims.standing) {
    check(standing->positions.size() == answer.joints.size() && standing->torques.size() == answer.joints.size() &&
              standing->loads.size() == answer.cylinders.size(),
          "each claim has a name");
    const auto has_ends = [](const Enclosure& claim) { return !std::isnan(claim.lo) && !std::isnan(claim.hi); };
    check(std::ranges::all_of(stance::numbers_of(*standing), has_ends), "a claim has two ends");
  }
  std::size_t expected = 1;
  for (const auto& [halved, postures] : answer.certificate.parts) {
    check(expected > 0 && (!halved || *halved < answer.parameters.size()), "parts are a tree of the box");
    check(std::ranges::all_of(postures, is_range) && (!halved || postures.empty()), "postures are of undivided parts");
    expected += halved ? 1U : 0U;
    expected -= halved ? 0U : 1U;
  }
  check(expected == 0, "the tree is whole");
}

std::vector<SubjectFile> subjects_of(const EquilibriumAnswer& answer) {
  return {answer.model};
}

std::vector<SubjectFile> subjects_of(const DeviationAnswer& answer) {
  return {answer.model, answer.mesh};
}

std::vector<SubjectFile> subjects_of(const ContainmentAnswer& answer) {
  return {answer.model, answer.mesh};
}

std::vector<SubjectFile> subjects_of(const ContactAnswer& answer) {
  return {answer.model, answer.mesh};
}

std::vector<SubjectFile> subjects_of(const FeaturesAnswer& answer) {
  std::vector<SubjectFile> subjects;
  if (answer.implant) subjects.push_back(*answer.implant);
  if (answer.mesh) subjects.push_back(*answer.mesh);
  return subjects;
}

std::vector<SubjectFile> subjects_of(const FitAnswer& answer) {
  return {answer.model, answer.mesh};
}

std::vector<SubjectFile> subjects_of(const BestFitAnswer& answer) {
  std::vector<SubjectFile> subjects = answer.models;
  subjects.push_back(answer.mesh);
  return subjects;
}

std::vector<SubjectFile> subjects_of(const InsertionAnswer& answer) {
  std::vector<SubjectFile> subjects{answer.model, answer.mesh};
  if (answer.removed && answer.removed->within) subjects.push_back(*answer.removed->within);
  return subjects;
}

template <class Posed>
std::vector<SubjectFile> subjects_of(const Posed& answer) {
  return {answer.models.begin(), answer.models.end()};
}

void check_any(const Answer& answer) {
  std::visit(
      [](const auto& kind) {
        for (const SubjectFile& file : subjects_of(kind)) check(file.sha256.size() == 64, "a digest has 64 digits");
        check_answer(kind);
      },
      answer);
}

}  // namespace

void certificate(Bytes bytes) {
  const std::string name = "certificate.json";
  const std::string json(bytes.begin(), bytes.end());  // a copy, so that reading past its end shows
  read_or_refuse(name, [&] { check_any(parse_answer(json, name)); });
}

}  // namespace verisq::fuzz
