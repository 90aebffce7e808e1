/// This file implements mesh_file.hpp.
#include "host/files/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/files.hpp>

#include "host/files/input_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

std::string text(const Point& p) {
  return fmt::format("({}, {}, {})", p[0], p[1], p[2]);
}

}  // namespace

void MeshBuilder::reserve(std::size_t vertices, std::size_t triangles) {
  mesh_.vertices.reserve(vertices);
  mesh_.triangles.reserve(triangles);
}

std::uint32_t MeshBuilder::add_vertex(const Point& vertex) {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  if (mesh_.vertices.size() == most) file_.fail(fmt::format("more than {} vertices are not supported", most));
  mesh_.vertices.push_back(vertex);
  return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
}

std::uint32_t MeshBuilder::checked_index(std::int64_t index, std::size_t first) const {
  const std::size_t count = mesh_.vertices.size() - first;
  if (index < 0 || static_cast<std::uint64_t>(index) >= count) {
    const std::string_view whole = first == 0 ? "the file" : "the piece";
    file_.fail(fmt::format("vertex index {}: out of range, {} has {} vertices, counted from 0", index, whole, count));
  }
  return static_cast<std::uint32_t>(first + static_cast<std::uint64_t>(index));
}

void MeshBuilder::check_corner_count(std::int64_t count) const {
  if (count < 3) file_.fail(fmt::format("number of corners = {}: a face needs at least 3", count));
}

void MeshBuilder::add_triangle(const std::array<std::uint32_t, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  if (a == b || b == c || c == a) {
    folded_.push_back({triangle, mesh_.triangles.size() + folded_.size() + 1});
  } else {
    mesh_.triangles.push_back(triangle);
  }
}

void MeshBuilder::add_polygon(std::span<const std::uint32_t> corners) {
  check_corner_count(static_cast<std::int64_t>(corners.size()));
  ++polygons_;
  if (corners.size() == 3) return add_triangle({corners[0], corners[1], corners[2]});
  polygon_.clear();
  for (const std::uint32_t corner : corners) polygon_.push_back(mesh_.vertices[corner]);
  const PolygonTriangles split = triangles_of_polygon(polygon_);
  if (!split.defect.empty()) file_.fail(fmt::format("face {}: {}", polygons_, split.defect));
  for (const auto& [a, b, c] : split.triangles) mesh_.triangles.push_back({corners[a], corners[b], corners[c]});
}

void MeshBuilder::leave_out_folded() const {
  using Line = std::pair<std::uint32_t, std::uint32_t>;  // the lower vertex first; a point: both alike
  std::map<Line, std::size_t> alone;                     // the number of the first such triangle
  for (const auto& [triangle, number] : folded_) {
    const auto [low, high] = std::ranges::minmax(triangle);
    alone.try_emplace({low, high}, number);
  }
  for (const auto& triangle : mesh_.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      alone.erase(std::minmax(triangle[k], triangle[(k + 1) % 3]));
      alone.erase({triangle[k], triangle[k]});
    }
  }
  if (alone.empty()) return;
  const auto& [line, number] = *alone.begin();
  file_.fail_whole(fmt::format(
      "triangle {} names a vertex twice, and its line from {} to {} is no side of another triangle: leave it out",
      number, text(mesh_.vertices[line.first]), text(mesh_.vertices[line.second])));
}

Mesh MeshBuilder::finish() && {
  if (mesh_.vertices.empty()) file_.fail_whole("no vertices");
  if (!folded_.empty()) leave_out_folded();
  return std::move(mesh_);
}

namespace {

using Reader = Mesh (*)(InputFile&);

/// Null where there is none.
Reader reader_for(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".stl") return read_stl;
  if (extension == ".obj") return read_obj;
  if (extension == ".ply") return read_ply;
  if (extension == ".off") return read_off;
  if (extension == ".vtp") return read_vtp;
  if (extension == ".vtk") return read_vtk;
  return nullptr;
}

Reader known_reader_for(const std::filesystem::path& path) {
  const Reader read = reader_for(path);
  if (read != nullptr) return read;
  const std::string extension = path.extension().string();
  throw Error(ErrorKind::input,
              fmt::format("{}: unknown mesh format {}: known are .stl, .obj, .ply, .off, .vtp, .vtk{}", path.string(),
                          in_quotes(extension), lower_case(extension) == ".json" ? "; a model goes elsewhere" : ""));
}

