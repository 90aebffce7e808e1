/// This file implements model_file.hpp.
#include "host/files/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/clearance.hpp>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/input_file.hpp"
#include "host/files/json_document.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/solids/model.hpp"

namespace verisq {
namespace {

Point read_corner(const JsonValue& value) {
  if (value.size() != 3) value.fail("must be an array of 3 numbers");
  return {value.element(0).number(), value.element(1).number(), value.element(2).number()};
}

void check_corners(const JsonValue& box, const AreaBox& area) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(area.lower[k] <= area.upper[k])) {
      box.element(0).element(k).fail(fmt::format("exceeds the upper corner's {}", area.upper[k]));
    }
  }
}

AreaBox read_area_box(const JsonValue& value) {
  value.check_keys({"name", "weight", "box"});
  const JsonValue name = value.at("name");
  const JsonValue weight = value.at("weight");
  const JsonValue box = value.at("box");
  AreaBox area{{name.name(), weight.number()}, {}, {}};
  if (area.area.name == elsewhere) name.fail("is the name of what no area holds");
  if (area.area.weight < 0.0) weight.fail("must not be negative");
  if (box.size() != 2) box.fail("must be an array of 2 corners, [[x0, y0, z0], [x1, y1, z1]]");
  area.lower = read_corner(box.element(0));
  area.upper = read_corner(box.element(1));
  check_corners(box, area);
  return area;
}

/// [{"name": "proximal", "weight": 3, "box": [[x0, y0, z0], [x1, y1, z1]]}, ...]. Throws Error(input) for empty,
/// repeated and reserved names, negative weights and reversed corners.
std::vector<AreaBox> read_area_boxes(const JsonValue& areas) {
  std::vector<AreaBox> boxes;
  std::set<std::string> names;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const JsonValue element = areas.element(k);
    boxes.push_back(read_area_box(element));
    if (!names.insert(boxes.back().area.name).second) element.at("name").fail("another area has this name");
  }
  return boxes;
}

Point coordinates(const JsonValue& value) {
  if (value.size() != 3) value.fail("must be an array of 3 numbers");
  return {value.element(0).number(), value.element(1).number(), value.element(2).number()};
}

}  // namespace

FemurLandmarks read_landmark_points(const JsonValue& points) {
  if (!points.json().is_object()) points.fail("must be an object");
  FemurLandmarks landmarks;
  for (auto item = points.json().begin(); item != points.json().end(); ++item) {
    const std::string& key = item.key();
    const JsonValue value = points.at(key);
    const auto* const known =
        std::ranges::find_if(named_landmarks, [&](const NamedLandmark& l) { return key == l.name; });
    if (known == named_landmarks.end()) value.fail("is no landmark");
    landmarks.*(known->point) = coordinates(value);
  }
  return landmarks;
}

std::optional<Side> read_side(const JsonValue& object) {
  const auto value = object.find("side");
  if (!value) return std::nullopt;
  const std::string text = value->text();
  if (text != "left" && text != "right") value->fail("must be \"left\" or \"right\"");
  return text == "left" ? Side::left : Side::right;
}

