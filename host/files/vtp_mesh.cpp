/// Meshes of VTK in XML (`.vtp`, "VTK File Formats"): PolyData of one or several pieces, arrays in every encoding.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <map>
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

// Tags are read one after the other, and the text between them is passed over: it may be a gigabyte.

constexpr std::size_t longest_tag = std::size_t{1} << 16U;  // or comment

struct Tag {
  std::string name;
  std::map<std::string, std::string, std::less<>> attributes;
  bool is_end = false;    ///< of an element that began before
  bool is_whole = false;  ///< an element without content

  /// Empty if it is missing.
  [[nodiscard]] std::string_view attribute(std::string_view wanted) const {
    const auto found = attributes.find(wanted);
    return found == attributes.end() ? std::string_view() : found->second;
  }
};

/// Reads the text between '<' and '>'.
Tag tag_of(const InputFile& file, std::string_view text) {
  const auto pass = [&text](std::size_t count) { text.remove_prefix(std::min(count, text.size())); };
  Tag tag{.name = {}, .attributes = {}, .is_end = text.starts_with('/'), .is_whole = text.ends_with('/')};
  if (tag.is_end) pass(1);
  if (tag.is_whole) text.remove_suffix(std::min<std::size_t>(1, text.size()));
  tag.name = text.substr(0, text.find_first_of(blanks_and_ends));
  pass(tag.name.size());
  for (pass(text.find_first_not_of(blanks_and_ends)); !text.empty(); pass(text.find_first_not_of(blanks_and_ends))) {
    const std::size_t equals = text.find('=');
    const std::string name(trimmed(text.substr(0, equals)));
    pass(equals == std::string_view::npos ? equals : text.find_first_not_of(blanks_and_ends, equals + 1));
    const std::size_t end = text.empty() ? std::string_view::npos : text.find(text[0], 1);
    if (end == std::string_view::npos || (text[0] != '"' && text[0] != '\'')) {
      file.fail(
          fmt::format("<{}>: not XML: attribute {} without a value in quotes", printable(tag.name), in_quotes(name)));
    }
    const bool fresh = tag.attributes.emplace(name, text.substr(1, end - 1)).second;
    if (!fresh) file.fail(fmt::format("not XML: attribute {} appears twice", in_quotes(name)));
    pass(end + 1);
  }
  return tag;
}

/// The number of bytes up to and with the '>' that ends the tag; no '>' between quotes does.
std::size_t length_of_tag(const InputFile& file, std::string_view start) {
  char quote = '\0';
  for (std::size_t k = 0; k < start.size(); ++k) {
    if (quote != '\0') {
      if (start[k] == quote) quote = '\0';
    } else if (start[k] == '"' || start[k] == '\'') {
      quote = start[k];
    } else if (start[k] == '>') {
      return k + 1;
    }
  }
  file.fail(fmt::format("not XML: the tag {} does not end", in_quotes(start)));
}

/// Takes the text up to and with `end`, which is near.
void pass_through(InputFile& file, std::string_view end, std::string_view what) {
  const std::size_t at = file.peek(longest_tag).find(end);
  if (at == std::string_view::npos) file.fail(fmt::format("not XML: {} does not end", what));
  (void)file.take(at + end.size(), what);
}

/// Nothing at the end of the file.
std::optional<Tag> next_tag(InputFile& file) {
  while (true) {
    const std::string_view start = file.peek(longest_tag);
    const std::size_t text = start.find('<');
    if (start.empty()) return std::nullopt;
    (void)file.take(std::min(text, start.size()), "text");
    if (text == std::string_view::npos) continue;
    (void)file.take(0, "a tag");  // which messages name from here on
    const std::string_view markup = file.peek(longest_tag);
    if (markup.starts_with("<!--")) {
      pass_through(file, "-->", "a comment");
    } else if (markup.starts_with("<?") || markup.starts_with("<!")) {
      pass_through(file, ">", "a declaration");
    } else {
      std::string_view tag = file.take(length_of_tag(file, markup), "a tag");
      tag.remove_prefix(1);
      tag.remove_suffix(1);
      return tag_of(file, tag);
    }
  }
}

/// PolyData in XML: first all tags, then the arrays that a mesh needs, each where it lies.
class VtpMesh {
 public:
  explicit VtpMesh(InputFile& file) : file_(file) {
    file_.begin_text();
    read_tags();
    if (pieces_.empty()) file_.fail_whole("no <Piece> of <PolyData>");
  }

