/// Parses the header of PLY files.
#include "host/files/ply_header.hpp"

#include <fmt/format.h>

#include <array>
#include <set>
#include <utility>

#include "host/files/words.hpp"

namespace verisq {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};

constexpr std::array<TypeName, 16> type_names{{
    {"char", PlyType::int8},
    {"int8", PlyType::int8},
    {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},
    {"short", PlyType::int16},
    {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},
    {"uint16", PlyType::uint16},
    {"int", PlyType::int32},
    {"int32", PlyType::int32},
    {"uint", PlyType::uint32},
    {"uint32", PlyType::uint32},
    {"float", PlyType::float32},
    {"float32", PlyType::float32},
    {"double", PlyType::float64},
    {"float64", PlyType::float64},
}};

PlyType parse_type(const InputFile& file, std::string_view word) {
  for (const auto& [name, type] : type_names) {
    if (name == word) return type;
  }
  file.fail(fmt::format("property type {}: not a type of PLY", in_quotes(word)));
}

PlyEncoding parse_encoding(const InputFile& file, Words words) {
  const std::string_view encoding = words.next();
  const std::string_view version = words.next();
  expect_end(file, words);
  if (version != "1.0") file.fail(fmt::format("version {}: must be 1.0", in_quotes(version)));
  if (encoding == "ascii") return PlyEncoding::ascii;
  if (encoding == "binary_little_endian") return PlyEncoding::little_endian;
  if (encoding == "binary_big_endian") return PlyEncoding::big_endian;
  file.fail(fmt::format("format {}: known are ascii, binary_little_endian, binary_big_endian", in_quotes(encoding)));
}

/// `names` are those of the elements so far.
void add_element(const InputFile& file, Words words, PlyHeader& header, std::set<std::string>& names) {
  const std::string name(words.next());
  const std::int64_t count = integer(file, words.next(), "number of elements");
  expect_end(file, words);
  if (count < 0) file.fail(fmt::format("number of elements = {}: must not be negative", count));
  if (!names.insert(name).second) file.fail(fmt::format("element {}: appears twice", in_quotes(name)));
  header.elements.push_back({name, static_cast<std::uint64_t>(count), {}, {}});
}

void add_property(const InputFile& file, Words words, PlyHeader& header) {
  if (header.elements.empty()) file.fail("a property before the first element");
  PlyProperty property{};
  std::string_view type = words.next();
  if (type == "list") {
    property.count_type = parse_type(file, words.next());
    if (!is_integer(*property.count_type)) file.fail("the length of a list must have an integer type");
    type = words.next();
  }
  property.type = parse_type(file, type);
  property.name = words.next();
  if (property.name.empty()) file.fail("a property without a name");
  property.shown = in_quotes(property.name);
  expect_end(file, words);
  PlyElement& element = header.elements.back();
  const bool fresh = element.positions.emplace(property.name, element.properties.size()).second;
  if (!fresh) file.fail(fmt::format("property {}: appears twice", property.shown));
  element.properties.push_back(std::move(property));
}

Words next_header_line(InputFile& file) {
  const auto line = file.next_line();
  if (!line) file.fail("truncated: the file ends without 'end_header'");
  return Words(*line);
}

void check_elements(const InputFile& file, const PlyHeader& header) {
  for (const PlyElement& element : header.elements) {
    if (element.count > 0 && element.properties.empty()) {
      file.fail(fmt::format("element {}: has no properties", in_quotes(element.name)));
    }
  }
}

}  // namespace

std::size_t bytes_of(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8: return 1;
    case PlyType::int16:
    case PlyType::uint16: return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32: return 4;
    case PlyType::float64: break;
  }
  return 8;
}

bool is_integer(PlyType type) {
  return type != PlyType::float32 && type != PlyType::float64;
}

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  const auto found = positions.find(property);
  if (found == positions.end()) return std::nullopt;
  return found->second;
}

PlyHeader read_ply_header(InputFile& file) {
  Words first = next_header_line(file);
  if (first.next() != "ply" || !first.empty()) file.fail("not a PLY file: the first line must be 'ply'");
  Words second = next_header_line(file);
  if (second.next() != "format") file.fail("the line after 'ply' must be 'format ENCODING 1.0'");
  PlyHeader header{parse_encoding(file, second), {}};
  std::set<std::string> element_names;
  while (true) {
    Words words = next_header_line(file);
    const std::string_view keyword = words.next();
    if (keyword == "element") {
      add_element(file, words, header, element_names);
    } else if (keyword == "property") {
      add_property(file, words, header);
    } else if (keyword == "end_header") {
      check_elements(file, header);
      return header;
    } else if (keyword != "comment" && keyword != "obj_info") {
      file.fail(fmt::format("header keyword {}: not known", in_quotes(keyword)));
    }
  }
}

}  // namespace verisq
