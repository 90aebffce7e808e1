/// NIfTI-1's header (nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h), of which the offsets are.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "host/files/byte_order.hpp"
#include "host/files/volume_formats.hpp"
#include "host/files/voxel_reader.hpp"

namespace verisq {
namespace {

constexpr std::size_t nifti_header_size = 348;
constexpr std::size_t nifti_2_header_size = 540;

/// The bytes of the header, in the byte order that its first number tells.
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

VoxelType nifti_voxel_type(const InputFile& file, const NiftiHeader& header) {
  switch (const auto code = header.number<std::int16_t>(70)) {
    case 2: return VoxelType::uint8;
    case 4: return VoxelType::int16;
    case 8: return VoxelType::int32;
    case 16: return VoxelType::float32;
    case 64: return VoxelType::float64;
    case 256: return VoxelType::int8;
    case 512: return VoxelType::uint16;
    case 768: return VoxelType::uint32;
    case 1024: return VoxelType::int64;
    case 1280: return VoxelType::uint64;
    default: file.fail_whole(fmt::format("datatype = {}: not supported, integers and floats are", code));
  }
}

/// dim[0] says how many of dim[1..7] count; those beyond three must be 1.
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

/// Stored values are labels themselves, not scaled ones. A slope of 0 says that there is none.
void check_scale(const InputFile& file, const NiftiHeader& header) {
  const double slope = header.finite(112, "scl_slope");
  const double intercept = header.finite(116, "scl_inter");
  if (slope == 0.0 || (slope == 1.0 && intercept == 0.0)) return;
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
  const VoxelType type = nifti_voxel_type(file, header);
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

}  // namespace verisq
