/// NIfTI-1 and NRRD: headers of volumes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "host/files/input_file.hpp"
#include "host/files/label_volume.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

constexpr std::size_t nifti_header_size = 348;
constexpr std::size_t nifti_2_header_size = 540;

/// The bytes of the header, in the byte order that its first number determines.
class NiftiHeader {
 public:
  NiftiHeader(const InputFile& file, ByteStream& stream) : file_(file) {
    stream.read(bytes_, "the header");
    if (begins_with(nifti_header_size)) return;
    if (begins_with(nifti_2_header_size)) refuse_version_2();
    order_ = order_ == std::endian::little ? std::endian::big : std::endian::little;
    if (begins_with(nifti_2_header_size)) refuse_version_2();
    if (!begins_with(nifti_header_size)) file_.fail_whole("is no NIfTI-1 file: it does not begin with the number 348");
  }

  [[nodiscard]] std::endian order() const { return order_; }

  template <class Value>
  [[nodiscard]] Value number(std::size_t offset) const {
    return number_from<Value>(bytes_.data() + offset, order_);
  }

  [[nodiscard]] double finite(std::size_t offset, std::string_view what) const {
    const auto value = static_cast<double>(number<float>(offset));
    if (!std::isfinite(value)) file_.fail_whole(fmt::format("{} of its header is {}: must be finite", what, value));
    return value;
  }

  [[nodiscard]] bool has_text(std::size_t offset, std::string_view text) const {
    return std::equal(text.begin(), text.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  }

 private:
  [[nodiscard]] bool begins_with(std::size_t size) const {
    return number<std::int32_t>(0) == static_cast<std::int32_t>(size);
  }
  [[noreturn]] void refuse_version_2() const { file_.fail_whole("NIfTI-2 is not supported, NIfTI-1 is"); }

  const InputFile& file_;
  std::array<char, nifti_header_size> bytes_{};
  std::endian order_ = std::endian::native;
};

NumberType nifti_voxel_type(const InputFile& file, const NiftiHeader& header) {
  switch (const auto code = header.number<std::int16_t>(70)) {
    case 2: return NumberType::uint8;
    case 4: return NumberType::int16;
    case 8: return NumberType::int32;
    case 16: return NumberType::float32;
    case 64: return NumberType::float64;
    case 256: return NumberType::int8;
    case 512: return NumberType::uint16;
    case 768: return NumberType::uint32;
    case 1024: return NumberType::int64;
    case 1280: return NumberType::uint64;
    default: file.fail_whole(fmt::format("datatype = {}: not supported, integers and floats are", code));
  }
}

/// dim[0] is the number of dim[1..7] that count; those beyond three must be 1.
std::array<std::int64_t, 3> nifti_counts(const InputFile& file, const NiftiHeader& header) {
  const auto dim = [&header](std::size_t k) { return header.number<std::int16_t>(40 + 2 * k); };
  const std::int16_t dimensions = dim(0);
  if (dimensions < 1 || dimensions > 7) file.fail_whole(fmt::format("dim[0] = {}: must be from 1 to 7", dimensions));
  for (std::size_t k = 4; k <= static_cast<std::size_t>(dimensions); ++k)
    if (dim(k) != 1) file.fail_whole(fmt::format("dim[{}] = {}: one label a voxel is needed", k, dim(k)));
  std::array<std::int64_t, 3> counts{1, 1, 1};
  for (std::size_t k = 1; k <= 3 && k <= static_cast<std::size_t>(dimensions); ++k) counts[k - 1] = dim(k);
  return counts;
}

/// Stored values are labels themselves, not scaled ones. A slope of 0 means that there is none. So does NaN: NIfTI's
/// own library takes it for 0, and others write it.
void check_scale(const InputFile& file, const NiftiHeader& header) {
  const auto slope = static_cast<double>(header.number<float>(112));
  if (slope == 0.0 || std::isnan(slope)) return;
  const double intercept = header.finite(116, "scl_inter");
  if (slope == 1.0 && intercept == 0.0) return;
  file.fail_whole(fmt::format("scl_slope = {}, scl_inter = {}: labels are not scaled", slope, intercept));
}

double millimetres(const InputFile& file, const NiftiHeader& header) {
  switch (const int code = header.number<std::uint8_t>(123) & 7) {
    case 0:
    case 2: return 1.0;
    case 1: return 1e3;
    case 3: return 1e-3;
    default: file.fail_whole(fmt::format("xyzt_units: {} is no unit of length", code));
  }
}

/// Method 3 of the header: an affine map, its rows one after another.
void read_rows(const NiftiHeader& header, LabelVolume& volume) {
  for (std::size_t row = 0; row < 3; ++row) {
    const std::size_t at = 280 + 16 * row;
    for (std::size_t axis = 0; axis < 3; ++axis) volume.steps[axis][row] = header.finite(at + 4 * axis, "srow");
    volume.origin[row] = header.finite(at + 12, "srow");
  }
}

/// A sign is none of its: taken for one it would mirror the volume.
double spacing_of(const InputFile& file, const NiftiHeader& header, std::size_t axis) {
  const double spacing = header.finite(80 + 4 * axis, "pixdim");
  if (!(spacing > 0.0)) file.fail_whole(fmt::format("pixdim[{}] = {}: must be above 0", axis + 1, spacing));
  return spacing;
}

/// Method 2: a unit quaternion of which (b, c, d) are given and a >= 0, spacings, and a sign of the third axis.
void read_quaternion(const InputFile& file, const NiftiHeader& header, LabelVolume& volume) {
  const double b = header.finite(256, "quatern_b");
  const double c = header.finite(260, "quatern_c");
  const double d = header.finite(264, "quatern_d");
  const double rest = 1.0 - (b * b + c * c + d * d);
  if (rest < -1e-5) file.fail_whole("its quaternion is longer than 1");  // binary32 numbers, some units of rounding off
  const double a = rest > 0.0 ? std::sqrt(rest) : 0.0;
  const std::array<Point, 3> columns{
      Point{a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)},
      Point{2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)},
      Point{2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - c * c - b * b}};
  const double sign = header.finite(76, "pixdim[0]") < 0.0 ? -1.0 : 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spacing = (axis == 2 ? sign : 1.0) * spacing_of(file, header, axis);
    for (std::size_t row = 0; row < 3; ++row) volume.steps[axis][row] = spacing * columns[axis][row];
    volume.origin[axis] = header.finite(268 + 4 * axis, "qoffset");
  }
}