namespace {

constexpr std::string_view format_name = "verisq-model/1";

/// Whether a number may be an interval if the format allows it.
enum class Intervals { allowed, refused };

bool is_interval(const nlohmann::json& value) {
  return value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
}

void check_size(const JsonValue& value, std::size_t size) {
  if (value.size() != size) value.fail(fmt::format("must be an array of {} numbers", size));
}

template <std::size_t N>
std::array<double, N> numbers(const JsonValue& value) {
  check_size(value, N);
  std::array<double, N> result{};
  for (std::size_t k = 0; k < N; ++k) result[k] = value.element(k).number();
  return result;
}

Enclosure interval(const JsonValue& value) {
  const Enclosure result{value.element(0).number(), value.element(1).number()};
  if (result.lo > result.hi) value.fail("the lower end of the interval exceeds the upper");
  return result;
}

Enclosure number_or_interval(const JsonValue& value, Intervals intervals) {
  const bool allowed = intervals == Intervals::allowed;
  if (is_interval(value.json())) {
    if (allowed) return interval(value);
    value.fail("is an interval, where only an exact model is supported");
  }
  if (allowed && !value.json().is_number()) value.fail("must be a number or an interval [lo, hi]");
  const double number = value.number();
  return {number, number};
}

/// Numbers that the format lets be uncertain.
template <std::size_t N>
std::array<Enclosure, N> numbers_or_intervals(const JsonValue& value, Intervals intervals) {
  check_size(value, N);
  std::array<Enclosure, N> result{};
  for (std::size_t k = 0; k < N; ++k) result[k] = number_or_interval(value.element(k), intervals);
  return result;
}

void read_superquadric(const JsonValue& value, Intervals intervals, UncertainPrimitive& primitive) {
  value.check_keys({"semi_axes", "exponents", "taper"});
  primitive.semi_axes = numbers_or_intervals<3>(value.at("semi_axes"), intervals);
  primitive.exponents = numbers_or_intervals<2>(value.at("exponents"), intervals);
  if (const auto taper = value.find("taper")) primitive.taper = taper->number();
}

void read_pose(const JsonValue& value, Intervals intervals, UncertainPrimitive& primitive) {
  value.check_keys({"translation", "quaternion"});
  if (const auto translation = value.find("translation")) {
    primitive.translation = numbers_or_intervals<3>(*translation, intervals);
  }
  if (const auto quaternion = value.find("quaternion")) {
    primitive.quaternion = numbers<4>(*quaternion);
  }
}

/// The largest solid that the intervals allow.
Superquadric largest(const UncertainPrimitive& primitive) {
  const auto& [a1, a2, a3] = primitive.semi_axes;
  const auto& [e1, e2] = primitive.exponents;
  return {{a1.hi, a2.hi, a3.hi}, {e1.lo, e2.lo}, primitive.taper};
}

Bend read_bend(const JsonValue& value) {
  value.check_keys({"curvature", "angle_deg"});
  return {value.at("curvature").number(), value.at("angle_deg").number()};
}

std::uint32_t read_index(const JsonValue& value, std::size_t count) {
  if (!value.json().is_number_unsigned() || value.json().get<std::uint64_t>() >= count)
    value.fail(fmt::format("must be the index of a vertex, from 0 to {}", count - 1));
  return value.json().get<std::uint32_t>();
}

Mesh read_inline_mesh(const JsonValue& value) {
  Mesh mesh;
  const JsonValue vertices = value.at("vertices");
  const JsonValue triangles = value.at("triangles");
  const std::size_t count = vertices.size();
  mesh.vertices.reserve(count);
  for (std::size_t n = 0; n < count; ++n) mesh.vertices.push_back(numbers<3>(vertices.element(n)));
  mesh.triangles.reserve(triangles.size());
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    const JsonValue corners = triangles.element(n);
    check_size(corners, 3);
    mesh.triangles.push_back({read_index(corners.element(0), count), read_index(corners.element(1), count),
                              read_index(corners.element(2), count)});
  }
  return mesh;
}

/// Products are rounded to nearest: the solid is that of the rounded vertices.
void scale(Mesh& mesh, const JsonValue& value) {
  const double factor = value.number();
  if (!(factor > 0.0)) value.fail("must be positive");
  for (Point& vertex : mesh.vertices) {
    for (double& coordinate : vertex) coordinate *= factor;
    if (!std::ranges::all_of(vertex, [](double x) { return std::isfinite(x); })) value.fail("makes a vertex overflow");
  }
}

/// The file that a model names, relative to the model's folder.
std::filesystem::path beside(const std::filesystem::path& model, const std::string& file) {
  return model.parent_path() / file;
}

/// {"file": "stem.stl", "scale": 0.001}, its name relative to the model's folder, or {"vertices": ..., "triangles":
/// ...}.
Mesh read_mesh_of(const JsonValue& value, std::string_view model) {
  const auto file = value.find("file");
  value.check_keys(file ? std::initializer_list<std::string_view>{"file", "scale"}
                        : std::initializer_list<std::string_view>{"vertices", "triangles", "scale"});
  Mesh mesh = file ? read_mesh(beside(model, file->name())) : read_inline_mesh(value);
  if (const auto factor = value.find("scale")) scale(mesh, *factor);
  return mesh;
}

/// A closed mesh as a primitive. Its fault is told at its place.
Primitive solid_of(const JsonValue& value, std::string_view model, const std::string& name) {
  Mesh mesh = read_mesh_of(value, model);
  try {
    return mesh_primitive(name, std::move(mesh));
  } catch (const Error& error) {
    value.fail(error.what());
  }
}

UncertainPrimitive read_primitive(const JsonValue& value, std::string_view model, Intervals intervals) {
  value.check_keys({"name", "superquadric", "mesh", "bend", "pose"});
  UncertainPrimitive primitive{value.at("name").line(), {}, {}, {}, Pose{}.quaternion};
  if (const auto mesh = value.find("mesh")) {
    if (value.find("superquadric")) mesh->fail("is another solid beside the superquadric: give one of them");
    primitive.mesh = solid_of(*mesh, model, primitive.name).mesh;
  } else {
    read_superquadric(value.at("superquadric"), intervals, primitive);
  }
  if (const auto pose = value.find("pose")) read_pose(*pose, intervals, primitive);
  if (const auto bend = value.find("bend")) primitive.bend = read_bend(*bend);
  return primitive;
}

