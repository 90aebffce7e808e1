/// Vertices and triangles are read one by one; what proves them need not prove anything.
#include "host/files/deviation_answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "host/files/certificate_fields.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

constexpr std::string_view letters = ".ch";             // of PieceProof
constexpr std::string_view letters_of_patch = ".oarw";  // of PatchProof

CertifiedEnclosure distance_and_certificate(const JsonValue& value) {
  return {{value.at("lo").number_or_infinity(), value.at("hi").number_or_infinity()}, read_certificate(value)};
}

CertifiedPoint read_point(const JsonValue& value) {
  value.check_keys({"point", "lo", "hi", "normals", "escape", "witness", "cover"});
  return {finite_numbers<3>(value.at("point")), distance_and_certificate(value)};
}

std::vector<CertifiedEnclosure> read_samples(const JsonValue& value) {
  std::vector<CertifiedEnclosure> samples;
  samples.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) samples.push_back(read_sample(value.element(i)));
  return samples;
}

template <class Proof>
std::vector<Proof> read_letters(const JsonValue& value, std::string_view of, const char* otherwise) {
  std::vector<Proof> proofs;
  for (const char letter : value.text()) {
    const std::size_t index = of.find(letter);
    if (index == std::string_view::npos) value.fail(otherwise);
    proofs.push_back(static_cast<Proof>(index));
  }
  return proofs;
}

template <class Proof>
std::string text_by(const std::vector<Proof>& proofs, std::string_view of) {
  std::string text;
  for (const Proof proof : proofs) text += of[static_cast<std::size_t>(proof)];
  return text;
}

std::vector<double> read_percentiles(const JsonValue& value) {
  std::vector<double> percentiles;
  for (std::size_t i = 0; i < value.size(); ++i) {
    percentiles.push_back(value.element(i).number());
    if (!(percentiles.back() > 0.0 && percentiles.back() <= 100.0)) {
      value.element(i).fail("must be above 0, and at most 100");
    }
  }
  return percentiles;
}

std::vector<Enclosure> read_percentile_claims(const JsonValue& value, std::size_t percentiles) {
  if (value.size() != percentiles) value.fail(fmt::format("must be {} claims", percentiles));
  std::vector<Enclosure> claims;
  for (std::size_t i = 0; i < percentiles; ++i) claims.push_back(read_claim(value.element(i)));
  return claims;
}

DistanceSummary read_summary(const JsonValue& value, std::size_t percentiles) {
  value.check_keys({"largest", "mean", "percentiles"});
  return {read_claim(value.at("largest")), read_claim(value.at("mean")),
          read_percentile_claims(value.at("percentiles"), percentiles)};
}

/// As many as the patches have this letter.
std::vector<CertifiedPoint> read_points(const JsonValue& value, const std::vector<std::vector<PatchProof>>& patches,
                                        PatchProof letter) {
  std::size_t expected = 0;
  for (const std::vector<PatchProof>& of_primitive : patches)
    expected += static_cast<std::size_t>(std::ranges::count(of_primitive, letter));
  if (value.size() != expected) {
    value.fail(fmt::format("must be {} points, one for each {}", expected,
                           letters_of_patch[static_cast<std::size_t>(letter)]));
  }
  std::vector<CertifiedPoint> points;
  points.reserve(expected);
  for (std::size_t i = 0; i < expected; ++i) points.push_back(read_point(value.element(i)));
  return points;
}

SurfaceProof read_surface(const JsonValue& value) {
  value.check_keys({"within", "farthest", "patches", "off", "on"});
  return {.within = value.at("within").number(),
          .cover = read_surface_cover(value),
          .farthest = read_point(value.at("farthest"))};
}

