/// Writes `verisq-certificate/1`: numbers with as many digits as their binary64 needs.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/best_fit_answer.hpp"
#include "host/files/certificate_size.hpp"
#include "host/files/cover_digits.hpp"
#include "host/files/deviation_answer.hpp"
#include "host/files/insertion_answer.hpp"
#include "host/files/output_file.hpp"
#include "host/files/pair_proof.hpp"

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

OrderedJson json_of(const Pose& pose) {
  return {{"translation", pose.translation}, {"quaternion", pose.quaternion}};
}

OrderedJson json_of(const std::vector<Pose>& path) {
  OrderedJson array = OrderedJson::array();
  for (const Pose& pose : path) array.push_back(json_of(pose));
  return array;
}

OrderedJson json_of(const std::vector<Normal>& normals) {
  OrderedJson array = OrderedJson::array();
  for (const auto& [primitive, v] : normals) array.push_back(OrderedJson::array({primitive, v[0], v[1], v[2]}));
  return array;
}

/// Of a point, or of a triangle without weights.
void add_certificate(OrderedJson& object, const Certificate& certificate) {
  object["normals"] = json_of(certificate.normals);
  if (certificate.escape) object["escape"] = *certificate.escape;
  if (certificate.witness) object["witness"] = *certificate.witness;
  if (!certificate.cover.empty()) object["cover"] = digits_of_cover(certificate.cover);
}

OrderedJson json_of(const WayPart& part) {
  OrderedJson object{{"until", part.until}, {"segment", part.segment}};
  add_certificate(object, part.certificate);
  return object;
}

OrderedJson json_of(const InsertionAnswer::Row& row) {
  OrderedJson object = json_of(row.distance);
  object["deepest"] = {{"time", row.certificate.deepest}};
  add_certificate(object["deepest"], row.certificate.at_deepest);
  object["parts"] = OrderedJson::array();
  for (const WayPart& part : row.certificate.parts) object["parts"].push_back(json_of(part));
  return object;
}

OrderedJson json_of(const WayTriangle& triangle) {
  OrderedJson object{{"triangle", triangle.triangle}, {"cells", text_of(triangle.cells)}};
  object["moved"] = OrderedJson::array();
  for (const auto& [step, normals] : triangle.moved)
    object["moved"].push_back({{"step", step}, {"normals", json_of(normals)}});
  return object;
}

OrderedJson json_of(const WaySurfaceAnswer& surface) {
  OrderedJson object = json_of(surface.distance);
  if (const auto& witness = surface.certificate.deepest) {
    object["deepest"] = {{"triangle", witness->triangle}, {"weights", witness->weights}, {"time", witness->time}};
    add_certificate(object["deepest"], witness->certificate);
  }
  object["triangles"] = OrderedJson::array();
  for (const WayTriangle& triangle : surface.certificate.triangles) object["triangles"].push_back(json_of(triangle));
  return object;
}

OrderedJson json_of(const RemovalAnswer& removed) {
  OrderedJson object = json_of(removed.volume);
  object["bone"] = removed.bone == BoneSide::inside ? "inside" : "outside";
  if (removed.within) object["within"] = json_of(*removed.within);
  if (const auto& plane = removed.resection) object["resection"] = {{"point", plane->point}, {"normal", plane->normal}};
  object["cube"] = {{"centre", removed.certificate.centre},
                    {"half_width", removed.certificate.half_width},
                    {"parts", text_of(removed.certificate.cubes)}};
  return object;
}

OrderedJson json_of(const Separation& separation) {
  return {{"primitive_a", separation.primitive_a},
          {"primitive_b", separation.primitive_b},
          {"vector", separation.vector},
          {"on_a", separation.on_a},
          {"on_b", separation.on_b}};
}