/// Method 1: spacings alone.
void read_pixdim(const InputFile& file, const NiftiHeader& header, LabelVolume& volume) {
  for (std::size_t axis = 0; axis < 3; ++axis) volume.steps[axis][axis] = spacing_of(file, header, axis);
}

void read_axes(const InputFile& file, const NiftiHeader& header, LabelVolume& volume) {
  const bool has_rows = header.number<std::int16_t>(254) > 0;
  const bool has_quaternion = header.number<std::int16_t>(252) > 0;
  if (has_rows) {
    read_rows(header, volume);
  } else if (has_quaternion) {
    read_quaternion(file, header, volume);
  } else {
    read_pixdim(file, header, volume);
  }
  const double unit = millimetres(file, header);
  for (double& x : volume.origin) x *= unit;
  for (Point& step : volume.steps)
    for (double& x : step) x *= unit;
  if (!has_rows && !has_quaternion) return;
  turn_about_z(volume);  // from RAS
  volume.space = AnatomicalSpace::lps;
}

/// Between the header and the voxels may be extensions.
void go_to_voxels(const InputFile& file, const NiftiHeader& header, ByteStream& stream) {
  const double offset = header.finite(108, "vox_offset");
  if (!(offset >= static_cast<double>(nifti_header_size) && offset <= static_cast<double>(stream.most_bytes())))
    file.fail_whole(fmt::format("vox_offset = {}: must be after the header and within the file", offset));
  std::array<char, 4096> passed{};
  for (auto left = static_cast<std::uint64_t>(offset) - nifti_header_size; left > 0;) {
    const std::size_t part = std::min<std::uint64_t>(left, passed.size());
    stream.read(std::span(passed).first(part), "extensions of the header");
    left -= part;
  }
}

}  // namespace

LabelVolume read_nifti(InputFile& file) {
  const bool packed = file.peek(2) == "\x1f\x8b";
  ByteStream stream(file, packed ? ByteStream::Packing::gzip : ByteStream::Packing::none);
  const NiftiHeader header(file, stream);
  if (!header.has_text(344, std::string_view("n+1\0", 4)))
    file.fail_whole("is no NIfTI-1 file of header and voxels in one: it has no \"n+1\" at byte 344");
  const NumberType type = nifti_voxel_type(file, header);
  const std::array<std::int64_t, 3> counts = nifti_counts(file, header);
  const std::size_t count = voxel_count(file, stream, counts, type);
  check_scale(file, header);
  LabelVolume volume{.counts = {static_cast<std::size_t>(counts[0]), static_cast<std::size_t>(counts[1]),
                                static_cast<std::size_t>(counts[2])},
                     .origin = {},
                     .steps = {},
                     .space = AnatomicalSpace::unknown,
                     .labels = {}};
  read_axes(file, header, volume);
  check_axes(file, volume);
  go_to_voxels(file, header, stream);
  volume.labels = read_voxels(file, stream, count, type, header.order());
  return volume;
}

namespace {

struct NrrdHeader {
  std::optional<NumberType> type;
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

NumberType nrrd_voxel_type(const InputFile& file, std::string_view text) {
  using enum NumberType;
  constexpr std::array<std::pair<std::string_view, NumberType>, 42> names{{
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
  const auto found = std::ranges::find(names, text, &std::pair<std::string_view, NumberType>::first);
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

/// "mm" "mm" "mm": the unit of length in mm, the same along all axes.
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

/// The point in mm.
Point in_lps(const Point& x, const NrrdHeader& header) {
  const double unit = header.millimetres;
  return {header.signs[0] * unit * x[0], header.signs[1] * unit * x[1], header.signs[2] * unit * x[2]};
}

}  // namespace

LabelVolume read_nrrd(InputFile& file) {
  const NrrdHeader header = read_nrrd_header(file);
  if (!header.has_dimension) file.fail_whole("its header has no dimension");
  const NumberType type = required(file, header.type, "type");
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
