/// This file implements model.hpp.
#include "verify/solids/model.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "verify/numbers/interval.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/error.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {
namespace {

/// Shortest digits that read back, or so many significant ones.
std::string text(double x, int digits = 0) {
  std::array<char, 32> text{};
  const auto [begin, end] = std::pair(text.data(), text.data() + text.size());
  if (digits == 0) return {begin, std::to_chars(begin, end, x).ptr};
  return {begin, std::to_chars(begin, end, x, std::chars_format::general, digits).ptr};
}

std::string text(const Enclosure& e) {
  if (e.lo == e.hi) return text(e.lo);
  return std::string("[").append(text(e.lo)).append(", ").append(text(e.hi)).append("]");
}

constexpr auto finite = [](double x) { return std::isfinite(x); };
constexpr auto interval = [](const Enclosure& e) { return e.lo <= e.hi && std::isfinite(e.lo) && std::isfinite(e.hi); };

/// The first number that does not hold.
std::optional<Fault> fault_of(const auto& numbers, const std::string& at, const auto& holds, const char* what) {
  const auto found = std::ranges::find_if_not(numbers, holds);
  if (found == numbers.end()) return std::nullopt;
  return Fault{at + "[" + std::to_string(found - numbers.begin()) + "]", text(*found), what};
}

std::optional<Fault> fault_of(const std::array<double, 4>& quaternion, const std::string& place) {
  if (auto fault = fault_of(quaternion, place, finite, "must be finite")) return fault;
  if (quaternion == std::array<double, 4>{}) return Fault{place, "[0, 0, 0, 0]", "must not be zero"};
  return std::nullopt;
}

std::optional<Fault> fault_of(const Bend& bend, const Superquadric& largest, const std::string& place) {
  for (const auto& [key, x] : {std::pair{".curvature", bend.curvature}, std::pair{".angle_deg", bend.angle_degrees}})
    if (!std::isfinite(x)) return Fault{place + key, text(x), "must be finite"};
  const PreciseVector towards{cosine_of_degrees(bend.angle_degrees), sine_of_degrees(bend.angle_degrees), 0};
  const PreciseInterval k = abs(PreciseInterval(Real(bend.curvature)));
  const PreciseInterval extent = SuperquadricBounds<Real>(largest).support(towards);
  const auto fault = [&](const std::string& what) { return Fault{place + ".curvature", text(bend.curvature), what}; };
  if (!((k * extent).upper() < Real(1)))
    return fault("its magnitude times the solid's extent towards angle_deg, " +
                 text(extent.upper().to_double(Direction::up), 6) + ", must be below 1");
  if (!((k * PreciseInterval(Real(largest.semi_axes[2]))).upper() < half_turn().lower()))
    return fault("its magnitude times a3, " + text(largest.semi_axes[2], 6) + ", must be below pi");
  return std::nullopt;
}

std::optional<Fault> fault_of_pose(const UncertainPrimitive& primitive, const std::string& pose) {
  if (auto fault = fault_of(primitive.translation, pose + "translation", interval, "must be finite")) return fault;
  return fault_of(primitive.quaternion, pose + "quaternion");
}

std::optional<Fault> fault_of_mesh(const UncertainPrimitive& primitive, const std::string& place) {
  const Mesh& mesh = *primitive.mesh;
  const auto vertex =
      std::ranges::find_if_not(mesh.vertices, [](const Point& v) { return std::ranges::all_of(v, finite); });
  if (vertex != mesh.vertices.end()) {
    const std::string index = std::to_string(vertex - mesh.vertices.begin());
    return fault_of(*vertex, place + ".mesh.vertices[" + index + "]", finite, "must be finite");
  }
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    for (const std::uint32_t corner : mesh.triangles[n]) {
      if (corner < mesh.vertices.size()) continue;
      return Fault{place + ".mesh.triangles[" + std::to_string(n) + "]", std::to_string(corner),
                   "no vertex has this index"};
    }
  }
  if (mesh.triangles.empty()) return Fault{place + ".mesh.triangles", "[]", "must have at least four triangles"};
  if (primitive.bend) return Fault{place + ".bend", "{...}", "a mesh has no bend"};
  const auto exact = [](const Enclosure& x) { return x.lo == x.hi; };
  return fault_of(primitive.translation, place + ".pose.translation", exact, "must be exact: the primitive is a mesh");
}