Mesh mesh_in(InputFile file, Reader read) {
  try {
    return read(file);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::failure, fmt::format("{}: not enough memory for this mesh", file.name()));
  }
}

}  // namespace

bool is_mesh_name(const std::filesystem::path& path) {
  return reader_for(path) != nullptr;
}

Mesh read_mesh(const std::filesystem::path& path) {
  std::error_code none;  // a folder has no extension that could be unknown
  if (std::filesystem::is_directory(path, none)) {
    throw Error(ErrorKind::input, fmt::format("{}: is a directory, not a file", path.string()));
  }
  const Reader read = known_reader_for(path);
  InputFile file(path);
  if (file.size() == 0) file.fail_whole("not a regular file: a mesh needs a known size");
  return mesh_in(std::move(file), read);
}

Mesh parse_mesh(std::string_view bytes, const std::filesystem::path& name) {
  const Reader read = known_reader_for(name);
  return mesh_in(InputFile(name.string(), bytes), read);
}

namespace {

// No vertex has this index: MeshBuilder stops one before it.
constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t first_slots = 1024;

/// Steele, Lea, Flood: SplitMix64's finaliser (OOPSLA 2014), after each coordinate.
std::uint64_t hash(const Point& point) {
  std::uint64_t h = 0;
  for (const double coordinate : point) {
    h += std::bit_cast<std::uint64_t>(coordinate + 0.0) + 0x9e3779b97f4a7c15U;  // + 0.0 turns -0.0 into 0.0
    h = (h ^ (h >> 30U)) * 0xbf58476d1ce4e5b9U;
    h = (h ^ (h >> 27U)) * 0x94d049bb133111ebU;
    h ^= h >> 31U;
  }
  return h;
}

}  // namespace

VertexMerger::VertexMerger(MeshBuilder& builder) : builder_(builder), slots_(first_slots, empty) {}

/// The slot of the vertex equal to `point`, or the empty slot where it belongs (linear probing).
std::size_t VertexMerger::slot_of(const Point& point) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash(point) & mask;
  while (slots_[slot] != empty && builder_.mesh().vertices[slots_[slot]] != point) slot = (slot + 1) & mask;
  return slot;
}

std::uint32_t VertexMerger::index_of(const Point& point) {
  const std::size_t slot = slot_of(point);
  if (slots_[slot] != empty) return slots_[slot];
  const std::uint32_t index = builder_.add_vertex(point);
  slots_[slot] = index;
  if (2 * builder_.mesh().vertices.size() > slots_.size()) grow();
  return index;
}

void VertexMerger::grow() {
  slots_.assign(2 * slots_.size(), empty);
  for (std::uint32_t index = 0; index < builder_.mesh().vertices.size(); ++index) {
    slots_[slot_of(builder_.mesh().vertices[index])] = index;
  }
}

