/// Meshes of VTK in the legacy form (`.vtk`, "VTK File Formats"): PolyData, ASCII and binary, before and since 5.1.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/files/input_file.hpp"
#include "host/files/mesh_file.hpp"
#include "host/files/vtk_arrays.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

NumberType legacy_type(const InputFile& file, std::string_view word) {
  using enum NumberType;
  constexpr std::array<std::pair<std::string_view, NumberType>, 21> names{{
      {"char", int8},
      {"signed_char", int8},
      {"unsigned_char", uint8},
      {"short", int16},
      {"unsigned_short", uint16},
      {"int", int32},
      {"unsigned_int", uint32},
      {"long", int64},
      {"unsigned_long", uint64},
      {"vtkidtype", int32},
      {"float", float32},
      {"double", float64},
      {"vtktypeint8", int8},
      {"vtktypeuint8", uint8},
      {"vtktypeint16", int16},
      {"vtktypeuint16", uint16},
      {"vtktypeint32", int32},
      {"vtktypeuint32", uint32},
      {"vtktypeint64", int64},
      {"vtktypeuint64", uint64},
      {"vtktypefloat64", float64},
  }};
  const auto* const found = std::ranges::find(names, lower_case(word), &std::pair<std::string_view, NumberType>::first);
  if (found == names.end()) file.fail(fmt::format("type {}: not read", in_quotes(word)));
  return found->second;
}

/// Lines of keywords, each followed by numbers, as text or big-endian.
class LegacyMesh {
 public:
  explicit LegacyMesh(InputFile& file) : file_(file), builder_(file) {
    file_.begin_text();
    if (!take_line(file_, "the first line").starts_with("# vtk DataFile Version ")) {
      file_.fail("not a VTK file: the first line must be '# vtk DataFile Version ...'");
    }
    (void)take_line(file_, "the title");
    const std::string form = word();
    if (form != "ascii" && form != "binary") file_.fail(fmt::format("{}: expected ASCII or BINARY", in_quotes(form)));
    binary_ = form == "binary";
    expect("dataset");
    const std::string_view dataset = next_word(file_);
    if (lower_case(dataset) != "polydata") {
      file_.fail(fmt::format("DATASET {}: only POLYDATA is a mesh; ParaView makes it of others by Extract Surface",
                             printable(dataset)));
    }
  }

  /// VTK reads nothing but attributes behind the first of these keywords: no points and no cells.
  Mesh read() && {
    for (std::string keyword = word(); keyword != "cell_data" && keyword != "point_data"; keyword = word()) {
      if (keyword.empty() && file_.peek(1).empty()) break;
      read_section(keyword);
    }
    return std::move(builder_).finish();
  }

 private:
  std::string word() { return lower_case(next_word(file_)); }

  std::uint64_t count(std::string_view what) { return count_from(file_, next_word(file_), what); }

  void expect(std::string_view keyword) {
    if (const std::string found = word(); found != keyword) {
      file_.fail(fmt::format("{}: expected {}", in_quotes(found), in_quotes(keyword)));
    }
  }

  /// At the end of a line of keywords.
  Numbers numbers(NumberType type) {
    if (!binary_) return Numbers(file_);
    const std::string_view rest = take_line(file_, "a line of keywords");
    if (!is_blank(rest)) file_.fail(fmt::format("unexpected {}", in_quotes(rest)));
    return {file_, type, {.order = std::endian::big}};
  }

