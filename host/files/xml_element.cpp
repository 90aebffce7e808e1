/// XML by pugixml, with checks of errors that pugixml accepts: control characters, text between elements, attributes
/// that appear twice.
#include "host/files/xml_element.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <verisq/error.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

std::size_t line_of(std::string_view text, std::ptrdiff_t byte) {
  const auto before = text.substr(0, static_cast<std::size_t>(std::max<std::ptrdiff_t>(byte, 0)));
  return 1 + static_cast<std::size_t>(std::ranges::count(before, '\n'));
}

[[noreturn]] void refuse(std::string_view name, std::size_t line, std::string_view what) {
  throw Error(ErrorKind::input, fmt::format("{}: line {}: {}", name, line, what));
}

/// XML 1.0 has no others below the blank.
bool is_control_character(char c) {
  const auto code = static_cast<unsigned char>(c);
  return code == 0x7f || (code < 0x20 && c != '\n' && c != '\r' && c != '\t');
}

bool is_text(pugi::xml_node node) {
  return node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata;
}

}  // namespace

void XmlElement::check_attributes(std::initializer_list<std::string_view> known) const {
  for (const pugi::xml_attribute attribute : node_.attributes()) {
    if (std::ranges::find(known, attribute.name()) == known.end()) {
      fail(fmt::format("unknown attribute {}", in_quotes(attribute.name())));
    }
    if (node_.attribute(attribute.name()) != attribute) {
      fail(fmt::format("attribute {} appears twice", in_quotes(attribute.name())));
    }
  }
}

void XmlElement::check_children(std::initializer_list<std::string_view> known) const {
  for (const pugi::xml_node node : node_.children()) {
    if (is_text(node)) fail(fmt::format("unexpected text {}", in_quotes(node.value())));
    if (std::ranges::find(known, node.name()) == known.end()) {
      XmlElement(node, text_, name_).fail(fmt::format("unknown element in <{}>", tag()));
    }
  }
}

std::string XmlElement::text(const char* attribute) const {
  if (!has(attribute)) fail(fmt::format("attribute {} is missing", attribute));
  std::string value = node_.attribute(attribute).value();
  if (trimmed(value).empty()) fail(attribute, "must not be blank");
  return value;
}

std::string XmlElement::name(const char* attribute) const {
  std::string value = text(attribute);
  if (!is_plain(value)) {
    fail(attribute, fmt::format("must be letters, digits and signs of one line, at most {}, single blanks between them",
                                longest_quotation));
  }
  return value;
}

double XmlElement::number(const char* attribute) const {
  const std::string value = text(attribute);
  double number = 0.0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error == std::errc::invalid_argument || end != value.data() + value.size()) fail(attribute, "not a number");
  if (error == std::errc::result_out_of_range) fail(attribute, "beyond the range of binary64");
  if (!std::isfinite(number)) fail(attribute, "not a finite number");
  return number;
}

XmlElement XmlElement::child(const char* tag) const {
  const std::optional<XmlElement> found = find(tag);
  if (!found) fail(fmt::format("element <{}> is missing", tag));
  return *found;
}

std::optional<XmlElement> XmlElement::find(const char* tag) const {
  const std::vector<XmlElement> all = children(tag);
  if (all.empty()) return std::nullopt;
  if (all.size() > 1) all[1].fail(fmt::format("a second one in <{}>", this->tag()));
  return all[0];
}

std::vector<XmlElement> XmlElement::children() const {
  std::vector<XmlElement> result;
  for (const pugi::xml_node node : node_.children()) {
    if (node.type() == pugi::node_element) result.emplace_back(node, text_, name_);
  }
  return result;
}

std::vector<XmlElement> XmlElement::children(std::string_view tag) const {
  std::vector<XmlElement> result = children();
  std::erase_if(result, [&](const XmlElement& element) { return element.tag() != tag; });
  return result;
}

void XmlElement::fail(std::string_view what) const {
  const std::string quoted = in_quotes(tag());
  const std::string shown = quoted.substr(1, quoted.size() - 2);
  refuse(name_, line_of(text_, node_.offset_debug()), fmt::format("<{}>: {}", shown, what));
}

void XmlElement::fail(const char* attribute, std::string_view what) const {
  fail(fmt::format("{} = {}: {}", attribute, in_quotes(node_.attribute(attribute).value()), what));
}

XmlFile::XmlFile(std::string_view text, std::string_view name) : text_(text), name_(name) {
  if (const auto* const found = std::ranges::find_if(text, is_control_character); found != text.end()) {
    refuse(name, line_of(text, found - text.begin()),
           fmt::format("not XML: control character {}", printable({found, found + 1})));
  }
  // As a fragment, so that text outside the root is found and refused, not skipped.
  const auto result =
      document_.load_buffer(text.data(), text.size(), pugi::parse_default | pugi::parse_fragment, pugi::encoding_utf8);
  if (!result) refuse(name, line_of(text, result.offset), fmt::format("not XML: {}", result.description()));
  const auto nodes = document_.children();
  if (nodes.begin() == nodes.end())
    refuse(name, line_of(text, static_cast<std::ptrdiff_t>(text.size())), "not XML: no element");
  for (const pugi::xml_node node : nodes) {
    if (is_text(node))
      throw Error(ErrorKind::input,
                  fmt::format("{}: not XML: text outside of the root: {}", name, in_quotes(node.value())));
    if (node != *nodes.begin()) XmlElement(node, text, name).fail("not XML: a second root");
  }
}

}  // namespace verisq
