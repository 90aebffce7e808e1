/// Certified maps as VTK XML PolyData: the arrays of picture, enclosures and certificates, checked before any is used.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "host/files/byte_order.hpp"
#include "host/files/certificate_columns.hpp"
#include "host/files/cover_digits.hpp"
#include "host/files/input_file.hpp"
#include "host/files/map_picture.hpp"
#include "host/files/map_rows.hpp"
#include "host/files/vtp_document.hpp"
#include "host/files/vtp_layout.hpp"

namespace verisq {
namespace {

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
    check_size(array, sizeof(Item));
    std::vector<Item> items;
    items.reserve(array.tuples);  // the file holds that many
    while (items.size() < array.tuples) {
      const std::size_t count = std::min<std::size_t>(array.tuples - items.size(), block_size / sizeof(Item));
      const std::string_view bytes = file_.take(count * sizeof(Item), array.name);
      for (std::size_t k = 0; k < count; ++k) items.push_back(item_from<Item>(bytes.data() + k * sizeof(Item)));
    }
    return items;
  }

  /// Nothing may follow the arrays but what closes the file.
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

  /// The number of bytes before the array must be what its declaration says, and the file must hold them.
  void check_size(const DeclaredArray& array, std::size_t item_size) {
    const auto bytes = item_from<std::uint64_t>(file_.take(sizeof(std::uint64_t), array.name).data());
    if (bytes % item_size != 0 || bytes / item_size != array.tuples) {
      fail(array, fmt::format("{} bytes, expected {} times {}", bytes, array.tuples, item_size));
    }
    if (bytes > file_.remaining()) {
      fail(array, fmt::format("truncated: {} bytes, the file has {} more", bytes, file_.remaining()));
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

  /// What `CertificateColumns::read` relies on: the ends ascend from 0 to the length of both further columns.
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

  /// Likewise; and each cover is a whole one.
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

  /// What a row of the map is about.
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