  void read_section(std::string_view keyword) {
    if (keyword == "points") {
      if (!builder_.mesh().vertices.empty()) file_.fail("POINTS a second time");
      const std::uint64_t points = count("number of points");
      const NumberType type = legacy_type(file_, next_word(file_));
      if (is_integer(type)) file_.fail("coordinates are of float or double");
      Numbers coordinates = numbers(type);
      read_points(coordinates, points, builder_);
    } else if (keyword == "polygons") {
      read_cells(Cells(file_, builder_, Cells::Kind::polygons, 0));
    } else if (keyword == "triangle_strips") {
      read_cells(Cells(file_, builder_, Cells::Kind::strips, 0));
    } else if (keyword == "vertices" || keyword == "lines") {
      read_cells(std::nullopt);
    } else if (keyword == "metadata") {
      pass_metadata();
    } else if (keyword == "field") {
      pass_fields();
    } else {
      file_.fail(fmt::format("keyword {}: not one of POLYDATA", in_quotes(keyword)));
    }
  }

  /// Since version 5.1 as two arrays; before, each cell's number of corners and its corners. Without `cells` they are
  /// passed over.
  void read_cells(std::optional<Cells> cells) {
    const std::uint64_t first = count("number of cells or offsets");
    const std::uint64_t second = count("size of the cells");
    if (begins_with_offsets()) return read_arrays_of_cells(first, second, cells);
    Numbers all = numbers(NumberType::int32);
    if (!cells) return all.pass(second, "cells");
    std::uint64_t used = 0;
    for (std::uint64_t k = 0; k < first; ++k) {
      const std::int64_t corners = all.whole("number of corners");
      cells->read_cell(all, corners);
      used += 1 + static_cast<std::uint64_t>(corners);
    }
    if (used != second) file_.fail(fmt::format("size of the cells = {}: it is {}", second, used));
  }

  /// Binary cells cannot begin so: it would be a cell of a billion corners.
  bool begins_with_offsets() {
    constexpr std::size_t enough = 64;
    std::string_view next = file_.peek(enough);
    next.remove_prefix(std::min(next.find_first_not_of(blanks_and_ends), next.size()));
    return lower_case(next.substr(0, 7)) == "offsets";
  }

  void read_arrays_of_cells(std::uint64_t offsets, std::uint64_t size, std::optional<Cells>& cells) {
    Numbers ends = integers("offsets");
    if (!cells || offsets == 0) {
      ends.pass(offsets, "offsets");
      return integers("connectivity").pass(size, "connectivity");
    }
    if (ends.whole("offset") != 0) file_.fail("the first offset must be 0");
    const std::vector<std::int64_t> read = cells->read_ends(ends, offsets - 1);
    Numbers connectivity = integers("connectivity");
    const std::int64_t last = read.empty() ? 0 : read.back();
    if (static_cast<std::uint64_t>(last) != size) file_.fail(fmt::format("the last offset is {}, not {}", last, size));
    cells->read_cells(connectivity, read);
  }

  /// Behind this keyword and their type.
  Numbers integers(std::string_view keyword) {
    expect(keyword);
    const NumberType type = legacy_type(file_, next_word(file_));
    if (!is_integer(type)) file_.fail(fmt::format("{} are integers", keyword));
    return numbers(type);
  }

  /// It ends with an empty line.
  void pass_metadata() {
    (void)take_line(file_, "metadata");
    while (!file_.peek(1).empty() && !is_blank(take_line(file_, "metadata"))) {
    }
  }

  /// Arrays with names that say something of the data as a whole, such as a time.
  void pass_fields() {
    (void)next_word(file_);
    const std::uint64_t arrays = count("number of arrays");
    for (std::uint64_t k = 0; k < arrays; ++k) {
      std::string name = word();
      if (name == "metadata") {
        pass_metadata();
        name = word();
      }
      const std::uint64_t components = count("number of components");
      const std::uint64_t tuples = count("number of tuples");
      Numbers array = numbers(legacy_type(file_, next_word(file_)));
      if (components > 0 && tuples > file_.remaining() / components)
        file_.fail("truncated: the field has more numbers");
      array.pass(components * tuples, "a field");
    }
  }

  InputFile& file_;
  MeshBuilder builder_;
  bool binary_ = false;
};

}  // namespace

Mesh read_vtk(InputFile& file) {
  return LegacyMesh(file).read();
}

}  // namespace verisq
