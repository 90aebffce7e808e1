/// This file implements map_layout.hpp.
#include "host/files/map_layout.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <utility>

namespace verisq {
namespace {

constexpr std::uint64_t bytes_of_word = 8;  // bytes of a Float64 or an Int64

class Declarations {
 public:
  explicit Declarations(const VtpLayout& layout) : layout_(layout) {}

  std::string text() {
    text_ =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "  <PolyData>\n";
    if (layout_.further_normals) add_further_normals(*layout_.further_normals);
    text_ += fmt::format(
        "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
        "NumberOfPolys=\"{}\">\n",
        layout_.points, layout_.has_triangles() ? 0 : layout_.cells(), layout_.has_triangles() ? layout_.cells() : 0);
    add_geometry();
    add_results();
    text_ += "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n_";
    return std::move(text_);
  }

 private:
  /// An array of the FieldData: it must state its length itself, or readers take it for empty (vtkXMLReader).
  void add_further_normals(std::uint64_t count) {
    const std::string length = fmt::format(" NumberOfTuples=\"{}\"", count);
    text_ += "    <FieldData>\n";
    add("Int32", "further_primitive", 1, sizeof(std::int32_t) * count, length);
    add("Float64", "further_normal", 3, 3 * bytes_of_word * count, length);
    if (const auto bits = layout_.cover_bits) {
      add("UInt8", "cover", 1, *bits, fmt::format(" NumberOfTuples=\"{}\"", *bits));
    }
    text_ += "    </FieldData>\n";
  }

  void add_geometry() {
    const char* const cell_type = layout_.has_triangles() ? "Polys" : "Verts";
    text_ += "      <Points>\n";
    add("Float64", "Points", 3, 3 * bytes_of_word * layout_.points);
    text_ += fmt::format("      </Points>\n      <{}>\n", cell_type);
    add("Int64", "connectivity", 1, bytes_of_word * layout_.corners() * layout_.cells());
    add("Int64", "offsets", 1, bytes_of_word * layout_.cells());
    text_ += fmt::format("      </{}>\n", cell_type);
  }

  void add_results() {
    const char* const data = layout_.elements == MapElements::vertices ? "PointData" : "CellData";
    const std::uint64_t rows = layout_.rows();
    text_ += fmt::format("      <{} Scalars=\"dist_mid\"{}>\n", data,
                         layout_.further_normals || layout_.closest_points ? " Vectors=\"normal\"" : "");
    add("Float64", "dist_lo", 1, bytes_of_word * rows);
    add("Float64", "dist_hi", 1, bytes_of_word * rows);
    add("Float64", "dist_mid", 1, bytes_of_word * rows);
    add("UInt8", "status", 1, rows);
    if (layout_.further_normals) add_certificates(rows);
    if (layout_.closest_points) add_closest_points(rows);
    text_ += fmt::format("      </{}>\n", data);
  }

  void add_certificates(std::uint64_t rows) {
    add("Int32", "primitive", 1, sizeof(std::int32_t) * rows);
    add("Float64", "normal", 3, 3 * bytes_of_word * rows);
    if (layout_.elements == MapElements::vertices) {
      add("Float64", "escape", 3, 3 * bytes_of_word * rows);
    } else {
      add("Float64", "weights", 2, 2 * bytes_of_word * rows);
    }
    add("Int64", "further_normals_end", 1, bytes_of_word * rows);
    if (!layout_.cover_bits) return;
    add("Float64", "witness", 3, 3 * bytes_of_word * rows);
    add("Int64", "cover_end", 1, bytes_of_word * rows);
  }

  void add_closest_points(std::uint64_t rows) {
    add("UInt8", "unique", 1, rows);
    for (const char* const name : {"closest_lo", "closest_hi", "normal_lo", "normal_hi", "normal"}) {
      add("Float64", name, 3, 3 * bytes_of_word * rows);
    }
    add("Int32", "primitive", 1, sizeof(std::int32_t) * rows);
  }

  /// An array of `bytes`. Arrays of a piece have as many tuples as the piece has points or cells; others state their
  /// `length`.
  void add(std::string_view type, std::string_view name, int components, std::uint64_t bytes,
           std::string_view length = "") {
    text_ += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n",
        type, name, components, length, next_offset_);
    next_offset_ += sizeof(std::uint64_t) + bytes;
  }

