/// Parses the XML part of a `.vtp` map and looks up what it declares.
#include "host/files/vtp_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>

#include "host/files/words.hpp"

namespace verisq {
namespace {

constexpr const char* point_data = "PointData";
constexpr const char* cell_data = "CellData";
constexpr std::size_t longest_xml = std::size_t{1} << 20;  // the writer's is a few thousand bytes

/// The file up to the '_' before the appended part, whose raw bytes are not XML.
std::string take_xml(InputFile& file) {
  const std::string_view start = file.peek(longest_xml).substr(0, longest_xml);
  const std::size_t appended = start.find("<AppendedData");
  const std::size_t underscore = appended == std::string_view::npos ? appended : start.find('_', appended);
  if (underscore == std::string_view::npos) {
    file.fail_whole(fmt::format("no appended data in the first {} bytes: not a map as .vtp", start.size()));
  }
  std::string xml(start.substr(0, underscore + 1));
  (void)file.take(underscore + 1, "the XML part");
  return xml;
}

}  // namespace

VtpDocument::VtpDocument(InputFile& file) : file_(file), text_(take_xml(file)) {
  const std::string_view xml = std::string_view(text_).substr(0, text_.size() - 1);
  // Closed as if nothing were appended. Where '_' was another one (in a comment, say), this does not parse.
  const std::string closed = std::string(xml) + "</AppendedData></VTKFile>";
  const auto result = xml_.load_buffer(closed.data(), closed.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    const std::size_t byte = std::min(static_cast<std::size_t>(result.offset), xml.size());
    file_.fail_whole(fmt::format("byte {}: not XML: {}", byte, result.description()));
  }
  check_attributes();
}

void VtpDocument::check_attributes() const {
  const pugi::xml_node root = only_child(xml_.root(), "VTKFile");
  expect(root, "type", "PolyData");
  expect(root, "version", "1.0");
  expect(root, "byte_order", "LittleEndian");
  expect(root, "header_type", "UInt64");
  expect(root, "compressor", "");
  expect(only_child(root, "AppendedData"), "encoding", "raw");
}

std::optional<MapElements> VtpDocument::elements_with(std::string_view name) const {
  const bool points = has_array(point_data, name);
  const bool cells = has_array(cell_data, name);
  if (points && cells) fail(piece(), fmt::format("both points and cells have a DataArray {}", in_quotes(name)));
  if (points) return MapElements::vertices;
  return cells ? std::optional(MapElements::triangles) : std::nullopt;
}

bool VtpDocument::has_array(const char* data, std::string_view name) const {
  if (!piece().child(data)) return false;
  const auto arrays = only_child(piece(), data).children("DataArray");
  return std::any_of(arrays.begin(), arrays.end(),
                     [&](pugi::xml_node array) { return array.attribute("Name").value() == name; });
}

DeclaredArray VtpDocument::element_array(MapElements elements, std::string_view name, std::string_view type,
                                         int components) const {
  const char* const data = elements == MapElements::vertices ? point_data : cell_data;
  const pugi::xml_node array = only_array(only_child(piece(), data), name, type, components);
  return {name, count(elements), whole_number(array, "offset")};
}

std::uint64_t VtpDocument::count(MapElements elements) const {
  if (elements == MapElements::vertices) return whole_number(piece(), "NumberOfPoints");
  // Cell data has a tuple for every cell, of whatever kind: another kind would shift the rows of the triangles.
  for (const char* other : {"NumberOfVerts", "NumberOfLines", "NumberOfStrips"}) expect(piece(), other, "0");
  return whole_number(piece(), "NumberOfPolys");
}

DeclaredArray VtpDocument::field_array(std::string_view name, std::string_view type, int components) const {
  const pugi::xml_node array = only_array(only_child(poly_data(), "FieldData"), name, type, components);
  return {name, whole_number(array, "NumberOfTuples"), whole_number(array, "offset")};
}

DeclaredArray VtpDocument::points(const VtpLayout& layout) const {
  const pugi::xml_node array = only_array(only_child(piece(), "Points"), "Points", "Float64", 3);
  return {"Points", layout.points, whole_number(array, "offset")};
}

DeclaredArray VtpDocument::connectivity(const VtpLayout& layout) const {
  const pugi::xml_node array = only_array(cells(layout), "connectivity", "Int64", 1);
  return {"connectivity", layout.cells(), whole_number(array, "offset")};
}

DeclaredArray VtpDocument::offsets(const VtpLayout& layout) const {
  const pugi::xml_node array = only_array(cells(layout), "offsets", "Int64", 1);
  return {"offsets", layout.cells(), whole_number(array, "offset")};
}

VtpLayout VtpDocument::layout(MapElements elements, std::uint64_t further_normals) const {
  return {elements, whole_number(piece(), "NumberOfPoints"), whole_number(piece(), "NumberOfPolys"), further_normals};
}

void VtpDocument::expect_only(const VtpLayout& layout) const {
  const std::string expected = vtp_declarations(layout);
  const auto [found, other] = std::ranges::mismatch(text_, expected);
  if (found == text_.end() && other == expected.end()) return;
  // From the last blank before: a whole element or attribute.
  const auto byte = static_cast<std::size_t>(found - text_.begin());
  const std::size_t start = byte == 0 ? 0 : text_.find_last_of(" \n", byte - 1) + 1;
  const auto shown = [start](std::string_view text) {
    const std::string_view rest = text.substr(start);
    return in_quotes(trimmed(rest.substr(0, rest.find('\n'))));
  };
  file_.fail_whole(fmt::format("byte {}: {}: expected {}", byte, shown(text_), shown(expected)));
}

pugi::xml_node VtpDocument::cells(const VtpLayout& layout) const {
  return only_child(piece(), layout.has_triangles() ? "Polys" : "Verts");
}

pugi::xml_node VtpDocument::poly_data() const {
  return only_child(xml_.child("VTKFile"), "PolyData");
}

pugi::xml_node VtpDocument::piece() const {
  return only_child(poly_data(), "Piece");
}

// A second one is refused: another reader might take that one, and show what was not checked.
pugi::xml_node VtpDocument::only_child(pugi::xml_node parent, const char* name) const {
  const pugi::xml_node child = parent.child(name);
  if (!child) fail(parent, fmt::format("no element {}", name));
  if (const pugi::xml_node second = child.next_sibling(name)) fail(second, "a second one");
  return child;
}

pugi::xml_node VtpDocument::only_array(pugi::xml_node parent, std::string_view name, std::string_view type,
                                       int components) const {
  pugi::xml_node found;
  for (const pugi::xml_node array : parent.children("DataArray")) {
    if (array.attribute("Name").value() != name) continue;
    if (!found.empty()) fail(array, fmt::format("Name = {}: a second one", in_quotes(name)));
    found = array;
  }
  if (!found) fail(parent, fmt::format("no DataArray with Name = {}", in_quotes(name)));
  expect(found, "type", type);
  expect(found, "NumberOfComponents", std::to_string(components));
  expect(found, "format", "appended");
  return found;
}

void VtpDocument::expect(pugi::xml_node element, const char* attribute, std::string_view value) const {
  const std::string_view found = element.attribute(attribute).value();  // empty where there is no such attribute
  if (found == value) return;
  fail(element, fmt::format("{} = {}: expected {}", attribute, in_quotes(found), in_quotes(value)));
}

std::uint64_t VtpDocument::whole_number(pugi::xml_node element, const char* attribute) const {
  const std::string_view text = element.attribute(attribute).value();
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && end == text.data() + text.size()) return number;
  fail(element, fmt::format("{} = {}: not a whole number of 64 bits", attribute, in_quotes(text)));
}

void VtpDocument::fail(pugi::xml_node element, std::string_view message) const {
  file_.fail_whole(fmt::format("byte {}: {}: {}", element.offset_debug(), in_quotes(element.name()), message));
}

}  // namespace verisq
