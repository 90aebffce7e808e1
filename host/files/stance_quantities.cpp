/// The attributes that give deviations (paper §3: "additional attributes for defining the deviation").
#include "host/files/stance_quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "verify/numbers/rounding.hpp"

namespace verisq::stance {
namespace {

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

}  // namespace

Quantity Quantities::read(const XmlElement& element, const std::function<bool(double)>& allowed, const char* what) {
  element.check_attributes({"parameter", "unit", "description", "value", "nominal", "deviation", "lower", "upper"});
  element.check_children({});
  const Quantity quantity = is_name_alone(element) ? known(element) : define(element, numbers_of(element));
  for (const double end : {quantity.range.lo, quantity.range.hi}) {
    if (!allowed(end)) element.fail(fmt::format("{} {}", end, what));
  }
  return quantity;
}

Quantity Quantities::read(const XmlElement& element) {
  return read(element, any_number, "");
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
    // No analysis would look at the range.
    if (quantity.range.lo != quantity.range.hi) element.fail("a range needs the name of a parameter");
    return quantity;
  }
  const std::string name = element.text("parameter");
  check_name(element, name);
  if (index_of(name)) element.fail("parameter", "has its numbers before: give the name alone");
  quantity.parameter = static_cast<std::uint32_t>(parameters_.size());
  parameters_.push_back(
      {name, text_if_any(element, "unit"), text_if_any(element, "description"), quantity.nominal, quantity.range});
  return quantity;
}

}  // namespace verisq::stance