std::optional<Fault> fault_of(const UncertainPrimitive& primitive, const std::string& place) {
  if (auto fault = fault_of_pose(primitive, place + ".pose.")) return fault;
  if (primitive.mesh) return fault_of_mesh(primitive, place);
  const std::string solid = place + ".superquadric.";
  const auto& a = primitive.semi_axes;
  const auto& e = primitive.exponents;
  const auto positive = [](const Enclosure& x) { return x.lo > 0.0; };
  if (auto fault = fault_of(a, solid + "semi_axes", positive, "must be positive")) return fault;
  if (auto fault = fault_of(a, solid + "semi_axes", interval, "must be finite")) return fault;
  const auto convex = [](const Enclosure& x) { return 0.0 < x.lo && x.lo <= x.hi && x.hi <= 2.0; };
  if (auto fault = fault_of(e, solid + "exponents", convex, "must be in (0, 2]")) return fault;
  if (!(smallest_taper <= primitive.taper && primitive.taper <= largest_taper))
    return Fault{solid + "taper", text(primitive.taper),
                 "the section at z = a3 over that at z = -a3 must be in [0.01, 100]"};
  if (!primitive.bend) return std::nullopt;
  const Superquadric largest{{a[0].hi, a[1].hi, a[2].hi}, {e[0].lo, e[1].lo}, primitive.taper};
  return fault_of(*primitive.bend, largest, place + ".bend");
}

std::optional<Fault> fault_of(const SetExpression& tree, std::size_t primitives, std::size_t depth) {
  if (depth > 2048) return Fault{"csg", std::to_string(depth), "nested deeper than 2048 levels"};
  if (tree.operands.empty() && tree.primitive >= primitives)
    return Fault{"csg", std::to_string(tree.primitive), "no primitive has this index"};
  if (tree.operation == SetOperation::subtract && tree.operands.size() == 1)
    return Fault{"csg", text(1), "must have at least two operands: the first without the others"};
  for (const SetExpression& operand : tree.operands)
    if (auto fault = fault_of(operand, primitives, depth + 1)) return fault;
  return std::nullopt;
}

void require(const std::optional<Fault>& fault) {
  if (fault) throw Error(ErrorKind::input, fault->place + " = " + fault->value + ": " + fault->what);
}

}  // namespace

std::optional<Fault> fault_of(const UncertainModel& model) {
  if (model.primitives.empty()) return Fault{"primitives", "[]", "must have at least one primitive"};
  for (std::size_t k = 0; k < model.primitives.size(); ++k)
    if (auto fault = fault_of(model.primitives[k], "primitives[" + std::to_string(k) + "]")) return fault;
  return model.csg ? fault_of(*model.csg, model.primitives.size(), 0) : std::nullopt;
}

void require_valid(const UncertainModel& model) {
  require_valid_with_meshes(model);
  const auto mesh = std::ranges::find_if(model.primitives, [](const UncertainPrimitive& p) { return bool{p.mesh}; });
  if (mesh == model.primitives.end()) return;
  throw Error(ErrorKind::input, "primitives[" + std::to_string(mesh - model.primitives.begin()) +
                                    "].mesh: this takes superquadrics alone so far; recover a model of the mesh");
}

void require_valid_with_meshes(const UncertainModel& model) {
  require(fault_of(model));
}

void require_finite(const Point& point, const std::string& name) {
  require(fault_of(point, name, finite, "must be finite"));
}

void require_valid(const Pose& pose, const std::string& name) {
  require_finite(pose.translation, name + ".translation");
  require(fault_of(pose.quaternion, name + ".quaternion"));
}

}  // namespace verisq::verify

namespace verisq {
namespace {

[[noreturn]] void refuse(std::string_view what, const std::string& solids) {
  throw Error(ErrorKind::input, std::string(what) + ": not supported for " + solids);
}

/// Marks the primitives of nested unions as used; false where the tree holds any other operation.
bool unites(const SetExpression& expression, std::vector<bool>& used) {
  if (expression.operands.empty()) {
    used.at(expression.primitive) = true;
    return true;
  }
  return expression.operation == SetOperation::unite &&
         std::ranges::all_of(expression.operands, [&](const SetExpression& operand) { return unites(operand, used); });
}

}  // namespace

bool verify::is_union(const Model& model) {
  std::vector<bool> used(model.primitives.size(), !model.csg);
  return (!model.csg || unites(*model.csg, used)) && std::ranges::all_of(used, [](bool is_used) { return is_used; });
}

bool has_mesh(const Model& model) {
  return std::ranges::any_of(model.primitives, [](const Primitive& primitive) { return bool{primitive.mesh}; });
}

bool is_bent(const Primitive& primitive) {
  return primitive.bend && primitive.bend->curvature != 0.0;
}

std::string name_of_primitive(const Model& model, std::size_t primitive) {
  const std::string& name = model.primitives[primitive].name;
  return name.empty() ? "primitives[" + std::to_string(primitive) + "]" : name;
}

bool is_union_of_convex(const Model& model) {
  return verify::is_union(model) && std::ranges::none_of(model.primitives, is_bent) && !has_mesh(model);
}

void verify::require_union(const Model& model, std::string_view what) {
  verify::require_valid_with_meshes(model);
  if (!is_union(model)) refuse(what, "csg other than the union of all primitives");
}

void verify::require_no_taper(const Model& model, std::string_view what) {
  const auto tapered =
      std::ranges::find_if(model.primitives, [](const Primitive& p) { return is_tapered(p.superquadric); });
  if (tapered == model.primitives.end()) return;
  const std::string index = std::to_string(tapered - model.primitives.begin());
  refuse(what, "tapered solids: primitives[" + index + "].superquadric.taper");
}

}  // namespace verisq