std::vector<UncertainPrimitive> read_primitives(const JsonValue& value, std::string_view model, Intervals intervals) {
  std::vector<UncertainPrimitive> primitives;
  std::set<std::string> names;
  for (std::size_t k = 0; k < value.size(); ++k) {
    const JsonValue element = value.element(k);
    primitives.push_back(read_primitive(element, model, intervals));
    if (!names.insert(primitives.back().name).second) {
      element.at("name").fail("another primitive has this name");
    }
  }
  return primitives;
}

/// Trees of set operations on primitives that are known by name. Recursion is bounded by parse_json.
class SetExpressions {
 public:
  explicit SetExpressions(const std::vector<UncertainPrimitive>& primitives) {
    for (const UncertainPrimitive& primitive : primitives) {
      indices_.emplace(primitive.name, static_cast<std::uint32_t>(indices_.size()));
    }
  }

  /// {"union": [operand, ...]}, or intersection, or difference.
  [[nodiscard]] SetExpression read_operator(const JsonValue& value) const {
    value.check_keys({"union", "intersection", "difference"});
    if (value.json().size() != 1) value.fail("must have exactly one key: union, intersection or difference");
    const std::string& key = value.json().begin().key();
    SetExpression expression{.operation = operation(key)};
    const JsonValue operands = value.at(key);
    check_count(operands, expression.operation);
    for (std::size_t k = 0; k < operands.size(); ++k) expression.operands.push_back(read_operand(operands.element(k)));
    return expression;
  }

 private:
  static SetOperation operation(std::string_view key) {
    if (key == "union") return SetOperation::unite;
    return key == "intersection" ? SetOperation::intersect : SetOperation::subtract;
  }

  /// One operand is its own union and intersection; a difference of one has most likely lost the others.
  static void check_count(const JsonValue& operands, SetOperation operation) {
    if (operands.size() == 0) operands.fail("must have at least one operand");
    if (operation == SetOperation::subtract && operands.size() == 1) {
      operands.fail("must have at least two operands: the first without the others");
    }
  }

  [[nodiscard]] SetExpression read_operand(const JsonValue& value) const {
    if (value.json().is_object()) return read_operator(value);
    if (!value.json().is_string()) value.fail("must be the name of a primitive or an operator");
    const auto found = indices_.find(value.text());
    if (found == indices_.end()) value.fail("no primitive has this name");
    return {.primitive = found->second};
  }

  std::map<std::string, std::uint32_t> indices_;
};

/// Refuses intervals in a model whose bracketing models are not known: with tapers; with intervals of translations
/// unless it is a union of convex primitives.
void check_intervals(const UncertainModel& model, std::string_view name) {
  if (is_exact(model)) return;
  Model shape{model.units, {}, model.csg};
  for (const UncertainPrimitive& primitive : model.primitives) {
    shape.primitives.push_back({primitive.name, largest(primitive), {}, primitive.bend, primitive.mesh});
  }
  verify::require_no_taper(shape, fmt::format("{}: intervals", name));
  const bool moves = std::ranges::any_of(model.primitives, [](const UncertainPrimitive& primitive) {
    return std::ranges::any_of(primitive.translation, [](const Enclosure& t) { return t.lo != t.hi; });
  });
  if (moves) verify::require_union_of_convex(shape, fmt::format("{}: intervals of translations", name));
}

/// The whole contents of a model file.
struct ModelDocument {
  UncertainModel model;
  std::vector<AreaBox> areas;
  FemurLandmarks landmarks;
};

ModelDocument parse(std::string_view json, std::string_view name, Intervals intervals) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  if (!document.is_object()) root.fail("must be an object");
  const JsonValue format = root.at("format");
  if (format.text() != format_name) format.fail(fmt::format("must be \"{}\"", format_name));
  root.check_keys({"format", "units", "primitives", "csg", "areas", "landmarks"});
  ModelDocument result;
  UncertainModel& model = result.model;
  if (const auto units = root.find("units")) model.units = units->line();
  model.primitives = read_primitives(root.at("primitives"), name, intervals);
  if (const auto csg = root.find("csg")) model.csg = SetExpressions(model.primitives).read_operator(*csg);
  if (const auto fault = verify::fault_of(model)) root.at_place(fault->place).fail(fault->what);
  check_intervals(model, name);
  if (const auto areas = root.find("areas")) result.areas = read_area_boxes(*areas);
  if (const auto points = root.find("landmarks")) result.landmarks = read_landmark_points(*points);
  return result;
}