OrderedJson json_of(const DividedSeparation& division) {
  OrderedJson object{
      {"primitive_a", division.primitive_a}, {"primitive_b", division.primitive_b}, {"cuts", text_of(division.cuts)}};
  object["planes"] = OrderedJson::array();
  for (const auto& [normal, slope_a, slope_b] : division.planes) {
    object["planes"].push_back({normal[0], normal[1], normal[2], slope_a, slope_b});
  }
  return object;
}

OrderedJson json_of(const std::vector<EnclosingBall>& balls) {
  OrderedJson array = OrderedJson::array();
  for (const auto& [primitive, centre, multiplier, distance, proof] : balls) {
    OrderedJson object{
        {"primitive", primitive}, {"centre", centre}, {"multiplier", multiplier}, {"distance", distance}};
    add_certificate(object, proof);
    array.push_back(std::move(object));
  }
  return array;
}

OrderedJson json_of(const std::vector<SurroundedPrimitive>& covers) {
  OrderedJson array = OrderedJson::array();
  for (const auto& [primitive, distance, cover] : covers)
    array.push_back({{"primitive", primitive}, {"distance", distance}, {"cover", digits_of_cover(cover)}});
  return array;
}

OrderedJson json_of(const PairCertificate& certificate) {
  OrderedJson proof{{"separations", OrderedJson::array()}};
  for (const Separation& separation : certificate.separations) proof["separations"].push_back(json_of(separation));
  if (!certificate.divisions.empty()) {
    proof["divisions"] = OrderedJson::array();
    for (const DividedSeparation& division : certificate.divisions) proof["divisions"].push_back(json_of(division));
  }
  if (!certificate.balls_a.empty()) proof["balls_a"] = json_of(certificate.balls_a);
  if (!certificate.balls_b.empty()) proof["balls_b"] = json_of(certificate.balls_b);
  if (!certificate.covers_a.empty()) proof["covers_a"] = json_of(certificate.covers_a);
  if (!certificate.covers_b.empty()) proof["covers_b"] = json_of(certificate.covers_b);
  if (const auto& near = certificate.near_points) proof["near_points"] = {{"on_a", (*near)[0]}, {"on_b", (*near)[1]}};
  if (certificate.common) proof["common"] = *certificate.common;
  return proof;
}

/// Of what `answer` claims and by what.
template <class Posed>
void add_claim(OrderedJson& object, const Posed& answer) {
  object["pose"] = json_of(answer.pose);
  object["distance"] = json_of(answer.distance);
  object["proof"] = json_of(answer.certificate);
}

template <class AboutTwoModels>
OrderedJson head_of(const AboutTwoModels& answer, const char* kind) {
  OrderedJson document{{"format", "verisq-certificate/1"}, {"kind", kind}};
  document["models"] = {json_of(answer.models[0]), json_of(answer.models[1])};
  if (!answer.units.empty()) document["units"] = answer.units;
  return document;
}

std::string text_of(const OrderedJson& document, int indentation) {
  return document.dump(indentation, ' ', false, OrderedJson::error_handler_t::replace);
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.finish();
}

/// A document that grows by one line after the other, none of them as a document in memory beside the text.
class LinesText {
 public:
  LinesText(const std::filesystem::path& path, const OrderedJson& head) : path_(path), text_(text_of(head, -1)) {
    text_.pop_back();  // the brace
  }

  /// `count` objects under `key`. Of `fewer` it asks where they are too many.
  template <class Object>
  void add(const char* key, std::size_t count, const char* fewer, const Object& object) {
    text_ += fmt::format(",\n\"{}\": [", key);
    for (std::size_t i = 0; i < count; ++i) {
      text_ += (i == 0 ? "\n" : ",\n") + text_of(object(i), -1);
      if (text_.size() + ending.size() <= largest_certificate) continue;
      refuse(fmt::format("{}: the first {} of {} {} take more than the {} bytes of a certificate file: give fewer {}",
                         path_.string(), i + 1, count, key, largest_certificate, fewer));
    }
    text_ += "\n]";
  }

