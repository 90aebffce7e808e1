/// Certified maps as VTK XML PolyData: the arrays of picture, enclosures and certificates, checked before any is used.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/map_file.hpp>
#include <verisq/mesh.hpp>

#include "host/files/input_file.hpp"
#include "host/files/map_layout.hpp"
#include "host/files/vtk_arrays.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

// The XML part of a `.vtp` map: which arrays it declares and where their bytes lie.

/// An array in the appended part, as a DataArray element states it: nothing is known yet of the bytes it speaks of.
struct DeclaredArray {
  std::string_view name;
  std::uint64_t tuples;
  std::uint64_t offset;  ///< from the first byte of the appended part
};

/// The form that the writer writes ("VTK File Formats", XML): PolyData of one piece with appended raw arrays,
/// little-endian, version 1.0 with UInt64 headers. All members throw Error(input) naming the byte of the element and
/// the value.
class VtpDocument {
 public:
  /// Reads `file`, which must outlive this, as far as the '_' before the appended part.
  explicit VtpDocument(InputFile& file);

  /// The elements that have an array of that name: a tuple for each point or for each triangle. Nothing when neither
  /// has; refused when both have.
  [[nodiscard]] std::optional<MapElements> elements_with(std::string_view name) const;

  // The one array of that name, which must have the type and number of components. `name` must outlive the result.
  [[nodiscard]] DeclaredArray element_array(MapElements elements, std::string_view name, std::string_view type,
                                            int components) const;
  [[nodiscard]] DeclaredArray field_array(std::string_view name, std::string_view type, int components) const;

  // The geometry: the coordinates of the points; the cells, as many as `layout` states.
  [[nodiscard]] DeclaredArray points(const VtpLayout& layout) const;
  /// A tuple for each cell, of its corners.
  [[nodiscard]] DeclaredArray connectivity(const VtpLayout& layout) const;
  [[nodiscard]] DeclaredArray offsets(const VtpLayout& layout) const;

  [[nodiscard]] VtpLayout layout(MapElements elements, std::uint64_t further_normals) const;

  /// Refuses an XML part that differs from the writer's by a letter: a viewer may show an unchecked part.
  void expect_only(const VtpLayout& layout) const;

 private:
  void check_attributes() const;
  [[nodiscard]] bool has_array(const char* data, std::string_view name) const;
  [[nodiscard]] std::uint64_t count(MapElements elements) const;
  [[nodiscard]] pugi::xml_node cells(const VtpLayout& layout) const;
  [[nodiscard]] pugi::xml_node poly_data() const;
  [[nodiscard]] pugi::xml_node piece() const;
  [[nodiscard]] pugi::xml_node only_child(pugi::xml_node parent, const char* name) const;
  [[nodiscard]] pugi::xml_node only_array(pugi::xml_node parent, std::string_view name, std::string_view type,
                                          int components) const;
  void expect(pugi::xml_node element, const char* attribute, std::string_view value) const;
  [[nodiscard]] std::uint64_t whole_number(pugi::xml_node element, const char* attribute) const;
  [[noreturn]] void fail(pugi::xml_node element, std::string_view message) const;

  const InputFile& file_;
  std::string text_;  // with the '_'
  pugi::xml_document xml_;
};

// The drawing in a map, read back, and the expected one.

/// The geometry of a map and the colours of its rows, as a viewer takes them.
struct MapPicture {
  std::vector<Point> points;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::int64_t> vertex_cells;  ///< if there are no triangles: the point of each
  std::vector<std::int64_t> offsets;       ///< behind the last corner of each cell
  std::vector<double> middles;             ///< `dist_mid`

  /// The first number that differs, by a bit, from the writer's number for `mesh`, of a map of `elements` with the
  /// enclosures [lo, hi]. Precondition: as many `lo`, `hi` and `middles`.
  [[nodiscard]] std::optional<MapDifference> difference_from(const Mesh& mesh, MapElements elements,
                                                             std::span<const double> lo,
                                                             std::span<const double> hi) const;
};

