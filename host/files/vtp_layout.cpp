/// Writes the XML part of a `.vtp` map.
#include "host/files/vtp_layout.hpp"

#include <fmt/format.h>

#include <utility>

namespace verisq {
namespace {

constexpr std::uint64_t word = 8;  // bytes of a Float64 or an Int64

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
  /// An array of the FieldData: it must say its length itself, or readers take it for empty (vtkXMLReader).
  void add_further_normals(std::uint64_t count) {
    const std::string length = fmt::format(" NumberOfTuples=\"{}\"", count);
    text_ += "    <FieldData>\n";
    add("Int32", "further_primitive", 1, sizeof(std::int32_t) * count, length);
    add("Float64", "further_normal", 3, 3 * word * count, length);
    if (const auto bits = layout_.cover_bits) {
      add("UInt8", "cover", 1, *bits, fmt::format(" NumberOfTuples=\"{}\"", *bits));
    }
    text_ += "    </FieldData>\n";
  }

  void add_geometry() {
    const char* const cell_type = layout_.has_triangles() ? "Polys" : "Verts";
    text_ += "      <Points>\n";
    add("Float64", "Points", 3, 3 * word * layout_.points);
    text_ += fmt::format("      </Points>\n      <{}>\n", cell_type);
    add("Int64", "connectivity", 1, word * layout_.corners() * layout_.cells());
    add("Int64", "offsets", 1, word * layout_.cells());
    text_ += fmt::format("      </{}>\n", cell_type);
  }

  void add_results() {
    const char* const data = layout_.elements == MapElements::vertices ? "PointData" : "CellData";
    const std::uint64_t rows = layout_.rows();
    text_ += fmt::format("      <{} Scalars=\"dist_mid\"{}>\n", data,
                         layout_.further_normals || layout_.closest_points ? " Vectors=\"normal\"" : "");
    add("Float64", "dist_lo", 1, word * rows);
    add("Float64", "dist_hi", 1, word * rows);
    add("Float64", "dist_mid", 1, word * rows);
    add("UInt8", "status", 1, rows);
    if (layout_.further_normals) add_certificates(rows);
    if (layout_.closest_points) add_closest_points(rows);
    text_ += fmt::format("      </{}>\n", data);
  }

  void add_certificates(std::uint64_t rows) {
    add("Int32", "primitive", 1, sizeof(std::int32_t) * rows);
    add("Float64", "normal", 3, 3 * word * rows);
    if (layout_.elements == MapElements::vertices) {
      add("Float64", "escape", 3, 3 * word * rows);
    } else {
      add("Float64", "weights", 2, 2 * word * rows);
    }
    add("Int64", "further_normals_end", 1, word * rows);
    if (!layout_.cover_bits) return;
    add("Float64", "witness", 3, 3 * word * rows);
    add("Int64", "cover_end", 1, word * rows);
  }

  void add_closest_points(std::uint64_t rows) {
    add("UInt8", "unique", 1, rows);
    for (const char* const name : {"closest_lo", "closest_hi", "normal_lo", "normal_hi", "normal"}) {
      add("Float64", name, 3, 3 * word * rows);
    }
    add("Int32", "primitive", 1, sizeof(std::int32_t) * rows);
  }

  /// An array of `bytes`. Those of a piece have as many tuples as it has points or cells; others state their `length`.
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

}  // namespace verisq
