/// PLY (Stanford), ASCII and binary of both byte orders: elements `vertex` and `face`; others are read past.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/files/input_file.hpp"
#include "host/files/mesh_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string name;                      ///< any bytes but blanks
  std::string shown;                     ///< the name as messages show it
  NumberType type;                       ///< type of the value, or of a list's entries
  std::optional<NumberType> count_type;  ///< type of a list's length; nothing for a single value
};

struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;                        ///< at least one if count > 0
  std::map<std::string, std::size_t, std::less<>> positions;  ///< in `properties`, by name

  /// Position in `properties`; nothing when there is none of that name.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding;
  std::vector<PlyElement> elements;  ///< distinct names, in the order of the file
};

struct TypeName {
  std::string_view name;
  NumberType type;
};

constexpr std::array<TypeName, 16> type_names{{
    {"char", NumberType::int8},
    {"int8", NumberType::int8},
    {"uchar", NumberType::uint8},
    {"uint8", NumberType::uint8},
    {"short", NumberType::int16},
    {"int16", NumberType::int16},
    {"ushort", NumberType::uint16},
    {"uint16", NumberType::uint16},
    {"int", NumberType::int32},
    {"int32", NumberType::int32},
    {"uint", NumberType::uint32},
    {"uint32", NumberType::uint32},
    {"float", NumberType::float32},
    {"float32", NumberType::float32},
    {"double", NumberType::float64},
    {"float64", NumberType::float64},
}};

NumberType parse_type(const InputFile& file, std::string_view word) {
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

/// `names` are the names of the elements so far.
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

/// The next one but for comments.
Words next_header_line(InputFile& file) {
  while (const auto line = file.next_line()) {
    const std::string_view keyword = Words(*line).next();
    if (keyword != "comment" && keyword != "obj_info") return Words(*line);
  }
  file.fail("truncated: the file ends without 'end_header'");
}

void check_elements(const InputFile& file, const PlyHeader& header) {
  for (const PlyElement& element : header.elements) {
    if (element.count > 0 && element.properties.empty()) {
      file.fail(fmt::format("element {}: has no properties", in_quotes(element.name)));
    }
  }
}

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  const auto found = positions.find(property);
  if (found == positions.end()) return std::nullopt;
  return found->second;
}

/// Reads up to and with the line `end_header`. Throws Error(input) with the line of the error.
PlyHeader read_ply_header(InputFile& file) {
  if (const auto magic = file.next_line(); !magic || trimmed(*magic) != "ply")
    file.fail("not a PLY file: the first line must be 'ply'");
  Words second = next_header_line(file);
  if (second.next() != "format") file.fail("the first line after 'ply' and comments must be 'format ENCODING 1.0'");
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
    } else {
      file.fail(fmt::format("header keyword {}: not known", in_quotes(keyword)));
    }
  }
}

/// One row a line, values as decimal text.
class AsciiRows {
 public:
  explicit AsciiRows(InputFile& file) : file_(file) {}

  void begin_row(const PlyElement& element) {
    const auto line = file_.next_line_with_text();
    if (!line) file_.fail(fmt::format("truncated: the file ends inside element {}", in_quotes(element.name)));
    words_ = Words(*line);
  }
  double finite(NumberType /*any*/, std::string_view name) { return finite_number(file_, words_.next(), name); }
  std::int64_t whole(NumberType /*any*/, std::string_view name) { return integer(file_, words_.next(), name); }
  void skip(NumberType /*any*/, std::string_view name) {
    if (words_.next().empty()) file_.fail(fmt::format("{} is missing", name));
  }
  void end_row() {
    if (!words_.empty()) file_.fail(fmt::format("unexpected {} after the last property", in_quotes(words_.rest())));
  }
  void end_file() {
    if (const auto line = file_.next_line_with_text()) {
      file_.fail(fmt::format("unexpected {} after the last element", in_quotes(trimmed(*line))));
    }
  }
  [[nodiscard]] static std::size_t smallest(NumberType /*any*/) { return 2; }  // a digit, a blank