namespace {

/// "v x y z", after which a weight or a colour may follow: numbers, not used.
void read_vertex(const InputFile& file, Words words, MeshBuilder& builder) {
  const Point point = coordinates(file, words);
  while (!words.empty()) (void)finite_number(file, words.next(), "weight or colour");
  builder.add_vertex(point);
}

/// A corner "v", "v/vt", "v//vn" or "v/vt/vn"; v counts from 1, or backwards from the latest vertex with -1.
std::uint32_t read_corner(const InputFile& file, std::string_view corner, const MeshBuilder& builder) {
  const std::string_view vertex = corner.substr(0, corner.find('/'));
  if (corner.find_first_not_of("0123456789+-/") != std::string_view::npos ||
      std::count(corner.begin(), corner.end(), '/') > 2) {
    file.fail(fmt::format("face corner {}: not of the form v, v/vt, v//vn or v/vt/vn", in_quotes(corner)));
  }
  const std::int64_t index = integer(file, vertex, "vertex index");
  const auto count = static_cast<std::int64_t>(builder.mesh().vertices.size());
  if (index == 0 || index > count || index < -count) {
    file.fail(fmt::format("vertex index {}: out of range, {} vertices so far, counted from 1", index, count));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
}

/// Records that a surface does not need: points and lines; names, groups, looks; textures' and normals' vectors.
constexpr std::array<std::string_view, 21> passed_over{
    "vt",     "vn",     "vp",    "p",   "l",     "g",     "s",        "mg",       "o",          "usemtl",   "mtllib",
    "usemap", "maplib", "bevel", "lod", "ctech", "stech", "c_interp", "d_interp", "shadow_obj", "trace_obj"};

/// Curves and surfaces of control points, their attributes, and other files.
constexpr std::array<std::string_view, 21> not_read{"surf", "curv", "curv2", "cstype", "deg", "bmat", "step",
                                                    "parm", "trim", "hole",  "scrv",   "sp",  "end",  "bsp",
                                                    "bzp",  "cdc",  "cdp",   "res",    "con", "call", "csh"};

template <std::size_t size>
bool has(const std::array<std::string_view, size>& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

bool is_record(std::string_view word) {
  return word == "v" || word == "f" || word == "fo" || has(passed_over, word) || has(not_read, word);
}

void check_passed_over(const InputFile& file, std::string_view record) {
  if (has(passed_over, record)) return;
  if (has(not_read, record)) {
    file.fail(fmt::format("record {}: only surfaces of polygons in one file are read, by v and f; export polygons",
                          in_quotes(record)));
  }
  file.fail(fmt::format("record {}: not one of OBJ", in_quotes(record)));
}

std::string_view without_comment(std::string_view line) {
  return line.substr(0, line.find('#'));
}

/// A record may continue in the next lines: a backslash at the end marks this. A backslash at the end of a comment or
/// of a name (of a folder, say) must not take the next record with it. So no continuation may begin with the name of a
/// record.
class Records {
 public:
  explicit Records(InputFile& file) : file_(file) {}

  /// Valid until the next call.
  std::optional<std::string_view> next() {
    const auto line = file_.next_line_with_text();
    if (!line) return std::nullopt;
    if (!goes_on(*line)) return without_comment(*line);
    joined_.clear();
    append(*line);
    while (joined_.ends_with('\\')) {
      joined_.back() = ' ';
      const auto more = file_.next_line();
      if (!more) file_.fail("truncated: the file ends where a line should follow that ends with a backslash");
      if (const std::string_view word = Words(*more).next(); is_record(word)) {
        file_.fail(fmt::format("record {} behind a line that ends with a backslash: it would belong to that",
                               in_quotes(word)));
      }
      append(*more);
    }
    return joined_;
  }

 private:
  static bool goes_on(std::string_view line) {
    return trimmed(line).ends_with('\\') && line.find('#') == std::string_view::npos;
  }

  void append(std::string_view line) {
    if (joined_.size() + line.size() > InputFile::longest_line)
      file_.fail(fmt::format("longer than {} characters", InputFile::longest_line));
    joined_ += goes_on(line) ? trimmed(line) : without_comment(line);
  }

  InputFile& file_;
  std::string joined_;
};

}  // namespace

Mesh read_obj(InputFile& file) {
  MeshBuilder builder(file);
  std::vector<std::uint32_t> corners;
  Records records(file);
  while (const auto line = records.next()) {
    Words words(*line);
    const std::string_view record = words.next();
    if (record == "v") {
      read_vertex(file, words, builder);
    } else if (record == "f" || record == "fo") {
      corners.clear();
      while (!words.empty()) corners.push_back(read_corner(file, words.next(), builder));
      builder.add_polygon(corners);
    } else if (!record.empty()) {
      check_passed_over(file, record);
    }
  }
  return std::move(builder).finish();
}

namespace {

struct Counts {
  std::uint64_t vertices;
  std::uint64_t faces;
};

/// The next line that holds more than blanks and comments.
Words next_words(InputFile& file, std::string_view expected) {
  while (const auto line = file.next_line_with_text()) {
    const Words words(line->substr(0, line->find('#')));
    if (!words.empty()) return words;
  }
  file.fail(fmt::format("truncated: the file ends where {} should follow", expected));
}

std::uint64_t read_count(const InputFile& file, Words& words, std::string_view what) {
  const std::int64_t count = integer(file, words.next(), what);
  if (count < 0) file.fail(fmt::format("{} = {}: must not be negative", what, count));
  return static_cast<std::uint64_t>(count);
}

/// A wrong header must not ask for all memory: a file of this size has room for so many rows only.
void check_room(const InputFile& file, std::uint64_t rows, std::string_view shortest_row, std::string_view what) {
  if (rows > file.size() / shortest_row.size()) {
    file.fail(fmt::format("{} = {}: more than a file of {} bytes can hold", what, rows, file.size()));
  }
}

/// "[ST][C][N]OFF" may stand before the counts, on their line or on its own, with or without a blank. Normals, colours
/// and texture coordinates then follow the coordinates of a vertex. Vertices of other dimensions ("4OFF", "nOFF", where
/// the case of n matters) and binary files are refused.
Words after_keyword(InputFile& file) {
  const Words words = next_words(file, "'OFF' or the counts");
  constexpr std::string_view digits = "+-0123456789";
  const std::string_view first = Words(words).next();
  if (first.find_first_not_of(digits) == std::string_view::npos) return words;
  // "OFF8 6 12" is the form of ModelNet; a word that begins with a digit is no keyword with counts behind it.
  const std::size_t letters = first.find_first_of(digits);
  const std::string_view keyword = letters == 0 ? first : first.substr(0, letters);
  const Words behind(words.rest().substr(keyword.size()));
  constexpr std::array<std::string_view, 8> known{"OFF",   "COFF",   "NOFF",   "CNOFF",
                                                  "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  if (lower_case(keyword) != "off" && std::find(known.begin(), known.end(), keyword) == known.end()) {
    file.fail(fmt::format("keyword {}: not supported, OFF with [ST][C][N] before it is", in_quotes(keyword)));
  }
  if (Words(behind).next() == "BINARY") file.fail("binary OFF is not supported");
  return behind.empty() ? next_words(file, "the counts") : behind;
}

Counts read_counts(InputFile& file) {
  Words words = after_keyword(file);
  Counts counts{};
  counts.vertices = read_count(file, words, "number of vertices");
  counts.faces = read_count(file, words, "number of faces");
  if (!words.empty()) (void)integer(file, words.next(), "number of edges");  // often 0, never used
  if (!words.empty()) file.fail(fmt::format("unexpected {} after the counts", in_quotes(words.rest())));
  check_room(file, counts.vertices, "0 0 0\n", "number of vertices");
  check_room(file, counts.faces, "3 0 1 2\n", "number of faces");
  return counts;
}

void read_vertex(InputFile& file, MeshBuilder& builder) {
  Words words = next_words(file, "a vertex");
  const Point point = coordinates(file, words);
  while (!words.empty()) (void)finite_number(file, words.next(), "normal, colour or texture coordinate");
  builder.add_vertex(point);
}

/// "n i1 ... in", after which a colour of numbers may follow.
void read_face(InputFile& file, std::vector<std::uint32_t>& corners, MeshBuilder& builder) {
  Words words = next_words(file, "a face");
  const std::int64_t count = integer(file, words.next(), "number of corners");
  builder.check_corner_count(count);
  corners.clear();
  for (std::int64_t k = 0; k < count; ++k) {
    corners.push_back(builder.checked_index(integer(file, words.next(), "vertex index")));
  }
  while (!words.empty()) (void)finite_number(file, words.next(), "colour");
  builder.add_polygon(corners);
}

}  // namespace

Mesh read_off(InputFile& file) {
  const Counts counts = read_counts(file);
  MeshBuilder builder(file);
  builder.reserve(counts.vertices, counts.faces);
  for (std::uint64_t k = 0; k < counts.vertices; ++k) read_vertex(file, builder);
  std::vector<std::uint32_t> corners;
  for (std::uint64_t k = 0; k < counts.faces; ++k) read_face(file, corners, builder);
  while (const auto line = file.next_line_with_text()) {
    const std::string_view text = trimmed(line->substr(0, line->find('#')));
    if (!text.empty()) file.fail(fmt::format("unexpected {} after the last face", in_quotes(text)));
  }
  return std::move(builder).finish();
}

namespace {

constexpr std::size_t header_bytes = 84;    // 80 of free text, then the number of triangles
constexpr std::size_t triangle_bytes = 50;  // normal, three corners (binary32 each), two bytes of attributes

std::uint32_t promised_triangles(std::string_view head) {
  return number_from<std::uint32_t>(head.data() + 80, std::endian::little);
}

bool starts_with_solid(std::string_view head) {
  head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
  return lower_case(head.substr(0, 5)) == "solid";
}

bool looks_like_text(std::string_view head) {
  return head.find('\0') == std::string_view::npos;
}

/// Binary files may start with "solid" too, so the size decides; where it fits neither way, the kind of bytes does.
bool is_binary(InputFile& file) {
  constexpr std::size_t enough = 512;
  const std::string_view head = file.peek(enough);
  if (head.size() >= header_bytes) {
    const std::uint64_t needed = header_bytes + std::uint64_t{triangle_bytes} * promised_triangles(head);
    constexpr std::uint64_t longest_line_end = 2;
    if (file.size() == needed) return true;
    if (file.size() > needed && file.size() <= needed + longest_line_end && !looks_like_text(head)) return true;
  }
  const std::string_view text = file.peek_text(enough);
  const bool has_facets = text.find("facet") != std::string_view::npos;
  if (starts_with_solid(text) && (looks_like_text(text) || has_facets)) return false;
  if (looks_like_text(text)) file.fail_whole("not an STL file: text that does not start with 'solid'");
  file.go_to(0);
  return true;
}

Point corner(const InputFile& file, const char* bytes) {
  Point point{};
  for (std::size_t k = 0; k < 3; ++k) {
    point[k] = number_from<float>(bytes + sizeof(float) * k, std::endian::little);
    if (!std::isfinite(point[k])) {
      file.fail(fmt::format("triangle {}: coordinate {} = {}: not a finite number",
                            (file.position() - header_bytes) / triangle_bytes, "xyz"[k], point[k]));
    }
  }
  return point;
}

[[noreturn]] void refuse_size(const InputFile& file, std::uint32_t triangles, std::string_view what) {
  const std::uint64_t needed = header_bytes + std::uint64_t{triangle_bytes} * triangles;
  file.fail_whole(fmt::format("{}: the header promises {} triangles, {} bytes; the file has {} bytes", what, triangles,
                              needed, file.size()));
}

Mesh read_binary(InputFile& file) {
  const std::uint32_t triangles = promised_triangles(file.take(header_bytes, "the header"));
  if (file.remaining() < std::uint64_t{triangle_bytes} * triangles) refuse_size(file, triangles, "truncated");
  if (triangles == 0) file.fail_whole("no triangles");
  MeshBuilder builder(file);
  builder.reserve(triangles / 2 + triangles / 16 + 3, triangles);  // Euler's formula, and some room for rims
  VertexMerger merger(builder);
  for (std::uint32_t k = 0; k < triangles; ++k) {
    const char* bytes = file.take(triangle_bytes, "a triangle").data();
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) corners[c] = merger.index_of(corner(file, bytes + 12 * (c + 1)));
    builder.add_polygon(corners);
  }
  if (!file.is_at_end()) refuse_size(file, triangles, "too long");
  return std::move(builder).finish();
}

/// The words of the next line that has some, which must start with `keywords`.
Words expect(InputFile& file, std::string_view keywords) {
  const auto line = file.next_line_with_text();
  if (!line) file.fail(fmt::format("truncated: the file ends where '{}' should follow", keywords));
  Words found(*line);
  for (Words wanted(keywords); !wanted.empty();) {
    if (lower_case(found.next()) != wanted.next()) {
      file.fail(fmt::format("expected '{}', found {}", keywords, in_quotes(trimmed(*line))));
    }
  }
  return found;
}

Point read_vertex(InputFile& file) {
  Words words = expect(file, "vertex");
  const Point point = coordinates(file, words);
  expect_end(file, words);
  return point;
}

/// Reads the lines after "facet ..."; its normal is not read, because the corners and their order determine it better.
void read_facet(InputFile& file, MeshBuilder& builder, VertexMerger& merger) {
  expect_end(file, expect(file, "outer loop"));
  std::array<std::uint32_t, 3> corners{};
  for (std::uint32_t& index : corners) index = merger.index_of(read_vertex(file));
  builder.add_polygon(corners);
  expect_end(file, expect(file, "endloop"));
  expect_end(file, expect(file, "endfacet"));
}

/// Any number of solids, one after the other.
Mesh read_ascii(InputFile& file) {
  MeshBuilder builder(file);
  VertexMerger merger(builder);
  bool inside_solid = false;
  while (const auto line = file.next_line_with_text()) {
    const std::string keyword = lower_case(Words(*line).next());
    if (keyword == "facet" && inside_solid) {
      read_facet(file, builder, merger);
    } else if (keyword == (inside_solid ? "endsolid" : "solid")) {
      inside_solid = !inside_solid;
    } else {
      file.fail(fmt::format("expected {}, found {}", inside_solid ? "'facet' or 'endsolid'" : "'solid'",
                            in_quotes(trimmed(*line))));
    }
  }
  if (inside_solid) file.fail("truncated: the file ends without 'endsolid'");
  if (builder.mesh().triangles.empty()) file.fail_whole("no triangles");
  return std::move(builder).finish();
}

}  // namespace

Mesh read_stl(InputFile& file) {
  return is_binary(file) ? read_binary(file) : read_ascii(file);
}

}  // namespace verisq