/// Hands the text of a file to `parse`, whole.
template <class Parse>
auto read(const std::filesystem::path& path, Parse parse) {
  constexpr std::size_t largest = std::size_t{1} << 26;
  InputFile file(path);
  const std::string_view text = file.peek_text(largest + 1);
  if (text.size() > largest) file.fail_whole(fmt::format("larger than {} bytes: not a model", largest));
  return parse(text, path.string());
}

}  // namespace

Model parse_model(std::string_view json, std::string_view name) {
  return verify::bracket_of_primitives(parse(json, name, Intervals::refused).model)
      .smallest;  // an exact model is its own bracket
}

UncertainModel parse_uncertain_model(std::string_view json, std::string_view name) {
  return parse(json, name, Intervals::allowed).model;
}

std::vector<AreaBox> parse_areas(std::string_view json, std::string_view name) {
  return parse(json, name, Intervals::allowed).areas;
}

FemurLandmarks parse_model_landmarks(std::string_view json, std::string_view name) {
  return parse(json, name, Intervals::allowed).landmarks;
}

Model model_of_mesh(Mesh mesh, const std::filesystem::path& path) {
  try {
    return {"", {mesh_primitive(path.stem().string(), std::move(mesh))}};
  } catch (const Error& error) {
    refuse(fmt::format("{}: {}", path.string(), error.what()));
  }
}

Model read_model(const std::filesystem::path& path) {
  return is_mesh_name(path) ? model_of_mesh(read_mesh(path), path) : read(path, parse_model);
}

UncertainModel read_uncertain_model(const std::filesystem::path& path) {
  return is_mesh_name(path) ? model_of_mesh(read_mesh(path), path) : read(path, parse_uncertain_model);
}

std::vector<AreaBox> read_areas(const std::filesystem::path& model) {
  return is_mesh_name(model) ? std::vector<AreaBox>() : read(model, parse_areas);
}

FemurLandmarks read_model_landmarks(const std::filesystem::path& model) {
  return is_mesh_name(model) ? FemurLandmarks() : read(model, parse_model_landmarks);
}

namespace {

/// Returns whether a document may be JSON of an object: blanks and a byte order mark may come first.
bool may_be_object(std::string_view beginning) {
  const std::size_t first = beginning.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  return first != std::string_view::npos && beginning[first] == '{';
}

/// All bytes that are not read yet, in little memory.
void add_rest(InputFile& file, Sha256& hash) {
  constexpr std::size_t block = std::size_t{1} << 16U;
  for (std::string_view bytes = file.peek(block); !bytes.empty(); bytes = file.peek(block)) {
    hash.add(std::as_bytes(std::span(bytes)));
    (void)file.take(bytes.size(), "the file");
  }
}

/// The files of the primitives' meshes, in their order. Empty for a file that is no model: its reader says so.
std::vector<std::filesystem::path> meshes_named_by(std::string_view json, const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files;
  const nlohmann::json document = nlohmann::json::parse(json, nullptr, false);
  if (!document.is_object() || !document.contains("primitives") || !document["primitives"].is_array()) return files;
  for (const nlohmann::json& primitive : document["primitives"]) {
    if (!primitive.is_object() || !primitive.contains("mesh")) continue;
    const nlohmann::json& mesh = primitive["mesh"];
    if (!mesh.is_object() || !mesh.contains("file") || !mesh["file"].is_string()) continue;
    files.push_back(beside(path, mesh["file"].get<std::string>()));
  }
  return files;
}

}  // namespace

std::string digest_of_model(std::string_view bytes, const std::filesystem::path& path) {
  Sha256 hash;
  hash.add(std::as_bytes(std::span(bytes)));
  if (!is_mesh_name(path) && may_be_object(bytes)) {
    for (const std::filesystem::path& mesh : meshes_named_by(bytes, path)) {
      InputFile file(mesh);
      add_rest(file, hash);
    }
  }
  return hash.digest();
}

SubjectFile subject_file(const std::filesystem::path& path) {
  constexpr std::size_t beginning = 64;
  const std::string name = path.filename().string();
  InputFile file(path);
  if (!is_mesh_name(path) && may_be_object(file.peek(beginning)))
    return {name, digest_of_model(file.peek(std::numeric_limits<std::size_t>::max()), path)};
  Sha256 hash;
  add_rest(file, hash);
  return {name, hash.digest()};
}

}  // namespace verisq