 private:
  InputFile& file_;
  Words words_{""};
};

/// Values as bytes, one after the other.
class BinaryRows {
 public:
  BinaryRows(InputFile& file, std::endian order) : file_(file), order_(order) {}

  void begin_row(const PlyElement& /*any*/) {}
  double finite(NumberType type, std::string_view name) {
    const auto value = next<double>(type, name);
    if (!std::isfinite(value)) file_.fail(fmt::format("{} = {}: not a finite number", name, value));
    return value;
  }
  std::int64_t whole(NumberType type, std::string_view name) { return next<std::int64_t>(type, name); }
  void skip(NumberType type, std::string_view name) { (void)file_.take(size_of(type), name); }
  void end_row() {}
  void end_file() {
    if (!file_.is_at_end()) {
      file_.fail_whole(fmt::format("byte {}: {} bytes after the last element", file_.position(), file_.remaining()));
    }
  }
  [[nodiscard]] static std::size_t smallest(NumberType type) { return size_of(type); }

 private:
  template <class Number>
  Number next(NumberType type, std::string_view name) {
    return converted_from<Number>(file_.take(size_of(type), name).data(), type, order_);
  }

  InputFile& file_;
  std::endian order_;
};

/// Refuses a number of rows that the rest of the file cannot hold, before memory is reserved for them.
template <class Rows>
void check_size(const InputFile& file, const PlyElement& element) {
  std::uint64_t row = 0;
  for (const PlyProperty& property : element.properties)
    row += Rows::smallest(property.count_type.value_or(property.type));
  if (row > 0 && element.count > (file.remaining() + 1) / row) {  // + 1: the last line may lack its end
    file.fail_whole(
        fmt::format("truncated: the header promises {} of element {}, at least {} bytes each; {} bytes follow it",
                    element.count, in_quotes(element.name), row, file.remaining()));
  }
}

template <class Rows>
void skip_property(const InputFile& file, Rows& rows, const PlyProperty& property) {
  const std::int64_t values = property.count_type ? rows.whole(*property.count_type, property.shown) : 1;
  if (values < 0) file.fail(fmt::format("length of list {} = {}: must not be negative", property.shown, values));
  for (std::int64_t k = 0; k < values; ++k) rows.skip(property.type, property.shown);
}

template <class Rows>
void skip_element(const InputFile& file, Rows& rows, const PlyElement& element) {
  for (std::uint64_t row = 0; row < element.count; ++row) {
    rows.begin_row(element);
    for (const PlyProperty& property : element.properties) skip_property(file, rows, property);
    rows.end_row();
  }
}

/// The role of a vertex's property for the reader.
enum class Column { x, y, z, label, other };

/// The property of the vertices that is wanted beside the coordinates, and its values.
struct Labels {
  std::string property;
  std::vector<std::int64_t> values;
};

std::size_t coordinate_position(const InputFile& file, const PlyElement& element, std::string_view name) {
  const auto found = element.find(name);
  if (!found || element.properties[*found].count_type) {
    file.fail_whole(fmt::format("element 'vertex' has no property '{}' of a single number", name));
  }
  return *found;
}

std::size_t label_position(const InputFile& file, const PlyElement& element, std::string_view name) {
  const auto found = element.find(name);
  if (!found) file.fail_whole(fmt::format("element 'vertex' has no property {}", in_quotes(name)));
  const PlyProperty& property = element.properties[*found];
  if (property.count_type || !is_integer(property.type)) {
    file.fail_whole(fmt::format("element 'vertex': property {} must be a single integer", in_quotes(name)));
  }
  return *found;
}

/// `labels` null: none are wanted.
std::vector<Column> vertex_columns(const InputFile& file, const PlyElement& element, const Labels* labels) {
  std::vector<Column> columns(element.properties.size(), Column::other);
  columns[coordinate_position(file, element, "x")] = Column::x;
  columns[coordinate_position(file, element, "y")] = Column::y;
  columns[coordinate_position(file, element, "z")] = Column::z;
  if (labels == nullptr) return columns;
  Column& label = columns[label_position(file, element, labels->property)];
  if (label != Column::other) file.fail_whole(fmt::format("property {} is a coordinate", in_quotes(labels->property)));
  label = Column::label;
  return columns;
}