  Mesh read() {
    MeshBuilder builder(file_);
    for (const Piece& piece : pieces_) {
      const std::size_t first = builder.mesh().vertices.size();
      if (piece.points > 0) {
        Numbers numbers = numbers_of(piece.coordinates, "Points");
        numbers.begin(piece.points, 3, "Points");
        read_points(numbers, piece.points, builder);
        expect_end_of(piece.coordinates);
      }
      read_cells(piece.polys, {file_, builder, Cells::Kind::polygons, first});
      read_cells(piece.strips, {file_, builder, Cells::Kind::strips, first});
    }
    return std::move(builder).finish();
  }

 private:
  struct Array {
    NumberType type;
    std::string format;      ///< "ascii", "binary" or "appended"
    std::uint64_t position;  ///< in the file, or in its appended part
  };

  struct CellArrays {
    std::uint64_t count = 0;
    std::optional<Array> connectivity;
    std::optional<Array> offsets;
  };

  struct Piece {
    std::uint64_t points = 0;
    std::optional<Array> coordinates;
    CellArrays polys;
    CellArrays strips;
  };

  /// Up to the end of XML, or to the bytes behind it.
  void read_tags() {
    std::vector<std::string> open;
    while (std::optional<Tag> tag = next_tag(file_)) {
      if (tag->is_end) {
        if (open.empty() || open.back() != tag->name) {
          file_.fail(fmt::format("not XML: {} ends where it has not begun", in_quotes(tag->name)));
        }
        open.pop_back();
        if (open.empty()) return expect_end_of_file();
        continue;
      }
      if (open.empty()) {
        begin_file(*tag);
      } else if (tag->name == "AppendedData" && open.size() == 1) {
        return begin_appended(*tag);
      } else if (tag->name == "Piece" && open.size() == 2 && open[1] == "PolyData") {
        begin_piece(*tag);
      } else if (tag->name == "DataArray" && open.size() == 4 && open[1] == "PolyData" && open[2] == "Piece") {
        begin_array(*tag, open[3]);
      }
      if (!tag->is_whole) open.push_back(std::move(tag->name));
    }
    file_.fail_whole("truncated: the file ends without </VTKFile>");
  }

  [[noreturn]] void refuse(const Tag& tag, std::string_view attribute, std::string_view why) const {
    const std::string_view value = tag.attribute(attribute);
    file_.fail(fmt::format("<{}>: {} = {}: {}", printable(tag.name), attribute, in_quotes(value), why));
  }