  const VtpLayout& layout_;
  std::string text_;
  std::uint64_t next_offset_ = 0;
};

}  // namespace

std::string vtp_declarations(const VtpLayout& layout) {
  return Declarations(layout).text();
}

namespace {

constexpr std::string_view hexadecimal_digits = "0123456789abcdef";
constexpr std::size_t bits_per_digit = 4;

}  // namespace

std::string digits_of_cover(const std::vector<bool>& cover) {
  std::string result((cover.size() + bits_per_digit - 1) / bits_per_digit, '0');
  for (std::size_t k = 0; k < result.size(); ++k) {
    std::size_t value = 0;
    for (std::size_t i = bits_per_digit * k; i < bits_per_digit * (k + 1); ++i) {
      value = 2 * value + (i < cover.size() && cover[i] ? 1 : 0);
    }
    result[k] = hexadecimal_digits[value];
  }
  return result;
}

std::optional<std::vector<bool>> cover_from(std::string_view text) {
  std::vector<bool> cover;
  std::size_t open = 1;
  for (const char digit : text) {
    const std::size_t value = hexadecimal_digits.find(digit);
    if (value == std::string_view::npos || open == 0) return std::nullopt;
    for (std::size_t i = 0; i < bits_per_digit; ++i) {
      const bool bit = (value >> (bits_per_digit - 1 - i) & 1U) != 0;
      if (open == 0 && bit) return std::nullopt;
      if (open == 0) continue;
      cover.push_back(bit);
      open = bit ? open + 1 : open - 1;
    }
  }
  return open == 0 ? std::optional(cover) : std::nullopt;
}

bool is_whole_cover(const std::vector<bool>& cover) {
  std::size_t open = 1;
  for (const bool halved : cover) {
    if (open == 0) return false;
    open = halved ? open + 1 : open - 1;
  }
  return open == 0;
}

namespace {

template <std::size_t N>
std::optional<std::array<double, N>> unless_none(const std::array<double, N>& numbers) {
  if (std::isnan(numbers[0])) return std::nullopt;
  return numbers;
}

}  // namespace

void CertificateColumns::append(const Certificate& certificate) {
  const std::vector<Normal>& normals = certificate.normals;
  primitive.push_back(normals.empty() ? no_primitive : static_cast<std::int32_t>(normals[0].primitive));
  normal.push_back(normals.empty() ? Point{} : normals[0].vector);
  if (elements == MapElements::vertices) {
    escape.push_back(certificate.escape.value_or(no_escape));
  } else {
    weights.push_back(certificate.weights.value_or(no_weights));
  }
  for (std::size_t k = 1; k < normals.size(); ++k) {
    further_primitive.push_back(static_cast<std::int32_t>(normals[k].primitive));
    further_normal.push_back(normals[k].vector);
  }
  further_normals_end.push_back(static_cast<std::int64_t>(further_primitive.size()));
  if (!covered) return;
  witness.push_back(certificate.witness.value_or(no_escape));
  cover.insert(cover.end(), certificate.cover.begin(), certificate.cover.end());
  cover_end.push_back(static_cast<std::int64_t>(cover.size()));
}

CertificateColumns::Range CertificateColumns::further_normals(std::size_t row) const {
  return {row == 0 ? 0 : static_cast<std::size_t>(further_normals_end[row - 1]),
          static_cast<std::size_t>(further_normals_end[row])};
}

void CertificateColumns::read(std::size_t row, Certificate& certificate) const {
  certificate.normals.clear();
  if (primitive[row] != no_primitive) {
    certificate.normals.push_back({static_cast<std::uint32_t>(primitive[row]), normal[row]});
  }
  const auto [begin, end] = further_normals(row);
  for (std::size_t k = begin; k < end; ++k) {
    certificate.normals.push_back({static_cast<std::uint32_t>(further_primitive[k]), further_normal[k]});
  }
  const bool of_vertex = elements == MapElements::vertices;
  certificate.escape = of_vertex ? unless_none(escape[row]) : std::nullopt;
  certificate.weights = of_vertex ? std::nullopt : unless_none(weights[row]);
  certificate.witness = covered ? unless_none(witness[row]) : std::nullopt;
  certificate.cover.clear();
  if (!covered) return;
  const std::int64_t first = row == 0 ? 0 : cover_end[row - 1];
  certificate.cover.assign(cover.begin() + first, cover.begin() + cover_end[row]);
}

}  // namespace verisq