constexpr const char* point_data = "PointData";
constexpr const char* cell_data = "CellData";
constexpr std::size_t longest_xml = std::size_t{1} << 20;  // the writer's is a few thousand bytes

/// The file up to the '_' before the appended part, whose raw bytes are not XML.
std::string take_xml(InputFile& file) {
  const std::string_view start = file.peek_text(longest_xml).substr(0, longest_xml);
  const std::size_t appended = start.find("<AppendedData");
  const std::size_t underscore = appended == std::string_view::npos ? appended : start.find('_', appended);
  if (underscore == std::string_view::npos) {
    file.fail_whole(fmt::format("no appended data in the first {} bytes: not a map as .vtp", start.size()));
  }
  std::string xml(start.substr(0, underscore + 1));
  (void)file.take(underscore + 1, "the XML part");
  return xml;
}

VtpDocument::VtpDocument(InputFile& file) : file_(file), text_(take_xml(file)) {
  const std::string_view xml = std::string_view(text_).substr(0, text_.size() - 1);
  // Closed as if nothing were appended. If '_' was another one (in a comment, say), this does not parse.
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
  // From the last blank before it: a whole element or attribute.
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

// A second one is refused: another reader might use that one, and show unchecked data.
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

std::string text(double number) {
  return fmt::format("{:.17g}", number);  // 17 significant digits give back the same binary64
}

std::string text(std::int64_t number) {
  return fmt::format("{}", number);
}

std::string text(const Point& point) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g})", point[0], point[1], point[2]);
}

std::string text(const std::array<std::int64_t, 3>& corners) {
  return fmt::format("({})", fmt::join(corners, ", "));
}

std::optional<MapDifference> difference_of_counts(std::string_view name, std::size_t shown, std::size_t expected) {
  if (shown == expected) return std::nullopt;
  return MapDifference{std::string(name), std::nullopt, fmt::format("{}", shown), fmt::format("{}", expected)};
}

/// `expected(k)` is the expected k-th item. Compares bits, not values: 0 is not -0.
template <class Item, class Expected>
std::optional<MapDifference> first_difference(std::string_view name, std::span<const Item> shown,
                                              const Expected& expected) {
  using Bits = std::array<std::byte, sizeof(Item)>;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const Item item = expected(k);
    if (std::bit_cast<Bits>(shown[k]) != std::bit_cast<Bits>(item)) {
      return MapDifference{std::string(name), k, text(shown[k]), text(item)};
    }
  }
  return std::nullopt;
}

std::optional<MapDifference> MapPicture::difference_from(const Mesh& mesh, MapElements elements,
                                                         std::span<const double> lo, std::span<const double> hi) const {
  const bool has_triangles = elements == MapElements::triangles || !mesh.triangles.empty();
  const std::int64_t corners = has_triangles ? 3 : 1;
  if (auto found = difference_of_counts("NumberOfPoints", points.size(), mesh.vertices.size())) return found;
  if (auto found = difference_of_counts("NumberOfPolys", triangles.size(), mesh.triangles.size())) return found;
  if (auto found = first_difference<Point>("Points", points, [&](std::size_t k) { return mesh.vertices[k]; })) {
    return found;
  }
  const auto corners_of = [&](std::size_t k) {
    const auto& [a, b, c] = mesh.triangles[k];
    return std::array<std::int64_t, 3>{a, b, c};
  };
  if (auto found = first_difference<std::array<std::int64_t, 3>>("connectivity", triangles, corners_of)) return found;
  if (auto found = first_difference<std::int64_t>("connectivity", vertex_cells,
                                                  [](std::size_t k) { return static_cast<std::int64_t>(k); })) {
    return found;
  }
  if (auto found = first_difference<std::int64_t>(
          "offsets", offsets, [&](std::size_t k) { return corners * static_cast<std::int64_t>(k + 1); })) {
    return found;
  }
  return first_difference<double>("dist_mid", middles, [&](std::size_t k) { return finite_middle(lo[k], hi[k]); });
}

