/// The model format `verisq-model/1`: what the contract (design 1, "Model file") accepts and refuses.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>
#include <verisq/model_file.hpp>

#include "host/files/input_file.hpp"
#include "host/files/json_document.hpp"

namespace verisq {
namespace {

constexpr std::string_view format_name = "verisq-model/1";

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

/// Numbers that the contract lets be uncertain.
template <std::size_t N>
std::array<double, N> numbers_or_intervals(const JsonValue& value) {
  check_size(value, N);
  for (std::size_t k = 0; k < N; ++k) {
    const JsonValue element = value.element(k);
    if (is_interval(element.json())) element.fail("intervals are not supported yet");
  }
  return numbers<N>(value);
}

Superquadric read_superquadric(const JsonValue& value) {
  value.check_keys({"semi_axes", "exponents"});
  const JsonValue semi_axes = value.at("semi_axes");
  const JsonValue exponents = value.at("exponents");
  const Superquadric result{numbers_or_intervals<3>(semi_axes), numbers_or_intervals<2>(exponents)};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(result.semi_axes[k] > 0.0)) semi_axes.element(k).fail("must be positive");
  }
  for (std::size_t k = 0; k < 2; ++k) {
    if (!(0.0 < result.exponents[k] && result.exponents[k] <= 2.0)) exponents.element(k).fail("must be in (0, 2]");
  }
  return result;
}

Pose read_pose(const JsonValue& value) {
  value.check_keys({"translation", "quaternion"});
  Pose pose;
  if (const auto translation = value.find("translation")) pose.translation = numbers_or_intervals<3>(*translation);
  if (const auto quaternion = value.find("quaternion")) {
    pose.quaternion = numbers<4>(*quaternion);
    const bool zero = std::all_of(pose.quaternion.begin(), pose.quaternion.end(), [](double q) { return q == 0.0; });
    if (zero) quaternion->fail("must not be zero");
  }
  return pose;
}

Primitive read_primitive(const JsonValue& value) {
  value.check_keys({"name", "superquadric", "bend", "pose"});
  Primitive primitive{value.at("name").text(), read_superquadric(value.at("superquadric")), {}};
  if (const auto pose = value.find("pose")) primitive.pose = read_pose(*pose);
  if (const auto bend = value.find("bend")) bend->fail_key("bent superquadrics are not supported yet");
  return primitive;
}

std::vector<Primitive> read_primitives(const JsonValue& value) {
  std::vector<Primitive> primitives;
  std::set<std::string> names;
  for (std::size_t k = 0; k < value.size(); ++k) {
    const JsonValue element = value.element(k);
    primitives.push_back(read_primitive(element));
    if (!names.insert(primitives.back().name).second) {
      element.at("name").fail("another primitive has this name");
    }
  }
  if (primitives.empty()) value.fail("must have at least one primitive");
  return primitives;
}

/// The names in a tree of set operations, every one known.
class SetOperations {
 public:
  explicit SetOperations(const std::vector<Primitive>& primitives) {
    for (const Primitive& primitive : primitives) known_.insert(primitive.name);
  }

  /// {"union": [operand, ...]}; the others are valid, but refused. Recursion is bounded by parse_json.
  void read_operator(const JsonValue& value) {
    value.check_keys({"union", "intersection", "difference"});
    if (value.json().size() != 1) value.fail("must have exactly one key: union, intersection or difference");
    const std::string operation = value.json().begin().key();
    const JsonValue operands = value.at(operation);
    if (operands.size() == 0) operands.fail("must have at least one operand");
    for (std::size_t k = 0; k < operands.size(); ++k) read_operand(operands.element(k));
    if (operation != "union") operands.fail_key("not supported yet: only the union of all primitives is");
  }

  void check_all_used(const JsonValue& csg) const {
    for (const std::string& name : known_) {
      if (used_.contains(name)) continue;
      csg.fail_key(fmt::format("leaves out primitive {}: not supported yet, only the union of all primitives is",
                               nlohmann::json(name).dump(-1, ' ', true)));
    }
  }

 private:
  void read_operand(const JsonValue& value) {
    if (value.json().is_object()) return read_operator(value);
    if (!value.json().is_string()) value.fail("must be the name of a primitive or an operator");
    const std::string name = value.text();
    if (!known_.contains(name)) value.fail("no primitive has this name");
    used_.insert(name);
  }

  std::set<std::string> known_;
  std::set<std::string> used_;
};

}  // namespace

Model parse_model(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  if (!document.is_object()) root.fail("must be an object");
  const JsonValue format = root.at("format");
  if (format.text() != format_name) format.fail(fmt::format("must be \"{}\"", format_name));
  root.check_keys({"format", "units", "primitives", "csg"});
  Model model;
  if (const auto units = root.find("units")) model.units = units->text();
  model.primitives = read_primitives(root.at("primitives"));
  if (const auto csg = root.find("csg")) {
    SetOperations operations(model.primitives);
    operations.read_operator(*csg);
    operations.check_all_used(*csg);
  }
  return model;
}

Model read_model(const std::filesystem::path& path) {
  constexpr std::size_t largest = std::size_t{1} << 26;
  InputFile file(path);
  const std::string_view text = file.peek(largest + 1);
  if (text.size() > largest) file.fail_whole(fmt::format("larger than {} bytes: not a model", largest));
  return parse_model(text, path.string());
}

}  // namespace verisq