  void write() const { write_text(path_, text_ + std::string(ending)); }

 private:
  static constexpr std::string_view ending = "}\n";

  std::filesystem::path path_;
  std::string text_;
};

/// With the `count` objects of `key` at its end.
template <class Object>
void write_lines(const std::filesystem::path& path, const OrderedJson& head, const char* key, std::size_t count,
                 const char* fewer, const Object& object) {
  LinesText lines(path, head);
  lines.add(key, count, fewer, object);
  lines.write();
}

OrderedJson json_of(const std::vector<Enclosure>& claims) {
  OrderedJson array = OrderedJson::array();
  for (const Enclosure& claim : claims) array.push_back(json_of(claim));
  return array;
}

OrderedJson json_of(const DistanceSummary& summary) {
  OrderedJson object{{"largest", json_of(summary.largest)}, {"mean", json_of(summary.mean)}};
  object["percentiles"] = json_of(summary.percentiles);
  return object;
}

OrderedJson json_of(const CertifiedEnclosure& sample) {
  OrderedJson object = json_of(sample.distance);
  add_certificate(object, sample.certificate);
  return object;
}

OrderedJson json_of(const TriangleProof& proof) {
  OrderedJson object{{"pieces", text_of(proof.pieces)}};
  if (proof.samples.empty()) return object;
  object["samples"] = OrderedJson::array();
  for (const CertifiedEnclosure& sample : proof.samples) object["samples"].push_back(json_of(sample));
  return object;
}

OrderedJson json_of(const ContactClaim& claim) {
  return {{"area", json_of(claim.area)}, {"within", json_of(claim.within)}, {"percent", json_of(claim.percent)}};
}

OrderedJson json_of(const VertexProof& proof) {
  return proof.own ? json_of(*proof.own) : OrderedJson(proof.told_by);
}

OrderedJson json_of(const DividedTriangle& divided) {
  OrderedJson object{{"triangle", divided.triangle}};
  object.update(json_of(divided.proof));
  return object;
}

OrderedJson json_of(const CertifiedPoint& point) {
  OrderedJson object{{"point", point.point}};
  object.update(json_of(point.signed_distance));
  return object;
}

OrderedJson json_of(const std::vector<CertifiedPoint>& points) {
  OrderedJson array = OrderedJson::array();
  for (const CertifiedPoint& point : points) array.push_back(json_of(point));
  return array;
}

void add_cover(OrderedJson& object, const SurfaceCover& cover) {
  object["patches"] = OrderedJson::array();
  for (const std::vector<PatchProof>& patches : cover.patches) object["patches"].push_back(text_of(patches));
  object["off"] = json_of(cover.off);
  if (!cover.on.empty()) object["on"] = json_of(cover.on);
}

OrderedJson json_of(const SurfaceProof& proof) {
  OrderedJson object{{"within", proof.within}, {"farthest", json_of(proof.farthest)}};
  add_cover(object, proof.cover);
  return object;
}

/// Which primitives count, one by one.
OrderedJson json_of(const SurfaceCover& cover, const std::vector<bool>& counted) {
  OrderedJson object{{"primitives", OrderedJson::array()}};
  for (std::size_t k = 0; k < counted.size(); ++k) {
    if (counted[k]) object["primitives"].push_back(k);
  }
  add_cover(object, cover);
  return object;
}

OrderedJson json_of(const std::vector<AreaRun>& runs) {
  OrderedJson array = OrderedJson::array();
  for (const auto& [area, points] : runs) array.push_back({area, points});
  return array;
}

OrderedJson json_of(const FemurLandmarks& landmarks) {
  OrderedJson object = OrderedJson::object();
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = landmarks.*point) object[name] = *at;
  }
  return object;
}