template <class Rows>
void read_vertices(const InputFile& file, Rows& rows, const PlyElement& element, MeshBuilder& builder, Labels* labels) {
  const std::vector<Column> columns = vertex_columns(file, element, labels);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    rows.begin_row(element);
    Point point{};
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      switch (columns[k]) {
        case Column::x: point[0] = rows.finite(property.type, property.name); break;
        case Column::y: point[1] = rows.finite(property.type, property.name); break;
        case Column::z: point[2] = rows.finite(property.type, property.name); break;
        // NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): without `labels` no column is one
        case Column::label: labels->values.push_back(rows.whole(property.type, property.shown)); break;
        case Column::other: skip_property(file, rows, property); break;
      }
    }
    rows.end_row();
    builder.add_vertex(point);
  }
}

std::size_t corner_list(const InputFile& file, const PlyElement& element) {
  for (const std::string_view name : {"vertex_indices", "vertex_index"}) {
    const auto found = element.find(name);
    if (!found) continue;
    const PlyProperty& property = element.properties[*found];
    if (property.count_type && is_integer(property.type)) return *found;
    file.fail_whole(fmt::format("element 'face': property '{}' must be a list of integers", name));
  }
  file.fail_whole("element 'face' has no property 'vertex_indices' or 'vertex_index'");
}

template <class Rows>
void read_faces(const InputFile& file, Rows& rows, const PlyElement& element, MeshBuilder& builder) {
  const std::size_t list = corner_list(file, element);
  std::vector<std::uint32_t> corners;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    rows.begin_row(element);
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (k != list) {
        skip_property(file, rows, property);
        continue;
      }
      const std::int64_t count = rows.whole(*property.count_type, "number of corners");
      builder.check_corner_count(count);
      corners.clear();
      for (std::int64_t c = 0; c < count; ++c) {
        corners.push_back(builder.checked_index(rows.whole(property.type, "vertex index")));
      }
    }
    rows.end_row();
    builder.add_polygon(corners);
  }
}

template <class Rows>
Mesh read_body(InputFile& file, Rows rows, const PlyHeader& header, Labels* labels) {
  MeshBuilder builder(file);
  bool vertices_known = false;
  for (const PlyElement& element : header.elements) {
    check_size<Rows>(file, element);
    if (element.name == "vertex") {
      builder.reserve(element.count, 0);
      read_vertices(file, rows, element, builder, labels);
      vertices_known = true;
    } else if (element.name == "face" && element.count > 0) {
      if (!vertices_known) file.fail_whole("element 'face' before element 'vertex' is not supported");
      builder.reserve(0, element.count);
      read_faces(file, rows, element, builder);
    } else if (element.name == "tristrips") {
      file.fail_whole("element 'tristrips' is not supported: triangles must be in element 'face'");
    } else {
      skip_element(file, rows, element);
    }
  }
  rows.end_file();
  return std::move(builder).finish();
}

Mesh read(InputFile& file, Labels* labels) {
  const PlyHeader header = read_ply_header(file);
  switch (header.encoding) {
    case PlyEncoding::ascii: return read_body(file, AsciiRows(file), header, labels);
    case PlyEncoding::little_endian: return read_body(file, BinaryRows(file, std::endian::little), header, labels);
    case PlyEncoding::big_endian: break;
  }
  return read_body(file, BinaryRows(file, std::endian::big), header, labels);
}

}  // namespace

Mesh read_ply(InputFile& file) {
  return read(file, nullptr);
}

LabelledMesh read_labelled_ply(InputFile& file, const std::string& property) {
  Labels labels{property, {}};
  Mesh mesh = read(file, &labels);
  return {std::move(mesh), std::move(labels.values)};
}

}  // namespace verisq