  void begin_file(const Tag& tag) {
    if (tag.name != "VTKFile") file_.fail(fmt::format("<{}>: expected <VTKFile>", printable(tag.name)));
    if (tag.attribute("type") != "PolyData") {
      refuse(tag, "type", "only PolyData is a mesh; ParaView makes it of others by Extract Surface");
    }
    const std::string_view order = tag.attribute("byte_order");
    if (order != "LittleEndian" && order != "BigEndian") refuse(tag, "byte_order", "LittleEndian or BigEndian");
    coding_.order = order == "BigEndian" ? std::endian::big : std::endian::little;
    const std::string_view header = tag.attribute("header_type");
    if (!header.empty() && header != "UInt32" && header != "UInt64") refuse(tag, "header_type", "UInt32 or UInt64");
    coding_.header = header == "UInt64" ? NumberType::uint64 : NumberType::uint32;
    const std::string_view compressor = tag.attribute("compressor");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor") {
      refuse(tag, "compressor",
             "not supported: write the file with vtkZLibDataCompressor (ZLib), or without a compressor");
    }
    coding_.packed = !compressor.empty();
  }

  void begin_piece(const Tag& tag) {
    const auto count = [&](std::string_view name) {
      const std::string_view text = tag.attribute(name);
      return text.empty() ? 0 : count_from(file_, text, name);
    };
    Piece piece;
    piece.points = count("NumberOfPoints");
    piece.polys.count = count("NumberOfPolys");
    piece.strips.count = count("NumberOfStrips");
    pieces_.push_back(std::move(piece));
  }

  /// Keeps the place of an array of the last piece if a mesh needs it.
  void begin_array(const Tag& tag, std::string_view parent) {
    Piece& piece = pieces_.back();
    const std::string_view name = tag.attribute("Name");
    if (parent == "Points") return place(tag, "3", piece.coordinates);
    if (parent != "Polys" && parent != "Strips") return;
    CellArrays& cells = parent == "Polys" ? piece.polys : piece.strips;
    if (name == "connectivity") place(tag, "1", cells.connectivity);
    if (name == "offsets") place(tag, "1", cells.offsets);
  }

  void place(const Tag& tag, std::string_view components, std::optional<Array>& array) const {
    if (array) file_.fail("<DataArray>: a second one of its kind in this piece");
    const std::string_view given = tag.attribute("NumberOfComponents");
    if (given != components && !(given.empty() && components == "1")) {
      refuse(tag, "NumberOfComponents", fmt::format("expected {}", components));
    }
    constexpr std::array<std::string_view, 10> names{"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                                     "UInt32", "Int64", "UInt64", "Float32", "Float64"};
    const auto* const found = std::ranges::find(names, tag.attribute("type"));
    const auto type = static_cast<NumberType>(found - names.begin());
    if (found == names.end() || is_integer(type) != (components == "1")) {
      refuse(tag, "type", "coordinates are of Float32 or Float64, indices of integers");
    }
    const std::string format(tag.attribute("format"));
    if (format != "ascii" && format != "binary" && format != "appended") {
      refuse(tag, "format", "ascii, binary or appended");
    }
    const bool appended = format == "appended";
    array = {type, format, appended ? count_from(file_, tag.attribute("offset"), "offset") : file_.position()};
  }

  void begin_appended(const Tag& tag) {
    const std::string_view encoding = tag.attribute("encoding");
    if (encoding != "raw" && encoding != "base64") refuse(tag, "encoding", "raw or base64");
    appended_base64_ = encoding == "base64";
    pass_blanks(file_);
    if (file_.take(1, "the appended data")[0] != '_') file_.fail("the appended data do not begin with '_'");
    appended_ = file_.position();
    expect_end_behind_appended();
  }

  void expect_end_of_file() {
    pass_blanks(file_);
    if (!file_.peek(1).empty()) file_.fail(fmt::format("{} bytes behind </VTKFile>", file_.remaining()));
  }

  /// The arrays in the appended part may be more than those that are read: the last bytes say whether it is whole.
  void expect_end_behind_appended() {
    constexpr std::size_t enough = 256;
    file_.go_to(std::max(*appended_, file_.size() - std::min<std::uint64_t>(enough, file_.size())));
    std::string_view rest = file_.peek(enough);
    const auto ends_with = [&rest](std::string_view end) {
      rest = rest.substr(0, rest.find_last_not_of(blanks_and_ends) + 1);
      const bool found = rest.ends_with(end);
      if (found) rest.remove_suffix(end.size());
      return found;
    };
    if (!ends_with("</VTKFile>") || !ends_with("</AppendedData>")) {
      file_.fail_whole("truncated, or longer: it does not end with </AppendedData></VTKFile>");
    }
  }

  /// Goes to the array.
  Numbers numbers_of(const std::optional<Array>& array, std::string_view what) {
    if (!array) file_.fail_whole(fmt::format("a piece without the DataArray of its {}", what));
    if (array->format != "appended") {
      file_.go_to(array->position);
    } else if (!appended_) {
      file_.fail_whole("an array is appended, but there is no <AppendedData>");
    } else if (array->position > file_.size() - *appended_) {
      file_.fail_whole(fmt::format("{}: offset = {}: beyond the end of the file", what, array->position));
    } else {
      file_.go_to(*appended_ + array->position);
    }
    if (array->format == "ascii") return Numbers(file_);
    Coding coding = coding_;
    coding.base64 = array->format == "binary" || appended_base64_;
    return {file_, array->type, coding};
  }

  /// Refuses more text in the element of an array that was read.
  void expect_end_of(const std::optional<Array>& array) {
    if (array->format == "appended") return;
    pass_blanks(file_);
    if (!file_.peek(1).starts_with('<')) file_.fail("more numbers than the piece has");
  }

  void read_cells(const CellArrays& arrays, Cells cells) {
    if (arrays.count == 0) return;
    Numbers offsets = numbers_of(arrays.offsets, "offsets");
    offsets.begin(arrays.count, 1, "offsets");
    const std::vector<std::int64_t> ends = cells.read_ends(offsets, arrays.count);
    expect_end_of(arrays.offsets);
    Numbers connectivity = numbers_of(arrays.connectivity, "connectivity");
    connectivity.begin(static_cast<std::uint64_t>(ends.back()), 1, "connectivity");
    cells.read_cells(connectivity, ends);
    expect_end_of(arrays.connectivity);
  }

  InputFile& file_;
  Coding coding_;
  bool appended_base64_ = false;
  std::optional<std::uint64_t> appended_;  // the position of the appended data, behind '_'
  std::vector<Piece> pieces_;
};

}  // namespace

Mesh read_vtp(InputFile& file) {
  return VtpMesh(file).read();
}

}  // namespace verisq