OrderedJson json_of(const std::vector<Feature>& features) {
  OrderedJson array = OrderedJson::array();
  for (const auto& [name, method, unit, value] : features) {
    OrderedJson object{{"name", name}, {"method", method}, {"unit", unit == FeatureUnit::length ? "mm" : "degrees"}};
    object.update(json_of(value));
    array.push_back(std::move(object));
  }
  return array;
}

OrderedJson json_of(const FrameAxis& axis) {
  return {{"direction", axis.direction}, {"tilt_degrees", axis.tilt_degrees}};
}

OrderedJson json_of(const EquilibriumAnswer& answer, const stance::Standing& standing) {
  OrderedJson object{{"joints", OrderedJson::array()}, {"cylinders", OrderedJson::array()}};
  for (std::size_t i = 0; i < answer.joints.size(); ++i) {
    object["joints"].push_back({{"joint", answer.joints[i]},
                                {"position", json_of(standing.positions[i])},
                                {"torque", json_of(standing.torques[i])}});
  }
  for (std::size_t i = 0; i < answer.cylinders.size(); ++i) {
    object["cylinders"].push_back({{"cylinder", answer.cylinders[i]},
                                   {"force", json_of(standing.loads[i].force)},
                                   {"penetration", json_of(standing.loads[i].penetration)}});
  }
  object["centre_of_pressure"] = {{"x", json_of(standing.centre_of_pressure_x)},
                                  {"z", json_of(standing.centre_of_pressure_z)}};
  object["least_penetration"] = json_of(standing.least_penetration);
  return object;
}

OrderedJson json_of(const stance::EquilibriumPart& part) {
  OrderedJson object = OrderedJson::object();
  if (part.halved) object["halved"] = *part.halved;
  if (part.postures.empty()) return object;
  object["postures"] = OrderedJson::array();
  for (const auto& [lo, hi] : part.postures) object["postures"].push_back({lo, hi});
  return object;
}

void add_terms(OrderedJson& document, const StatedTerms& terms) {
  document["criterion"] = {
      {"target", terms.fitness.target}, {"scale", terms.fitness.scale}, {"serves", json_of(terms.fitness.serves)}};
  document["penetration_limit"] = terms.penetration_limit;
  document["areas"] = OrderedJson::array();
  for (const Area& area : terms.areas) document["areas"].push_back({{"name", area.name}, {"weight", area.weight}});
  document["area_runs"] = json_of(terms.area_runs);
}

void write_sized(const std::filesystem::path& path, const std::string& text) {
  if (text.size() > largest_certificate)
    refuse(fmt::format("{}: takes more than the {} bytes of a certificate file", path.string(), largest_certificate));
  write_text(path, text);
}

}  // namespace

void write_answer(const std::filesystem::path& path, const PairAnswer& answer) {
  OrderedJson document = head_of(answer, "pair");
  add_claim(document, answer);
  write_text(path, text_of(document, 2) + "\n");
}

void write_answer(const std::filesystem::path& path, const FitAnswer& answer) {
  OrderedJson document{{"format", "verisq-certificate/1"}, {"kind", "fit"}};
  document["models"] = OrderedJson::array({json_of(answer.model)});
  document["mesh"] = json_of(answer.mesh);
  if (!answer.units.empty()) document["units"] = answer.units;
  add_terms(document, answer.terms);
  document["claims"] = OrderedJson::array();
  for (const ClearanceClaim& claim : answer.claims) {
    OrderedJson object{{"what", claim.what}};
    if (!claim.area.empty()) object["area"] = claim.area;
    object.update(json_of(claim.value));
    document["claims"].push_back(std::move(object));
  }
  for (const SideClaim& claim : answer.sides) {
    document["sides"].push_back({{"primitive", claim.primitive}, {"side", to_string(claim.side)}});
  }
  write_sized(path, text_of(document, -1) + "\n");
}

