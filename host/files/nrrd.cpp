/// NRRD's header (teem.sourceforge.net/nrrd/format.html), line by line.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/files/volume_formats.hpp"
#include "host/files/voxel_reader.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

struct NrrdHeader {
  std::optional<VoxelType> type;
  bool has_dimension = false;
  std::optional<std::array<std::int64_t, 3>> sizes;
  std::optional<ByteStream::Packing> packing;
  std::optional<std::endian> order;
  AnatomicalSpace space = AnatomicalSpace::unknown;
  Point signs{1.0, 1.0, 1.0};  ///< from the file's coordinates to LPS
  double millimetres = 1.0;    ///< a unit of the file's lengths
  Point origin{};
  std::array<Point, 3> steps{Point{1.0, 0.0, 0.0}, Point{0.0, 1.0, 0.0}, Point{0.0, 0.0, 1.0}};
};

VoxelType nrrd_voxel_type(const InputFile& file, std::string_view text) {
  using enum VoxelType;
  constexpr std::array<std::pair<std::string_view, VoxelType>, 42> names{{
      {"signed char", int8},
      {"int8", int8},
      {"int8_t", int8},
      {"uchar", uint8},
      {"unsigned char", uint8},
      {"uint8", uint8},
      {"uint8_t", uint8},
      {"short", int16},
      {"short int", int16},
      {"signed short", int16},
      {"signed short int", int16},
      {"int16", int16},
      {"int16_t", int16},
      {"ushort", uint16},
      {"unsigned short", uint16},
      {"unsigned short int", uint16},
      {"uint16", uint16},
      {"uint16_t", uint16},
      {"int", int32},
      {"signed int", int32},
      {"int32", int32},
      {"int32_t", int32},
      {"uint", uint32},
      {"unsigned int", uint32},
      {"uint32", uint32},
      {"uint32_t", uint32},
      {"longlong", int64},
      {"long long", int64},
      {"long long int", int64},
      {"signed long long", int64},
      {"signed long long int", int64},
      {"int64", int64},
      {"int64_t", int64},
      {"ulonglong", uint64},
      {"unsigned long long", uint64},
      {"unsigned long long int", uint64},
      {"uint64", uint64},
      {"uint64_t", uint64},
      {"float", float32},
      {"double", float64},
      {"float32", float32},
      {"float64", float64},
  }};
  const auto found = std::ranges::find(names, text, &std::pair<std::string_view, VoxelType>::first);
  if (found == names.end()) file.fail(fmt::format("type {}: not supported, integers and floats are", in_quotes(text)));
  return found->second;
}

void read_space(const InputFile& file, std::string_view text, NrrdHeader& header) {
  const std::string name = lower_case(text);
  const auto is = [&name](std::string_view full, std::string_view initials) {
    return name == full || name == initials;
  };
  header.space = AnatomicalSpace::lps;
  if (is("left-posterior-superior", "lps")) return;
  if (is("right-anterior-superior", "ras")) {
    header.signs = {-1.0, -1.0, 1.0};
  } else if (is("left-anterior-superior", "las")) {
    header.signs = {1.0, -1.0, 1.0};
  } else if (name.ends_with("-time") || (name.size() == 4 && name.ends_with('t'))) {
    file.fail(fmt::format("space {}: volumes over time are not supported", in_quotes(text)));
  } else {
    header.space = AnatomicalSpace::unknown;
  }
}

/// "(x,y,z)", from the front of `text`.
Point take_vector(const InputFile& file, std::string_view& text, std::string_view what) {
  text = trimmed(text);
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos)
    file.fail(fmt::format("{}: expected (x,y,z), found {}", what, in_quotes(text)));
  std::string_view inside = text.substr(1, end - 1);
  text.remove_prefix(end + 1);
  Point result{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t comma = inside.find(',');
    if ((comma == std::string_view::npos) != (axis == 2))
      file.fail(fmt::format("{}: a vector has other than three numbers", what));
    result[axis] = finite_number(file, trimmed(inside.substr(0, comma)), what);
    if (axis < 2) inside.remove_prefix(comma + 1);
  }
  return result;
}

void expect_nothing(const InputFile& file, std::string_view text, std::string_view what) {
  if (!trimmed(text).empty()) file.fail(fmt::format("{}: unexpected {}", what, in_quotes(trimmed(text))));
}

std::array<std::int64_t, 3> read_sizes(const InputFile& file, std::string_view text) {
  Words words(text);
  std::array<std::int64_t, 3> sizes{};
  for (std::int64_t& size : sizes) size = integer(file, words.next(), "size");
  expect_end(file, words);
  return sizes;
}

void read_spacings(const InputFile& file, std::string_view text, NrrdHeader& header) {
  Words words(text);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view word = words.next();
    const double spacing = finite_number(file, word, "spacing");
    if (!(spacing > 0.0)) file.fail(fmt::format("spacing = {}: must be above 0", in_quotes(word)));
    header.steps[axis][axis] = spacing;
  }
  expect_end(file, words);
}

/// "mm" "mm" "mm": what a unit of length is in mm, the same along all axes.
double read_units(const InputFile& file, std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 4> known{
      {{"\"mm\"", 1.0}, {"\"cm\"", 10.0}, {"\"m\"", 1000.0}, {"\"um\"", 1e-3}}};
  Words words(text);
  const std::string_view first = words.next();
  const auto* const unit = std::ranges::find(known, first, [](const auto& each) { return each.first; });
  if (unit == known.end()) file.fail(fmt::format("units {}: must be \"mm\", \"cm\", \"m\" or \"um\"", in_quotes(text)));
  for (int axis = 1; axis < 3; ++axis) {
    if (words.next() != first) file.fail(fmt::format("units {}: must be the same along three axes", in_quotes(text)));
  }
  expect_end(file, words);
  return unit->second;
}