using Weights = std::array<double, 2>;
using Corners = std::array<std::int64_t, 3>;

template <class Item>
Item item_from(const char* bytes) {
  return number_from<Item>(bytes, std::endian::little);
}

template <>
Point item_from<Point>(const char* bytes) {
  return {item_from<double>(bytes), item_from<double>(bytes + 8), item_from<double>(bytes + 16)};
}

template <>
Weights item_from<Weights>(const char* bytes) {
  return {item_from<double>(bytes), item_from<double>(bytes + 8)};
}

template <>
Corners item_from<Corners>(const char* bytes) {
  return {item_from<std::int64_t>(bytes), item_from<std::int64_t>(bytes + 8), item_from<std::int64_t>(bytes + 16)};
}

/// The appended part of the file, read front to back, so that only arrays in ascending order can be read.
class AppendedArrays {
 public:
  /// `file` stands at the first byte of the appended part.
  explicit AppendedArrays(InputFile& file) : file_(file), start_(file.position()) {}

  template <class Item>
  std::vector<Item> read(const DeclaredArray& array) {
    skip_to(array);
    const std::string what = fmt::format("array '{}'", array.name);
    ArrayBytes bytes(file_, {.header = NumberType::uint64});
    bytes.begin(array.tuples, sizeof(Item), what);
    std::vector<Item> items;
    items.reserve(array.tuples);  // the file holds that many
    std::vector<char> block;
    while (items.size() < array.tuples) {
      block.resize(sizeof(Item) * std::min<std::size_t>(array.tuples - items.size(), block_size / sizeof(Item)));
      bytes.read(block, what);
      for (std::size_t at = 0; at < block.size(); at += sizeof(Item)) {
        items.push_back(item_from<Item>(block.data() + at));
      }
    }
    return items;
  }

  /// Nothing may follow the arrays but the end of the file's XML.
  void expect_end() {
    const std::string_view rest = file_.peek(vtp_end.size() + 1);
    if (rest != vtp_end) file_.fail_whole(fmt::format("byte {}: not the end of a map", file_.position()));
  }

 private:
  static constexpr std::size_t block_size = std::size_t{1} << 16;

  void skip_to(const DeclaredArray& array) {
    const std::uint64_t here = file_.position() - start_;
    if (array.offset < here) {
      fail(array, fmt::format("offset = {}: the array before it ends at {}", array.offset, here));
    }
    std::uint64_t distance = array.offset - here;
    if (distance > file_.remaining()) {
      fail(array, fmt::format("offset = {}: beyond the end of the file", array.offset));
    }
    while (distance > 0) {
      const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(distance, block_size));
      (void)file_.take(step, array.name);
      distance -= step;
    }
  }

  [[noreturn]] void fail(const DeclaredArray& array, std::string_view message) const {
    file_.fail_whole(fmt::format("array '{}': {}", array.name, message));
  }

  InputFile& file_;
  std::uint64_t start_;
};

bool is_finite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); });
}

bool is_finite_or_none(std::span<const double> numbers) {
  return is_finite(numbers) || std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isnan(v); });
}

class VtpRows final : public MapRows {
 public:
  explicit VtpRows(const std::filesystem::path& path) {
    InputFile file(path);
    if (file.size() == 0) file.fail_whole("not a regular file: a map as .vtp needs a known size");
    read_columns(file);
    check_further_normals(file);
    if (certificates_.covered) check_covers(file);
    for (std::size_t row = 0; row < lo_.size(); ++row) check_row(file, row);
  }

  [[nodiscard]] MapElements elements() const override { return certificates_.elements; }

  std::size_t read(std::span<CertifiedRow> rows) override {
    const std::size_t count = std::min(rows.size(), lo_.size() - next_);
    for (CertifiedRow& row : rows.first(count)) {
      row.result = {{lo_[next_], hi_[next_]}, static_cast<Status>(status_[next_])};
      certificates_.read(next_++, row.certificate);
    }
    return count;
  }

