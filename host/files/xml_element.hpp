/// Strict reading of XML: every element knows its line, every attribute and child must be read, every number is finite.
#pragma once

#include <initializer_list>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace verisq {

/// An element of an XmlFile, which must outlive it. Every check throws Error(input): "NAME: line N: <ELEMENT>: what is
/// wrong", N being the line of the start tag.
class XmlElement {
 public:
  XmlElement(pugi::xml_node node, std::string_view text, std::string_view name)
      : node_(node), text_(text), name_(name) {}

  [[nodiscard]] std::string_view tag() const { return node_.name(); }

  /// Fails for any other attribute and for one that appears twice.
  void check_attributes(std::initializer_list<std::string_view> known) const;
  /// Fails for any other element and for text.
  void check_children(std::initializer_list<std::string_view> known) const;

  [[nodiscard]] bool has(const char* attribute) const { return !node_.attribute(attribute).empty(); }
  /// The value of an attribute; fails when it is missing or empty.
  [[nodiscard]] std::string text(const char* attribute) const;
  /// The text of an attribute; fails unless it is displayed unchanged: see `is_plain`.
  [[nodiscard]] std::string name(const char* attribute) const;
  /// The binary64 number nearest to an attribute's decimal digits; fails when it is missing or not finite.
  [[nodiscard]] double number(const char* attribute) const;

  /// The child of that name; fails when it is missing or when there are two.
  [[nodiscard]] XmlElement child(const char* tag) const;
  /// Nothing if it is missing.
  [[nodiscard]] std::optional<XmlElement> find(const char* tag) const;
  /// All children, in their order.
  [[nodiscard]] std::vector<XmlElement> children() const;
  /// The children with that tag.
  [[nodiscard]] std::vector<XmlElement> children(std::string_view tag) const;

  [[noreturn]] void fail(std::string_view what) const;
  /// Quotes the value of an attribute: "... <ELEMENT>: ATTRIBUTE = 'VALUE': what".
  [[noreturn]] void fail(const char* attribute, std::string_view what) const;

 private:
  pugi::xml_node node_;
  std::string_view text_;  // of the whole file: for lines
  std::string_view name_;
};

/// A parsed file. `text` and `name` must outlive it.
class XmlFile {
 public:
  /// Throws Error(input), one line that starts with `name`, for a text that is no XML and for more than one root.
  XmlFile(std::string_view text, std::string_view name);

  [[nodiscard]] XmlElement root() const { return {document_.first_child(), text_, name_}; }

 private:
  std::string_view text_;
  std::string_view name_;
  pugi::xml_document document_;
};

}  // namespace verisq
