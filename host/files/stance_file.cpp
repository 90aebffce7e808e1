/// The stance model format: reads the format of docs/stance.md, and refuses everything else with a message.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>
#include <verisq/stance.hpp>

#include "host/files/input_file.hpp"
#include "host/files/xml_element.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq::stance {
namespace {

/// Reads quantities in the order of the file. The first that names a parameter defines it; later ones that give its
/// name alone share it.
class Quantities {
 public:
  /// One of  value="V";  lower="L" upper="U" with an optional nominal="N", else the midpoint;  nominal="N"
  /// deviation="D". Each has an optional parameter="NAME", which unit="..." and description="..." may explain, and
  /// which a deviation must have. Or parameter="NAME" alone. Fails if `allowed` refuses an end of the range, with
  /// `what` it must be.
  [[nodiscard]] Quantity read(const XmlElement& element, const std::function<bool(double)>& allowed, const char* what);

  /// Components x, y, z: each an attribute, which is exact, or a child that is a quantity.
  [[nodiscard]] QuantityVector read_vector(const XmlElement& element, const std::function<bool(double)>& allowed,
                                           const char* what);
  [[nodiscard]] QuantityVector read_vector(const XmlElement& element);

  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }

 private:
  [[nodiscard]] std::optional<std::uint32_t> index_of(std::string_view name) const;
  [[nodiscard]] Quantity known(const XmlElement& element) const;
  [[nodiscard]] Quantity define(const XmlElement& element, Quantity quantity);

  std::vector<Parameter> parameters_;
};

constexpr std::array axes{"x", "y", "z"};

bool any_number(double /*number*/) {
  return true;
}