  [[nodiscard]] bool draws() const override { return true; }

  [[nodiscard]] std::optional<MapDifference> difference_from(const Mesh& mesh) const override {
    return picture_.difference_from(mesh, elements(), lo_, hi_);
  }

 private:
  /// In the order in which the writer writes them.
  void read_columns(InputFile& file) {
    const VtpDocument document(file);
    const std::optional<MapElements> elements = document.elements_with("primitive");
    if (!elements) file.fail_whole(without_certificates);
    certificates_.elements = *elements;
    const auto declared = [&](std::string_view name, std::string_view type, int components) {
      return document.element_array(*elements, name, type, components);
    };
    AppendedArrays arrays(file);
    certificates_.further_primitive = arrays.read<std::int32_t>(document.field_array("further_primitive", "Int32", 1));
    certificates_.further_normal = arrays.read<Point>(document.field_array("further_normal", "Float64", 3));
    const std::size_t further_normals = certificates_.further_normal.size();
    if (certificates_.further_primitive.size() != further_normals) {
      file.fail_whole(fmt::format("{} of further_primitive, but {} of further_normal",
                                  certificates_.further_primitive.size(), further_normals));
    }
    certificates_.covered = document.elements_with("cover_end") == *elements;
    VtpLayout layout = document.layout(*elements, further_normals);
    if (certificates_.covered) {
      certificates_.cover = arrays.read<std::uint8_t>(document.field_array("cover", "UInt8", 1));
      layout.cover_bits = certificates_.cover.size();
    }
    read_geometry(arrays, document, layout);
    lo_ = arrays.read<double>(declared("dist_lo", "Float64", 1));
    hi_ = arrays.read<double>(declared("dist_hi", "Float64", 1));
    picture_.middles = arrays.read<double>(declared("dist_mid", "Float64", 1));
    status_ = arrays.read<std::uint8_t>(declared("status", "UInt8", 1));
    certificates_.primitive = arrays.read<std::int32_t>(declared("primitive", "Int32", 1));
    certificates_.normal = arrays.read<Point>(declared("normal", "Float64", 3));
    if (elements == MapElements::vertices) {
      certificates_.escape = arrays.read<Point>(declared("escape", "Float64", 3));
    } else {
      certificates_.weights = arrays.read<Weights>(declared("weights", "Float64", 2));
    }
    certificates_.further_normals_end = arrays.read<std::int64_t>(declared("further_normals_end", "Int64", 1));
    if (certificates_.covered) {
      certificates_.witness = arrays.read<Point>(declared("witness", "Float64", 3));
      certificates_.cover_end = arrays.read<std::int64_t>(declared("cover_end", "Int64", 1));
    }
    document.expect_only(layout);
    arrays.expect_end();
  }

  void read_geometry(AppendedArrays& arrays, const VtpDocument& document, const VtpLayout& layout) {
    picture_.points = arrays.read<Point>(document.points(layout));
    if (layout.has_triangles()) {
      picture_.triangles = arrays.read<Corners>(document.connectivity(layout));
    } else {
      picture_.vertex_cells = arrays.read<std::int64_t>(document.connectivity(layout));
    }
    picture_.offsets = arrays.read<std::int64_t>(document.offsets(layout));
  }

  /// The precondition of `CertificateColumns::read`: the ends ascend from 0 to the length of both further columns.
  void check_further_normals(const InputFile& file) const {
    const std::vector<std::int32_t>& primitives = certificates_.further_primitive;
    const std::vector<Point>& normals = certificates_.further_normal;
    std::int64_t end = 0;
    for (std::size_t row = 0; row < certificates_.further_normals_end.size(); ++row) {
      const std::int64_t start = std::exchange(end, certificates_.further_normals_end[row]);
      if (end < start) {
        fail(file, element(), row, fmt::format("further_normals_end = {}: expected at least {}", end, start));
      }
    }
    if (static_cast<std::uint64_t>(end) != normals.size()) {
      file.fail_whole(
          fmt::format("further_normals_end = {} at the last {}: expected {}", end, element(), normals.size()));
    }
    for (std::size_t k = 0; k < normals.size(); ++k) {
      if (primitives[k] < 0) fail(file, "further normal", k, fmt::format("primitive = {}", primitives[k]));
      if (!is_finite(normals[k])) {
        fail(file, "further normal", k, fmt::format("{}: not finite", fmt::join(normals[k], " ")));
      }
    }
  }

