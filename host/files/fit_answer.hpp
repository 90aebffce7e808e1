/// Describes the kinds `fit`, `best_fit` and `insertion` of certificate files (docs/formats.md §9).
#pragma once

#include "host/files/certificate_archive.hpp"

namespace verisq::certificates {

template <>
inline constexpr Kind kind_of<FitAnswer>{"fit"};
template <>
inline constexpr Kind kind_of<BestFitAnswer>{"best_fit"};
template <>
inline constexpr Kind kind_of<InsertionAnswer>{"insertion"};

// Values that fits and areas in contact have in common.

void describe(const auto& archive, Of<AreaRun> auto& run) {
  archive.array("must be an area's index and a number of points", run.area, run.points);
}

/// Requires that the runs name `areas` areas, and in all no more points than a mesh has indices for.
void require_runs(const auto& archive, std::string_view key, const std::vector<AreaRun>& runs, std::size_t areas) {
  constexpr std::uint64_t most_points = std::uint64_t{1} << 32U;
  const auto of_an_area = [&](std::size_t i) { return runs[i].area < areas; };
  archive.each(key, "[0]", runs, of_an_area, "must be below {}, the number of areas", areas);
  const auto in_memory = [&, points = std::uint64_t{0}](std::size_t i) mutable {
    return (points += runs[i].points) <= most_points;
  };
  archive.each(key, "", runs, in_memory, "must leave no more than {} points in all", most_points);
}

void describe(const auto& archive, Of<Area> auto& area) {
  archive.object(field("name", area.name, shown_name), field("weight", area.weight, nonnegative));
}

void describe(const auto& archive, Of<Fitness> auto& fitness) {
  archive.object(field("target", fitness.target, nonnegative), field("scale", fitness.scale),
                 field("serves", fitness.serves));
  archive.require(fitness.scale > 0.0, "scale", "must be above 0");
  archive.require(fitness.serves.lo <= fitness.serves.hi, "serves", "must have lo no larger than hi");
}

auto fields_of(Of<StatedTerms> auto& terms) {
  return std::tuple_cat(field("criterion", terms.fitness),
                        field("penetration_limit", terms.penetration_limit, nonnegative), field("areas", terms.areas),
                        field("area_runs", terms.area_runs));
}

void require_terms(const auto& archive, const StatedTerms& terms) {
  archive.each("areas", ".name", terms.areas, distinct(terms.areas, &Area::name), "is the name of an area before");
  require_runs(archive, "area_runs", terms.area_runs, terms.areas.size());
}

// The kind `fit`.

void describe(const auto& archive, Of<ClearanceClaim> auto& claim) {
  archive.object(field("what", claim.what, shown_name), unless_empty(field("area", claim.area, shown_name)),
                 claim_fields(claim.value));
}

void describe(const auto& archive, Of<SurfaceSide> auto& side) {
  archive.word(side, {{"inside", SurfaceSide::inside}, {"outside", SurfaceSide::outside}}, "must be inside or outside");
}

void describe(const auto& archive, Of<SideClaim> auto& claim) {
  archive.object(field("primitive", claim.primitive), field("side", claim.side, shown_name));
}

void describe(const auto& archive, Of<FitAnswer> auto& answer) {
  archive.object(head_of_model_and_mesh(answer), fields_of(answer.terms), field("claims", answer.claims, not_empty),
                 unless_empty(field("sides", answer.sides)));
  require_terms(archive, answer.terms);
  const auto claimed = [](const ClearanceClaim& claim) { return std::pair(claim.what, claim.area); };
  archive.each("claims", "", answer.claims, distinct(answer.claims, claimed), "is claimed before");
  archive.each("sides", "", answer.sides, distinct(answer.sides, &SideClaim::primitive), "is of a primitive before");
}

// The kind `best_fit`.

void describe(const auto& archive, Of<PoseRange> auto& range) {
  archive.object(field("start", range.start), field("translation", range.translation, nonnegative),
                 field("rotation_degrees", range.rotation_degrees, nonnegative));
  archive.require(range.rotation_degrees <= 180.0, "rotation_degrees", "must be at most 180");
}

void describe(const auto& archive, Of<std::vector<PoseDivision>> auto& divisions) {
  archive.letters(divisions, "xyzuvw.", "must consist of the letters x, y, z, u, v, w and .");
}

void describe(const auto& archive, Of<BestFitAnswer> auto& answer) {
  const std::vector<std::vector<PoseDivision>>& ranges = answer.certificate.ranges;
  archive.object(heading<BestFitAnswer>(), field("models", answer.models, not_empty), field("mesh", answer.mesh),
                 units_of(answer), fields_of(answer.terms), field("range", answer.range),
                 field("centres", answer.centres), field_by("upper", answer.upper, as_end),
                 field("ranges", answer.certificate.ranges));
  require_terms(archive, answer.terms);
  const std::size_t models = answer.models.size();
  archive.require(answer.upper < infinity, "upper", "must be a number, or \"-inf\"");
  archive.require(answer.centres.size() == models, "centres", "must be {}, one a model", models);
  archive.require(ranges.size() == models, "ranges", "must be {}, one a model", models);
}

// The kind `insertion`: distances along a way in.

/// A limit so that no row can require more work than it is worth.
inline constexpr std::size_t most_parts_of_row = 4096;

inline constexpr auto as_segment = [](const auto& archive, auto& ends) {
  archive.array("must be an array of two points", ends[0], ends[1]);
};

void describe(const auto& archive, Of<WayPart> auto& part) {
  archive.object(field("until", part.until, nonnegative), field_by("segment", part.segment, as_segment),
                 certificate_fields(part.certificate));
}

inline constexpr auto as_deepest = [](const auto& archive, auto& certificate) {
  archive.object(field("time", certificate.deepest, nonnegative), certificate_fields(certificate.at_deepest));
};

void describe(const auto& archive, Of<InsertionAnswer::Row> auto& row) {
  auto& parts = row.certificate.parts;
  archive.object(claim_fields(row.distance), field_by("deepest", row.certificate, as_deepest), field("parts", parts));
  archive.require(parts.size() <= most_parts_of_row, "parts", "must have no more than {} parts", most_parts_of_row);
}

// The proof of the whole surface.

void describe(const auto& archive, Of<std::vector<WayCell>> auto& cells) {
  archive.letters(cells, ".mqh", "must consist of the letters m, q, h and .");
}

void describe(const auto& archive, Of<MovedCell> auto& cell) {
  archive.object(field("step", cell.step), field("normals", cell.normals));
}

void describe(const auto& archive, Of<WayTriangle> auto& triangle) {
  archive.object(field("triangle", triangle.triangle), field("cells", triangle.cells), field("moved", triangle.moved));
}

void describe(const auto& archive, Of<WayWitness> auto& witness) {
  archive.object(field("triangle", witness.triangle), field("weights", witness.weights),
                 field("time", witness.time, nonnegative), certificate_fields(witness.certificate));
}

void describe(const auto& archive, Of<WaySurfaceAnswer> auto& surface) {
  auto& triangles = surface.certificate.triangles;
  archive.object(claim_fields(surface.distance), field("deepest", surface.certificate.deepest),
                 field("triangles", triangles));
  archive.each("triangles", ".triangle", triangles, ascending(triangles, &WayTriangle::triangle),
               "must be above those before");
  std::size_t cells = 0;
  for (const WayTriangle& triangle : triangles) cells += triangle.cells.size();
  archive.require(cells <= most_cells_of_way_surface, "triangles", "must have no more than {} cells",
                  most_cells_of_way_surface);
}

// The bone that is taken away.

void describe(const auto& archive, Of<BoneSide> auto& side) {
  archive.word(side, {{"inside", BoneSide::inside}, {"outside", BoneSide::outside}},
               "must be \"inside\" or \"outside\"");
}

void describe(const auto& archive, Of<Plane> auto& plane) {
  archive.object(field("point", plane.point), field("normal", plane.normal));
  archive.require(plane.normal != Point{}, "normal", "must not be zero");
}

void describe(const auto& archive, Of<std::vector<CubeDivision>> auto& cubes) {
  archive.letters(cubes, ".d", "must consist of the letters d and .");
}

void describe(const auto& archive, Of<RemovedVolumeCertificate> auto& certificate) {
  archive.object(field("centre", certificate.centre), field("half_width", certificate.half_width, nonnegative),
                 field("parts", certificate.cubes));
  archive.require(certificate.cubes.size() <= most_cubes_of_certificate, "parts", "must be no more than {} parts",
                  most_cubes_of_certificate);
}

void describe(const auto& archive, Of<RemovalAnswer> auto& removed) {
  archive.object(claim_fields(removed.volume), field("bone", removed.bone), field("within", removed.within),
                 field("resection", removed.resection), field("cube", removed.certificate));
}

void describe(const auto& archive, Of<InsertionAnswer> auto& answer) {
  archive.object(head_of_model_and_mesh(answer), field("pose", answer.pose), field("path", answer.path, not_empty),
                 field("surface", answer.surface), field("removed", answer.removed),
                 lines("rows", answer.rows, "vertices"));
  archive.require(!answer.rows.empty() || !answer.surface, "surface", "must not be there without \"rows\"");
  archive.require(!answer.rows.empty() || answer.removed, "rows", "must not be empty without \"removed\"");
}

}  // namespace verisq::certificates