void write_answer(const std::filesystem::path& path, const BestFitAnswer& answer) {
  OrderedJson document{{"format", "verisq-certificate/1"}, {"kind", "best_fit"}};
  document["models"] = OrderedJson::array();
  for (const SubjectFile& model : answer.models) document["models"].push_back(json_of(model));
  document["mesh"] = json_of(answer.mesh);
  if (!answer.units.empty()) document["units"] = answer.units;
  add_terms(document, answer.terms);
  document["range"] = {{"start", json_of(answer.range.start)},
                       {"translation", answer.range.translation},
                       {"rotation_degrees", answer.range.rotation_degrees}};
  document["centres"] = answer.centres;
  document["upper"] = end_of_claim(answer.upper);
  document["ranges"] = OrderedJson::array();
  for (const std::vector<PoseDivision>& range : answer.certificate.ranges) document["ranges"].push_back(text_of(range));
  write_sized(path, text_of(document, -1) + "\n");
}

void write_answer(const std::filesystem::path& path, const PoseAnswers& answers) {
  write_lines(path, head_of(answers, "poses"), "answers", answers.answers.size(), "poses", [&](std::size_t i) {
    OrderedJson object;
    add_claim(object, answers.answers[i]);
    return object;
  });
}

void write_answer(const std::filesystem::path& path, const InsertionAnswer& answer) {
  OrderedJson head{{"format", "verisq-certificate/1"}, {"kind", "insertion"}};
  head["models"] = OrderedJson::array({json_of(answer.model)});
  head["mesh"] = json_of(answer.mesh);
  if (!answer.units.empty()) head["units"] = answer.units;
  if (answer.pose) head["pose"] = json_of(*answer.pose);
  head["path"] = json_of(answer.path);
  if (answer.surface) head["surface"] = json_of(*answer.surface);
  if (answer.removed) head["removed"] = json_of(*answer.removed);
  write_lines(path, head, "rows", answer.rows.size(), "vertices",
              [&](std::size_t i) { return json_of(answer.rows[i]); });
}

void write_answer(const std::filesystem::path& path, const PathAnswer& answer) {
  const auto& [nearest, at_nearest, parts] = answer.certificate;
  OrderedJson head = head_of(answer, "path");
  head["path"] = json_of(answer.path);
  head["smallest"] = json_of(answer.claims.smallest);
  if (answer.claims.first_contact) head["first_contact"] = json_of(*answer.claims.first_contact);
  head["nearest"] = {{"time", nearest}, {"proof", json_of(at_nearest)}};
  write_lines(path, head, "parts", parts.size(), "poses", [&parts = parts](std::size_t i) {
    return OrderedJson{{"until", parts[i].until}, {"proof", json_of(parts[i].certificate)}};
  });
}

void write_answer(const std::filesystem::path& path, const DeviationAnswer& answer) {
  OrderedJson head{{"format", "verisq-certificate/1"}, {"kind", "deviation"}};
  head["models"] = OrderedJson::array({json_of(answer.model)});
  head["mesh"] = json_of(answer.mesh);
  if (!answer.units.empty()) head["units"] = answer.units;
  if (answer.pose) head["pose"] = json_of(*answer.pose);
  head["percentiles"] = answer.percentiles;
  head["of_vertices"] = json_of(answer.of_vertices);
  if (answer.from_mesh) head["from_mesh"] = json_of(*answer.from_mesh);
  if (const auto& surface = answer.certificate.surface) {
    head["from_model"] = {{"largest", json_of(*answer.from_model)}};
    if (const auto& statistics = answer.statistics_from_model) {
      head["from_model"]["mean"] = json_of(statistics->mean);
      head["from_model"]["percentiles"] = json_of(statistics->percentiles);
    }
    head["hausdorff"] = json_of(*answer.hausdorff);
    head["surface"] = json_of(*surface);
  }
  const std::vector<CertifiedEnclosure>& vertices = answer.certificate.vertices;
  const std::vector<TriangleProof>& triangles = answer.certificate.triangles;
  LinesText lines(path, head);
  lines.add("vertices", vertices.size(), "vertices", [&](std::size_t i) { return json_of(vertices[i]); });
  lines.add("triangles", triangles.size(), "triangles", [&](std::size_t n) { return json_of(triangles[n]); });
  lines.write();
}