  /// The same for covers; and each cover is a whole one.
  void check_covers(const InputFile& file) const {
    if (!std::ranges::all_of(certificates_.cover, [](std::uint8_t bit) { return bit <= 1; })) {
      file.fail_whole("cover: neither 0 nor 1");
    }
    std::int64_t end = 0;
    const auto bits = static_cast<std::int64_t>(certificates_.cover.size());
    for (std::size_t row = 0; row < certificates_.cover_end.size(); ++row) {
      const std::int64_t start = std::exchange(end, certificates_.cover_end[row]);
      if (end < start || end > bits) fail(file, element(), row, fmt::format("cover_end = {}", end));
      const auto first = certificates_.cover.begin();
      const std::vector<bool> cover(first + start, first + end);
      if (!cover.empty() && !is_whole_cover(cover)) fail(file, element(), row, "not a whole cover");
      const Point& witness = certificates_.witness[row];
      if (!is_finite_or_none(witness)) fail(file, element(), row, fmt::format("witness = {}", fmt::join(witness, " ")));
    }
    if (end != bits) file.fail_whole(fmt::format("cover_end = {} at the last {}: expected {}", end, element(), bits));
  }

  void check_row(const InputFile& file, std::size_t row) const {
    const auto refuse = [&](std::string_view message) { fail(file, element(), row, message); };
    if (std::isnan(lo_[row])) refuse("dist_lo = nan");
    if (std::isnan(hi_[row])) refuse("dist_hi = nan");
    if (status_[row] > static_cast<std::uint8_t>(Status::wide)) refuse(fmt::format("status = {}", status_[row]));
    const std::int32_t primitive = certificates_.primitive[row];
    if (primitive < CertificateColumns::no_primitive) refuse(fmt::format("primitive = {}", primitive));
    const auto [begin, end] = certificates_.further_normals(row);
    if (primitive == CertificateColumns::no_primitive && begin < end) {
      refuse("further normals without a first normal");
    }
    const Point& normal = certificates_.normal[row];
    if (!is_finite(normal)) refuse(fmt::format("normal = {}: not finite", fmt::join(normal, " ")));
    if (primitive == CertificateColumns::no_primitive && normal != Point{}) {  // nobody checks it, but it is drawn
      refuse(fmt::format("normal = {}: of no primitive", fmt::join(normal, " ")));
    }
    const auto check_optional = [&](std::string_view name, std::span<const double> numbers) {
      if (is_finite_or_none(numbers)) return;
      refuse(fmt::format("{} = {}: neither finite nor all nan", name, fmt::join(numbers, " ")));
    };
    if (certificates_.elements == MapElements::vertices) {
      check_optional("escape", certificates_.escape[row]);
    } else {
      check_optional("weights", certificates_.weights[row]);
    }
  }

  /// The kind of element of a row of the map.
  [[nodiscard]] std::string_view element() const {
    return certificates_.elements == MapElements::vertices ? "point" : "triangle";
  }

  [[noreturn]] static void fail(const InputFile& file, std::string_view what, std::size_t index,
                                std::string_view message) {
    file.fail_whole(fmt::format("{} {}: {}", what, index, message));
  }

  MapPicture picture_;
  std::vector<double> lo_;
  std::vector<double> hi_;
  std::vector<std::uint8_t> status_;
  CertificateColumns certificates_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<MapRows> open_vtp_map(const std::filesystem::path& path) {
  return std::make_unique<VtpRows>(path);
}

}  // namespace verisq
