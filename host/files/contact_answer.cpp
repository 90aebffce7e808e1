/// Vertices and divided triangles are read one by one; what proves them need not prove anything.
#include "host/files/contact_answer.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "host/files/certificate_fields.hpp"
#include "host/files/deviation_answer.hpp"
#include "host/files/fit_answer.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

std::vector<std::string> read_region_names(const JsonValue& value) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < value.size(); ++i) {
    names.push_back(value.element(i).name());
    if (!seen.insert(names.back()).second) value.element(i).fail("is the name of a region before");
  }
  return names;
}

ContactClaim read_contact_claim(const JsonValue& value) {
  value.check_keys({"area", "within", "percent"});
  return {read_claim(value.at("area")), read_claim(value.at("within")), read_claim(value.at("percent"))};
}

ContactClaims read_contact_claims(const JsonValue& root, std::size_t regions) {
  ContactClaims claims{read_contact_claim(root.at("of_mesh")), {}, {}};
  const JsonValue by_region = root.at("by_region");
  if (by_region.size() != regions) by_region.fail(fmt::format("must be {} claims, one a region", regions));
  for (std::size_t i = 0; i < regions; ++i) claims.by_region.push_back(read_contact_claim(by_region.element(i)));
  return claims;
}

/// Each a sample, or the index of a vertex that has one.
std::vector<VertexProof> read_vertex_proofs(const JsonValue& value) {
  std::vector<VertexProof> proofs(value.size());
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    const JsonValue vertex = value.element(i);
    if (vertex.json().is_object()) {
      proofs[i].own = read_sample(vertex);
    } else {
      proofs[i].told_by = read_index(vertex);
    }
  }
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    if (proofs[i].own || (proofs[i].told_by < proofs.size() && proofs[proofs[i].told_by].own)) continue;
    value.element(i).fail("must be the index of a vertex that has a certificate");
  }
  return proofs;
}

std::vector<DividedTriangle> read_divided_triangles(const JsonValue& value) {
  std::vector<DividedTriangle> triangles;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const JsonValue triangle = value.element(i);
    triangle.check_keys({"triangle", "pieces", "samples"});
    const std::uint32_t index = read_index(triangle.at("triangle"));
    if (!triangles.empty() && index <= triangles.back().triangle)
      triangle.at("triangle").fail("must be above those before");
    triangles.push_back({index, read_triangle_proof(triangle)});
  }
  return triangles;
}

/// Of as many primitives as have patches: those that count are named in their order, and the others have none.
std::vector<bool> read_counted(const JsonValue& value, const std::vector<std::vector<PatchProof>>& patches) {
  std::vector<bool> counted(patches.size(), false);
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::uint32_t primitive = read_index(value.element(i));
    if (primitive >= counted.size()) value.element(i).fail(fmt::format("must be below {}", counted.size()));
    if (i > 0 && primitive <= read_index(value.element(i - 1))) value.element(i).fail("must be above those before");
    counted[primitive] = true;
  }
  if (value.size() == 0) value.fail("must not be empty");
  return counted;
}

/// Both the claim and its proof, or neither: files of before have none.
void read_surface(const JsonValue& root, ContactAnswer& answer) {
  const auto surface = root.find("surface");
  const auto claim = root.find("of_model");
  if (!surface) {
    if (claim) claim->fail("must not be there without \"surface\"");
    return;
  }
  surface->check_keys({"primitives", "patches", "off", "on"});
  answer.claims.of_model = read_contact_claim(root.at("of_model"));
  answer.certificate.surface = read_surface_cover(*surface);
  answer.counted = read_counted(surface->at("primitives"), answer.certificate.surface->patches);
}

}  // namespace

ContactAnswer read_contact(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "mesh", "units", "distance", "regions", "region_runs", "of_mesh",
                   "by_region", "of_model", "vertices", "triangles", "surface"});
  const JsonValue models = root.at("models");
  if (models.size() != 1) models.fail("must be an array of one model");
  ContactAnswer answer{.model = read_subject_file(models.element(0)),
                       .mesh = read_subject_file(root.at("mesh")),
                       .units = units_of(root),
                       .distance = nonnegative_number(root.at("distance")),
                       .regions = read_region_names(root.at("regions")),
                       .region_runs = {},
                       .claims = {},
                       .certificate = {}};
  answer.region_runs = read_area_runs(root.at("region_runs"), answer.regions.size());
  answer.claims = read_contact_claims(root, answer.regions.size());
  answer.certificate = {read_vertex_proofs(root.at("vertices")), read_divided_triangles(root.at("triangles")), {}};
  read_surface(root, answer);
  return answer;
}

ContactTerms terms_of(const ContactAnswer& answer) {
  return {answer.distance, areas_of(answer.region_runs), static_cast<std::uint32_t>(answer.regions.size()),
          answer.counted};
}

}  // namespace verisq