void write_answer(const std::filesystem::path& path, const ContactAnswer& answer) {
  OrderedJson head{{"format", "verisq-certificate/1"}, {"kind", "contact"}};
  head["models"] = OrderedJson::array({json_of(answer.model)});
  head["mesh"] = json_of(answer.mesh);
  if (!answer.units.empty()) head["units"] = answer.units;
  head["distance"] = answer.distance;
  head["regions"] = answer.regions;
  head["region_runs"] = json_of(answer.region_runs);
  head["of_mesh"] = json_of(answer.claims.of_mesh);
  head["by_region"] = OrderedJson::array();
  for (const ContactClaim& claim : answer.claims.by_region) head["by_region"].push_back(json_of(claim));
  if (const auto& surface = answer.certificate.surface) {
    head["of_model"] = json_of(*answer.claims.of_model);
    head["surface"] = json_of(*surface, answer.counted);
  }
  const std::vector<VertexProof>& vertices = answer.certificate.vertices;
  const std::vector<DividedTriangle>& triangles = answer.certificate.triangles;
  LinesText lines(path, head);
  lines.add("vertices", vertices.size(), "vertices", [&](std::size_t i) { return json_of(vertices[i]); });
  lines.add("triangles", triangles.size(), "triangles", [&](std::size_t i) { return json_of(triangles[i]); });
  lines.write();
}

void write_answer(const std::filesystem::path& path, const FeaturesAnswer& answer) {
  const FeatureClaims& claims = answer.claims;
  OrderedJson document{{"format", "verisq-certificate/1"}, {"kind", "features"}};
  document["models"] = OrderedJson::array();
  if (answer.implant) document["models"].push_back(json_of(*answer.implant));
  if (answer.mesh) document["mesh"] = json_of(*answer.mesh);
  document["units"] = "mm";
  if (claims.side) document["side"] = *claims.side == Side::left ? "left" : "right";
  document["landmark_radius"] = claims.landmark_radius;
  if (claims.landmarks.head_radius) document["head_radius"] = *claims.landmarks.head_radius;
  document["landmarks"] = json_of(claims.landmarks);
  document["features"] = json_of(claims.features);
  if (claims.frame) {
    const auto& [origin, x, y, z] = *claims.frame;
    document["frame"] = {{"origin", origin}, {"x", json_of(x)}, {"y", json_of(y)}, {"z", json_of(z)}};
  }
  if (claims.implant) {
    document["implant"] = json_of(*claims.implant);
    document["changes"] = json_of(claims.changes);
  }
  write_text(path, text_of(document, 2) + "\n");
}

void write_answer(const std::filesystem::path& path, const EquilibriumAnswer& answer) {
  const auto& [control, uncertain, ranges, stands, standing] = answer.claims;
  OrderedJson head{{"format", "verisq-certificate/1"}, {"kind", "equilibrium"}};
  head["models"] = OrderedJson::array({json_of(answer.model)});
  head["joints"] = control == stance::JointControl::held ? "held" : "proportional";
  head["uncertain"] = OrderedJson::array();
  for (std::size_t i = 0; i < ranges.size(); ++i)
    head["uncertain"].push_back({{"parameter", answer.parameters[i]}, {"lo", ranges[i].lo}, {"hi", ranges[i].hi}});
  head["stands"] = stands;
  if (standing) head["standing"] = json_of(answer, *standing);
  head["reference"] = answer.certificate.reference;
  const std::vector<stance::EquilibriumPart>& parts = answer.certificate.parts;
  write_lines(path, head, "parts", parts.size(), "cells", [&](std::size_t i) { return json_of(parts[i]); });
}

}  // namespace verisq
