/// Describes the kinds `deviation`, `contact` and `containment` of certificate files (docs/formats.md §9).
#pragma once

#include <algorithm>

#include "host/files/certificate_archive.hpp"
#include "host/files/fit_answer.hpp"
#include "host/files/pair_answer.hpp"

namespace verisq::certificates {

template <>
inline constexpr Kind kind_of<DeviationAnswer>{"deviation"};
template <>
inline constexpr Kind kind_of<ContactAnswer>{"contact"};
template <>
inline constexpr Kind kind_of<ContainmentAnswer>{"containment", 2};

// Proofs of distances of all points of triangles, and of a model's surface.

void describe(const auto& archive, Of<std::vector<PieceProof>> auto& pieces) {
  archive.letters(pieces, ".ch", "must consist of the letters c, h and .");
}

auto fields_of(Of<TriangleProof> auto& proof) {
  return std::tuple_cat(field("pieces", proof.pieces), unless_empty(field("samples", proof.samples)));
}

void require_samples(const auto& archive, const TriangleProof& proof) {
  const auto with_sample = [](PieceProof piece) { return piece != PieceProof::corners; };
  const auto expected = std::ranges::count_if(proof.pieces, with_sample);
  archive.require(std::ssize(proof.samples) == expected, archive.has("samples") ? "samples" : "pieces",
                  "must be of {} samples, one for each c and h", expected);
}

void describe(const auto& archive, Of<TriangleProof> auto& proof) {
  archive.object(fields_of(proof));
  require_samples(archive, proof);
}

void describe(const auto& archive, Of<std::vector<PatchProof>> auto& patches) {
  archive.letters(patches, ".oarw", "must consist of the letters a, r, o, w and .");
}

void describe(const auto& archive, Of<CertifiedPoint> auto& point) {
  archive.object(field("point", point.point), sample_fields(point.signed_distance));
}

auto fields_of(Of<SurfaceCover> auto& cover) {
  return std::tuple_cat(field("patches", cover.patches), field("off", cover.off), unless_empty(field("on", cover.on)));
}

/// Requires as many points as patches need.
void require_points(const auto& archive, const SurfaceCover& cover) {
  std::ptrdiff_t off = 0;
  std::ptrdiff_t on = 0;
  for (const std::vector<PatchProof>& patches : cover.patches) {
    off += std::ranges::count(patches, PatchProof::off);
    on += std::ranges::count(patches, PatchProof::on);
  }
  archive.require(std::ssize(cover.off) == off, "off", "must be {} points, one for each o", off);
  archive.require(on == 0 || archive.has("on"), "patches", "must not have a w without \"on\"");
  archive.require(std::ssize(cover.on) == on, "on", "must be {} points, one for each w", on);
}

// The kind `deviation`.

inline void are_percentiles(const JsonValue& where) {
  for (std::size_t i = 0; i < where.size(); ++i) {
    const double percent = where.element(i).number();
    if (!(percent > 0.0 && percent <= 100.0)) where.element(i).fail("must be above 0, and at most 100");
  }
}

void require_claims(const auto& archive, std::string_view place, const std::vector<Enclosure>& claims,
                    const DeviationAnswer& answer) {
  archive.require(claims.size() == answer.percentiles.size(), place, "must be {} claims", answer.percentiles.size());
}

void describe(const auto& archive, Of<DistanceSummary> auto& summary) {
  archive.object(field("largest", summary.largest), field("mean", summary.mean),
                 field("percentiles", summary.percentiles));
}

/// Claims about the model's surface: the largest distance and, both or neither, mean and percentiles.
template <class Archive>
void describe_from_model(const Archive& archive, Of<Enclosure> auto& largest,
                         Of<std::optional<AreaStatistics>> auto& statistics) {
  std::optional<Enclosure> mean;
  std::optional<std::vector<Enclosure>> percentiles;
  if (statistics) mean = statistics->mean;
  if (statistics) percentiles = statistics->percentiles;
  archive.object(field("largest", largest), field("mean", mean), beside("mean", field("percentiles", percentiles)));
  if constexpr (Archive::reads) {
    if (mean) statistics = {*mean, *percentiles};
  }
}

void describe(const auto& archive, Of<SurfaceProof> auto& proof) {
  archive.object(field("within", proof.within), field("farthest", proof.farthest), fields_of(proof.cover),
                 unless_empty(field("triangles", proof.triangles)));
  require_points(archive, proof.cover);
}

void describe(const auto& archive, Of<DeviationAnswer> auto& answer) {
  auto& [vertices, triangles, surface] = answer.certificate;
  const auto as_from_model = [&](const auto& of_model, auto& largest) {
    describe_from_model(of_model, largest, answer.statistics_from_model);
  };
  archive.object(head_of_model_and_mesh(answer), field("pose", answer.pose),
                 field("percentiles", answer.percentiles, are_percentiles), field("of_vertices", answer.of_vertices),
                 field("from_mesh", answer.from_mesh),
                 beside("surface", field_by("from_model", answer.from_model, as_from_model)),
                 beside("surface", field("hausdorff", answer.hausdorff)), field("surface", surface),
                 lines("vertices", vertices, "vertices"), lines("triangles", triangles, "triangles"));
  require_claims(archive, "of_vertices.percentiles", answer.of_vertices.percentiles, answer);
  archive.require(!vertices.empty(), "vertices", "must not be empty");
  archive.require(answer.from_mesh.has_value() == !triangles.empty(), "triangles",
                  "must not be empty where there is \"from_mesh\", and only there");
  if (const auto& mesh = answer.from_mesh) require_claims(archive, "from_mesh.percentiles", mesh->percentiles, answer);
  if (const auto& model = answer.statistics_from_model)
    require_claims(archive, "from_model.percentiles", model->percentiles, answer);
}

// The kind `contact`.

inline void are_names(const JsonValue& where) {
  for (std::size_t i = 0; i < where.size(); ++i) (void)where.element(i).name();
}

void describe(const auto& archive, Of<ContactClaim> auto& claim) {
  archive.object(field("area", claim.area), field("within", claim.within), field("percent", claim.percent));
}

/// A sample, or the index of a vertex that has one.
template <class Archive>
void describe(const Archive& archive, Of<VertexProof> auto& proof) {
  if (!archive.is_object(proof.own.has_value())) return archive.plain(proof.told_by);
  if constexpr (Archive::reads) proof.own.emplace();
  describe(archive, *proof.own);
}

void describe(const auto& archive, Of<DividedTriangle> auto& divided) {
  archive.object(field("triangle", divided.triangle), fields_of(divided.proof));
  require_samples(archive, divided.proof);
}

/// `counted` has a flag for each primitive whose surface counts; the file names the flagged ones, in their order.
template <class Archive>
void describe_counted(const Archive& archive, Of<SurfaceCover> auto& cover, Of<std::vector<bool>> auto& counted) {
  std::vector<std::uint32_t> primitives;
  for (std::size_t k = 0; k < counted.size(); ++k) {
    if (counted[k]) primitives.push_back(static_cast<std::uint32_t>(k));
  }
  archive.object(field("primitives", primitives, not_empty), fields_of(cover));
  require_points(archive, cover);
  const std::size_t count = cover.patches.size();
  const auto is_there = [&](std::size_t i) { return primitives[i] < count; };
  archive.each("primitives", "", primitives, is_there, "must be below {}", count);
  archive.each("primitives", "", primitives, ascending(primitives), "must be above those before");
  if constexpr (Archive::reads) {
    counted.assign(count, false);
    for (const std::uint32_t primitive : primitives) counted[primitive] = true;
  }
}

void describe(const auto& archive, Of<ContactAnswer> auto& answer) {
  auto& [vertices, triangles, surface] = answer.certificate;
  auto& [of_mesh, by_region, of_model] = answer.claims;
  const auto as_counted = [&](const auto& object, auto& cover) { describe_counted(object, cover, answer.counted); };
  archive.object(head_of_model_and_mesh(answer), field("distance", answer.distance, nonnegative),
                 field("regions", answer.regions, are_names), field("region_runs", answer.region_runs),
                 field("of_mesh", of_mesh), field("by_region", by_region),
                 beside("surface", field("of_model", of_model)), field_by("surface", surface, as_counted),
                 lines("vertices", vertices, "vertices"), lines("triangles", triangles, "triangles"));
  archive.each("regions", "", answer.regions, distinct(answer.regions), "is the name of a region before");
  const std::size_t regions = answer.regions.size();
  require_runs(archive, "region_runs", answer.region_runs, regions);
  archive.require(by_region.size() == regions, "by_region", "must be {} claims, one a region", regions);
  const auto is_told = [&proofs = answer.certificate.vertices](std::size_t i) {
    return proofs[i].own || (proofs[i].told_by < proofs.size() && proofs[proofs[i].told_by].own);
  };
  archive.each("vertices", "", vertices, is_told, "must be the index of a vertex that has a certificate");
  archive.each("triangles", ".triangle", triangles, ascending(triangles, &DividedTriangle::triangle),
               "must be above those before");
}

// The kind `containment`.

void describe(const auto& archive, Of<Containment> auto& containment) {
  archive.word(containment, {{"within", Containment::within}, {"around", Containment::around}},
               "must be \"within\" or \"around\"");
}

void describe(const auto& archive, Of<CommonPoint> auto& common) {
  const auto as_primitives = [](const auto& of_four, auto& four) {
    of_four.array("must be an array of four indices", four[0], four[1], four[2], four[3]);
  };
  archive.object(field_by("primitives", common.primitives, as_primitives), field("point", common.point));
}

void describe(const auto& archive, Of<ContainmentAnswer> auto& answer) {
  auto& [apart, common] = answer.certificate;
  archive.object(head_of_model_and_mesh(answer), field("containment", answer.containment),
                 unless_empty(field("apart", apart)), unless_empty(field("common", common)));
}

}  // namespace verisq::certificates
