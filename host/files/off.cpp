/// OFF (Geomview): counts, then one vertex a line, then one polygon a line; '#' starts a comment.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "host/files/mesh_builder.hpp"
#include "host/files/mesh_formats.hpp"
#include "host/files/words.hpp"

namespace verisq {
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

/// "[ST][C][N]OFF" may stand before the counts, on their line or on its own: normals, colours and texture coordinates
/// follow the coordinates of a vertex then. Vertices of other dimensions ("4OFF", "nOFF") and binary files are refused.
Words after_keyword(InputFile& file) {
  Words words = next_words(file, "'OFF' or the counts");
  Words behind = words;
  const std::string_view keyword = behind.next();
  if (keyword.find_first_not_of("+-0123456789") == std::string_view::npos) return words;
  constexpr std::array<std::string_view, 8> known{"OFF",   "COFF",   "NOFF",   "CNOFF",
                                                  "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  if (std::find(known.begin(), known.end(), keyword) == known.end()) {
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

}  // namespace verisq