/// All of it, or nothing: files of before have none.
void read_other_way(const JsonValue& root, DeviationAnswer& answer) {
  const auto surface = root.find("surface");
  if (!surface) {
    for (const char* const key : {"from_model", "hausdorff"}) {
      if (const auto claim = root.find(key)) claim->fail("must not be there without \"surface\"");
    }
    return;
  }
  const JsonValue from_model = root.at("from_model");
  from_model.check_keys({"largest", "mean", "percentiles"});
  answer.from_model = read_claim(from_model.at("largest"));
  if (const auto mean = from_model.find("mean")) {
    answer.statistics_from_model = {read_claim(*mean),
                                    read_percentile_claims(from_model.at("percentiles"), answer.percentiles.size())};
  } else if (const auto percentiles = from_model.find("percentiles")) {
    percentiles->fail("must not be there without \"mean\"");
  }
  answer.hausdorff = read_claim(root.at("hausdorff"));
  answer.certificate.surface = read_surface(*surface);
}

}  // namespace

CertifiedEnclosure read_sample(const JsonValue& value) {
  value.check_keys({"lo", "hi", "normals", "escape", "witness", "cover"});
  return distance_and_certificate(value);
}

TriangleProof read_triangle_proof(const JsonValue& value) {
  TriangleProof proof;
  const JsonValue pieces = value.at("pieces");
  proof.pieces = read_letters<PieceProof>(pieces, letters, "must consist of the letters c, h and .");
  const auto samples = value.find("samples");
  if (samples) proof.samples = read_samples(*samples);
  const auto expected = proof.pieces.size() - std::ranges::count(proof.pieces, PieceProof::corners);
  if (proof.samples.size() != expected) {
    samples.value_or(pieces).fail(fmt::format("must be of {} samples, one for each c and h", expected));
  }
  return proof;
}

SurfaceCover read_surface_cover(const JsonValue& value) {
  SurfaceCover cover;
  const JsonValue patches = value.at("patches");
  for (std::size_t k = 0; k < patches.size(); ++k) {
    cover.patches.push_back(
        read_letters<PatchProof>(patches.element(k), letters_of_patch, "must consist of the letters a, r, o, w and ."));
  }
  cover.off = read_points(value.at("off"), cover.patches, PatchProof::off);
  const auto on = value.find("on");
  if (on) cover.on = read_points(*on, cover.patches, PatchProof::on);
  const auto is_on = [](const std::vector<PatchProof>& of) { return std::ranges::count(of, PatchProof::on) > 0; };
  if (!on && std::ranges::any_of(cover.patches, is_on)) patches.fail("must not have a w without \"on\"");
  return cover;
}

DeviationAnswer read_deviation(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "mesh", "units", "pose", "percentiles", "of_vertices", "from_mesh",
                   "from_model", "hausdorff", "vertices", "triangles", "surface"});
  const JsonValue models = root.at("models");
  if (models.size() != 1) models.fail("must be an array of one model");
  DeviationAnswer answer{.model = read_subject_file(models.element(0)),
                         .mesh = read_subject_file(root.at("mesh")),
                         .units = units_of(root),
                         .pose = {},
                         .percentiles = read_percentiles(root.at("percentiles")),
                         .of_vertices = {},
                         .from_mesh = {},
                         .certificate = {read_samples(root.at("vertices")), {}, {}}};
  if (const auto pose = root.find("pose")) answer.pose = read_pose_object(*pose);
  answer.of_vertices = read_summary(root.at("of_vertices"), answer.percentiles.size());
  if (answer.certificate.vertices.empty()) root.at("vertices").fail("must not be empty");
  const JsonValue triangles = root.at("triangles");
  const auto from_mesh = root.find("from_mesh");
  if (from_mesh.has_value() != (triangles.size() > 0)) {
    triangles.fail("must not be empty where there is \"from_mesh\", and only there");
  }
  if (from_mesh) answer.from_mesh = read_summary(*from_mesh, answer.percentiles.size());
  answer.certificate.triangles.reserve(triangles.size());
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    triangles.element(n).check_keys({"pieces", "samples"});
    answer.certificate.triangles.push_back(read_triangle_proof(triangles.element(n)));
  }
  read_other_way(root, answer);
  return answer;
}

std::string text_of(const std::vector<PieceProof>& pieces) {
  return text_by(pieces, letters);
}

std::string text_of(const std::vector<PatchProof>& patches) {
  return text_by(patches, letters_of_patch);
}

}  // namespace verisq