ByteStream::Packing packing_of(const InputFile& file, std::string_view text) {
  if (text == "raw") return ByteStream::Packing::none;
  if (text == "gzip" || text == "gz") return ByteStream::Packing::gzip;
  file.fail(fmt::format("encoding {}: not supported, raw and gzip are", in_quotes(text)));
}

std::endian order_of(const InputFile& file, std::string_view text) {
  if (text == "little") return std::endian::little;
  if (text == "big") return std::endian::big;
  file.fail(fmt::format("endian {}: must be little or big", in_quotes(text)));
}

void check_dimension(const InputFile& file, std::string_view text) {
  const std::int64_t dimension = integer(file, text, "dimension");
  if (dimension == 3) return;
  file.fail(fmt::format("dimension = {}: must be 3, one label a voxel{}", dimension,
                        dimension == 4 ? " (segments that overlap lie in layers: export them as a label map)" : ""));
}

void read_field(const InputFile& file, std::string_view field, std::string_view text, NrrdHeader& header) {
  if (field == "type") {
    header.type = nrrd_voxel_type(file, text);
  } else if (field == "dimension") {
    check_dimension(file, text);
    header.has_dimension = true;
  } else if (field == "sizes") {
    header.sizes = read_sizes(file, text);
  } else if (field == "encoding") {
    header.packing = packing_of(file, text);
  } else if (field == "endian") {
    header.order = order_of(file, text);
  } else if (field == "space") {
    read_space(file, text, header);
  } else if (field == "space dimension") {
    if (integer(file, text, field) != 3) file.fail(fmt::format("space dimension = {}: must be 3", in_quotes(text)));
  } else if (field == "space origin") {
    header.origin = take_vector(file, text, field);
    expect_nothing(file, text, field);
  } else if (field == "space directions") {
    for (Point& step : header.steps) step = take_vector(file, text, field);
    expect_nothing(file, text, field);
  } else if (field == "spacings") {
    read_spacings(file, text, header);
  } else if (field == "space units" || field == "units") {
    header.millimetres = read_units(file, text);
  } else if (field == "data file" || field == "datafile") {
    file.fail("data file: the voxels must be in the same file");
  } else if (field == "line skip" || field == "lineskip" || field == "byte skip" || field == "byteskip") {
    if (integer(file, text, field) != 0) file.fail(fmt::format("{} is not supported", field));
  }  // others say nothing of where voxels lie: kinds, centers, content, measurement frame
}

NrrdHeader read_nrrd_header(InputFile& file) {
  const auto magic = file.next_line();
  if (!magic || !magic->starts_with("NRRD000")) file.fail("does not begin with NRRD000");
  NrrdHeader header;
  std::set<std::string> seen;
  while (true) {
    const auto line = file.next_line();
    if (!line) file.fail("truncated: the file ends inside its header");
    if (line->empty()) {
      if (seen.contains("spacings") && seen.contains("space directions"))
        file.fail("spacings and space directions contradict each other: one of them says how far voxels are apart");
      return header;
    }
    if (line->starts_with('#')) continue;
    const std::size_t colon = line->find(':');
    if (colon == std::string_view::npos) file.fail(fmt::format("expected FIELD: VALUE, found {}", in_quotes(*line)));
    if (line->substr(colon).starts_with(":=")) continue;  // a key and a value of its writer's
    const std::string field = lower_case(trimmed(line->substr(0, colon)));
    if (!seen.insert(field).second) file.fail(fmt::format("{} appears twice", in_quotes(field)));
    read_field(file, field, trimmed(line->substr(colon + 1)), header);
  }
}

template <class Value>
Value required(const InputFile& file, const std::optional<Value>& value, std::string_view field) {
  if (!value) file.fail_whole(fmt::format("its header has no {}", field));
  return *value;
}

/// In mm.
Point in_lps(const Point& x, const NrrdHeader& header) {
  const double unit = header.millimetres;
  return {header.signs[0] * unit * x[0], header.signs[1] * unit * x[1], header.signs[2] * unit * x[2]};
}

}  // namespace

LabelVolume read_nrrd(InputFile& file) {
  const NrrdHeader header = read_nrrd_header(file);
  if (!header.has_dimension) file.fail_whole("its header has no dimension");
  const VoxelType type = required(file, header.type, "type");
  const std::array<std::int64_t, 3> sizes = required(file, header.sizes, "sizes");
  const std::endian order = size_of(type) == 1 ? std::endian::native : required(file, header.order, "endian");
  ByteStream stream(file, required(file, header.packing, "encoding"));
  const std::size_t count = voxel_count(file, stream, sizes, type);
  LabelVolume volume{
      .counts = {static_cast<std::size_t>(sizes[0]), static_cast<std::size_t>(sizes[1]),
                 static_cast<std::size_t>(sizes[2])},
      .origin = in_lps(header.origin, header),
      .steps = {in_lps(header.steps[0], header), in_lps(header.steps[1], header), in_lps(header.steps[2], header)},
      .space = header.space,
      .labels = {}};
  check_axes(file, volume);
  volume.labels = read_voxels(file, stream, count, type, order);
  return volume;
}

}  // namespace verisq