/// Names stand in lists on the command line, where "all" and "none" mean something else.
void check_name(const XmlElement& element, std::string_view name) {
  const auto is_letter = [](char c) { return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z'); };
  const auto is_allowed = [&](char c) { return is_letter(c) || ('0' <= c && c <= '9') || c == '_'; };
  if (!is_letter(name[0]) || !std::ranges::all_of(name, is_allowed)) {
    element.fail("parameter", "must be letters, digits and _, a letter first");
  }
  if (name == "all" || name == "none") element.fail("parameter", "is a word of the command line");
}

Quantity exact(double value) {
  return {value, {value, value}, std::nullopt};
}

/// lower and upper; the midpoints of ranges are the paper's nominal values.
Quantity between_ends(const XmlElement& element) {
  if (element.has("deviation")) element.fail("deviation", "give lower and upper, or nominal and deviation");
  const Enclosure range{element.number("lower"), element.number("upper")};
  if (range.lo > range.hi) {
    element.fail(fmt::format("lower = {} exceeds upper = {}", element.text("lower"), element.text("upper")));
  }
  if (!element.has("nominal")) return {std::midpoint(range.lo, range.hi), range, std::nullopt};
  const double nominal = element.number("nominal");
  if (!range.contains(nominal)) element.fail("nominal", "is not between lower and upper");
  return {nominal, range, std::nullopt};
}

Quantity around_nominal(const XmlElement& element) {
  using verify::Direction;
  const double nominal = element.number("nominal");
  const double deviation = element.number("deviation");
  if (deviation < 0.0) element.fail("deviation", "must not be negative");
  // Rounded outward: the range contains nominal +- deviation.
  const Enclosure range{verify::subtract(nominal, deviation, Direction::down),
                        verify::add(nominal, deviation, Direction::up)};
  if (!std::isfinite(range.width())) element.fail("deviation", "the range is beyond binary64");
  return {nominal, range, std::nullopt};
}

Quantity numbers_of(const XmlElement& element) {
  if (element.has("value")) {
    for (const char* other : {"nominal", "deviation", "lower", "upper"}) {
      if (element.has(other)) element.fail(other, "give value alone, or a range");
    }
    return exact(element.number("value"));
  }
  if (element.has("lower") || element.has("upper")) return between_ends(element);
  if (element.has("nominal") || element.has("deviation")) return around_nominal(element);
  element.fail("no number: give value, lower and upper, or nominal and deviation");
}

bool is_name_alone(const XmlElement& element) {
  return element.has("parameter") && std::ranges::none_of(std::array{"value", "nominal", "deviation", "lower", "upper"},
                                                          [&](const char* word) { return element.has(word); });
}

std::string text_if_any(const XmlElement& element, const char* attribute) {
  return element.has(attribute) ? element.text(attribute) : "";
}

Quantity Quantities::read(const XmlElement& element, const std::function<bool(double)>& allowed, const char* what) {
  element.check_attributes({"parameter", "unit", "description", "value", "nominal", "deviation", "lower", "upper"});
  element.check_children({});
  const Quantity quantity = is_name_alone(element) ? known(element) : define(element, numbers_of(element));
  for (const double end : {quantity.range.lo, quantity.range.hi}) {
    if (!allowed(end)) element.fail(fmt::format("{} {}", end, what));
  }
  return quantity;
}

QuantityVector Quantities::read_vector(const XmlElement& element, const std::function<bool(double)>& allowed,
                                       const char* what) {
  element.check_attributes({"x", "y", "z"});
  element.check_children({"x", "y", "z"});
  QuantityVector vector;
  for (std::size_t k = 0; k < vector.size(); ++k) {
    const std::optional<XmlElement> child = element.find(axes[k]);
    if (child && element.has(axes[k])) child->fail("given as an attribute, too");
    if (child) {
      vector[k] = read(*child, allowed, what);
      continue;
    }
    if (!element.has(axes[k])) element.fail(fmt::format("{} is missing: give an attribute or an element", axes[k]));
    vector[k] = exact(element.number(axes[k]));
    if (!allowed(vector[k].nominal)) element.fail(axes[k], what);
  }
  return vector;
}

QuantityVector Quantities::read_vector(const XmlElement& element) {
  return read_vector(element, any_number, "");
}

std::optional<std::uint32_t> Quantities::index_of(std::string_view name) const {
  const auto found = std::ranges::find(parameters_, name, &Parameter::name);
  if (found == parameters_.end()) return std::nullopt;
  return static_cast<std::uint32_t>(found - parameters_.begin());
}

Quantity Quantities::known(const XmlElement& element) const {
  const std::optional<std::uint32_t> index = index_of(element.text("parameter"));
  if (!index) element.fail("parameter", "has no numbers here, nor before");
  for (const char* word : {"unit", "description"}) {
    if (element.has(word)) element.fail(word, "belongs where the parameter has its numbers");
  }
  const Parameter& parameter = parameters_[*index];
  return {parameter.nominal, parameter.range, index};
}

Quantity Quantities::define(const XmlElement& element, Quantity quantity) {
  if (!element.has("parameter")) {
    for (const char* word : {"unit", "description"}) {
      if (element.has(word)) element.fail(word, "explains a parameter: give its name, too");
    }
    // No analysis would use the range.
    if (quantity.range.lo != quantity.range.hi) element.fail("a range needs the name of a parameter");
    return quantity;
  }
  const std::string name = element.text("parameter");
  check_name(element, name);
  if (index_of(name)) element.fail("parameter", "has its numbers before: give the name alone");
  quantity.parameter = static_cast<std::uint32_t>(parameters_.size());
  parameters_.push_back({name, element.has("unit") ? element.name("unit") : "", text_if_any(element, "description"),
                         quantity.nominal, quantity.range});
  return quantity;
}

constexpr const char* must_be_positive = "must be positive";
constexpr const char* must_not_be_negative = "must not be negative";

bool is_positive(double number) {
  return number > 0.0;
}

bool is_not_negative(double number) {
  return number >= 0.0;
}

bool is_restitution(double number) {
  return 0.0 < number && number < 1.0;
}

double positive(const XmlElement& element, const char* attribute) {
  const double number = element.number(attribute);
  if (!is_positive(number)) element.fail(attribute, must_be_positive);
  return number;
}

double not_negative(const XmlElement& element, const char* attribute) {
  const double number = element.number(attribute);
  if (!is_not_negative(number)) element.fail(attribute, must_not_be_negative);
  return number;
}

double number_or_zero(const XmlElement& element, const char* attribute) {
  return element.has(attribute) ? element.number(attribute) : 0.0;
}

/// Reads one file from top to bottom: whatever a name refers to stands before.
class ModelReader {
 public:
  [[nodiscard]] Model read(const XmlElement& root) {
    if (root.tag() != "stance") root.fail("the root must be <stance>");
    root.check_attributes({"gravity"});
    root.check_children({"applied_force", "body", "cylinder"});
    model_.gravity = not_negative(root, "gravity");
    for (const XmlElement& element : root.children()) read_part(element);
    if (model_.bodies.empty()) root.fail("element <body> is missing");
    if (model_.degrees_of_freedom() == 0) root.fail("no body has a joint");
    if (!applied_) root.fail("element <applied_force> is missing");
    model_.parameters = quantities_.parameters();
    return std::move(model_);
  }

 private:
  void read_part(const XmlElement& element) {
    if (element.tag() == "body") {
      read_body(element);
    } else if (element.tag() == "cylinder") {
      model_.cylinders.push_back(read_cylinder(element));
    } else {
      read_applied_force(element);
    }
  }

  void read_applied_force(const XmlElement& element) {
    if (applied_) element.fail("a second one in <stance>");
    applied_ = true;
    element.check_attributes({});
    element.check_children({"frequency", "force"});
    model_.applied.frequency = quantities_.read(element.child("frequency"), is_not_negative, must_not_be_negative);
    model_.applied.force = quantities_.read_vector(element.child("force"));
  }

  void read_body(const XmlElement& element) {
    element.check_attributes({"name", "parent"});
    element.check_children({"offset", "translation", "rotation", "mass", "centre_of_mass", "inertia"});
    Body body;
    body.name = element.name("name");
    body.parent = read_parent(element);
    const std::optional<XmlElement> offset = body.parent ? element.child("offset") : element.find("offset");
    if (offset) body.offset = quantities_.read_vector(*offset);
    const auto index = static_cast<std::uint32_t>(model_.bodies.size());
    for (const XmlElement& part : element.children()) {
      if (part.tag() == "translation" || part.tag() == "rotation") read_joint(part, index, body.joints);
    }
    body.mass = quantities_.read(element.child("mass"), is_positive, must_be_positive);
    body.centre_of_mass = quantities_.read_vector(element.child("centre_of_mass"));
    body.inertia = quantities_.read_vector(element.child("inertia"), is_not_negative, must_not_be_negative);
    if (!bodies_.emplace(body.name, index).second) element.fail("name", "another body has this name");
    model_.bodies.push_back(std::move(body));
  }

  /// Nothing for the root, which is the first body and the only one without a parent.
  [[nodiscard]] std::optional<std::uint32_t> read_parent(const XmlElement& element) const {
    if (model_.bodies.empty()) {
      if (element.has("parent")) element.fail("parent", "the first body is the root and has none");
      return std::nullopt;
    }
    return known_body(element, "parent");
  }

  [[nodiscard]] std::uint32_t known_body(const XmlElement& element, const char* attribute) const {
    const auto found = bodies_.find(element.text(attribute));
    if (found == bodies_.end()) element.fail(attribute, "no body before this element has this name");
    return found->second;
  }

  void read_joint(const XmlElement& element, std::uint32_t body, std::vector<Joint>& joints) {
    element.check_attributes({"name", "axis", "position", "velocity"});
    element.check_children({"pid"});
    const std::string name = element.name("name");
    if (std::ranges::find(joints, name, &Joint::name) != joints.end()) {
      element.fail("name", "another joint of this body has this name");
    }
    const std::string axis = element.text("axis");
    if (axis != "x" && axis != "y" && axis != "z") element.fail("axis", "must be x, y or z");
    const auto index = static_cast<std::uint32_t>(joints.size());
    if (const auto pid = element.find("pid")) model_.controllers.push_back(read_controller(*pid, body, index));
    joints.push_back({name, element.tag() == "rotation" ? JointKind::rotation : JointKind::translation,
                      static_cast<std::uint8_t>(axis[0] - 'x'), number_or_zero(element, "position"),
                      number_or_zero(element, "velocity")});
  }

  [[nodiscard]] static Controller read_controller(const XmlElement& element, std::uint32_t body, std::uint32_t joint) {
    element.check_attributes({"proportional", "integral", "derivative"});
    element.check_children({});
    return {body, joint, not_negative(element, "proportional"), not_negative(element, "integral"),
            not_negative(element, "derivative")};
  }

  [[nodiscard]] ContactCylinder read_cylinder(const XmlElement& element) {
    element.check_attributes({"name", "body", "half_length", "stiffness", "exponent", "impact_velocity",
                              "stribeck_velocity", "bristle_stiffness", "bristle_damping"});
    element.check_children({"stiffness", "impact_velocity", "centre", "axis", "radius", "normal_restitution",
                            "tangential_restitution", "static_friction", "dynamic_friction"});
    ContactCylinder cylinder{};
    cylinder.name = element.name("name");
    if (!cylinders_.insert(cylinder.name).second) element.fail("name", "another cylinder has this name");
    cylinder.body = known_body(element, "body");
    cylinder.half_length = positive(element, "half_length");
    cylinder.stiffness = read_attribute_or_child(element, "stiffness");
    cylinder.exponent = element.number("exponent");
    if (cylinder.exponent != 1.0 && cylinder.exponent != 1.5) element.fail("exponent", "must be 1 or 1.5");
    cylinder.impact_velocity = read_attribute_or_child(element, "impact_velocity");
    cylinder.stribeck_velocity = positive(element, "stribeck_velocity");
    cylinder.centre = quantities_.read_vector(element.child("centre"));
    cylinder.axis = read_axis(element.child("axis"));
    cylinder.radius = quantities_.read(element.child("radius"), is_positive, must_be_positive);
    read_surface(element, cylinder);
    read_bristles(element, cylinder);
    return cylinder;
  }

  /// An attribute, which is exact, or a child that is a quantity; positive.
  [[nodiscard]] Quantity read_attribute_or_child(const XmlElement& element, const char* name) {
    const std::optional<XmlElement> child = element.find(name);
    if (!child && !element.has(name)) {
      element.fail(fmt::format("{} is missing: give an attribute or an element", name));
    }
    if (child && element.has(name)) child->fail("given as an attribute, too");
    if (child) return quantities_.read(*child, is_positive, must_be_positive);
    const double number = positive(element, name);
    return {number, {number, number}, std::nullopt};
  }

  void read_surface(const XmlElement& element, ContactCylinder& cylinder) {
    constexpr const char* must_be_restitution = "must be between 0 and 1, both excluded";
    cylinder.normal_restitution =
        quantities_.read(element.child("normal_restitution"), is_restitution, must_be_restitution);
    cylinder.tangential_restitution =
        quantities_.read(element.child("tangential_restitution"), is_restitution, must_be_restitution);
    cylinder.static_friction =
        quantities_.read(element.child("static_friction"), is_not_negative, must_not_be_negative);
    cylinder.dynamic_friction =
        quantities_.read(element.child("dynamic_friction"), is_not_negative, must_not_be_negative);
  }

  /// Both or none of the numbers.
  static void read_bristles(const XmlElement& element, ContactCylinder& cylinder) {
    if (!element.has("bristle_stiffness") && !element.has("bristle_damping")) return;
    cylinder.bristle_stiffness = positive(element, "bristle_stiffness");
    cylinder.bristle_damping = positive(element, "bristle_damping");
  }

  /// Not scaled to length 1, so that the model has the numbers of the file.
  [[nodiscard]] static std::array<double, 3> read_axis(const XmlElement& element) {
    constexpr double tolerance = 1e-9;
    element.check_attributes({"x", "y", "z"});
    element.check_children({});
    const std::array axis{element.number("x"), element.number("y"), element.number("z")};
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    if (!(std::abs(length - 1.0) <= tolerance)) {
      element.fail(fmt::format("its length is {:.10g}, must be 1 to within {:g}", length, tolerance));
    }
    return axis;
  }

  Model model_{};
  Quantities quantities_;
  bool applied_ = false;
  std::map<std::string, std::uint32_t, std::less<>> bodies_;
  std::set<std::string> cylinders_;
};

}  // namespace

Model parse_model(std::string_view xml, std::string_view name) {
  const XmlFile file(xml, name);
  return ModelReader().read(file.root());
}

Model read_model(const std::filesystem::path& path) {
  constexpr std::size_t largest = std::size_t{1} << 24;
  InputFile file(path);
  const std::string_view text = file.peek_text(largest + 1);
  if (text.size() > largest) file.fail_whole(fmt::format("larger than {} bytes: not a stance model", largest));
  const std::string name = path.string();
  return parse_model(text, name);
}

}  // namespace verisq::stance
