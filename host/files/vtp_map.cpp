/// Maps as VTK XML PolyData with appended raw arrays: what ParaView opens.
#include <fmt/format.h>

#include <array>
#include <numeric>
#include <optional>
#include <string>

#include "host/files/certificate_columns.hpp"
#include "host/files/collected_map.hpp"
#include "host/files/map_format.hpp"

namespace verisq {
namespace {

/// The DataArray elements of the XML part, in the order in which the arrays are written. Each refers to the appended
/// part by an offset; there the array's bytes follow their number, a UInt64 ("VTK File Formats", XML, appended raw).
class ArrayDeclarations {
 public:
  /// An array of a piece: as many tuples as the piece has points or cells.
  std::string declare(std::string_view type, std::string_view name, int components, std::uint64_t bytes) {
    return element(type, name, components, "", bytes);
  }
  /// An array of the FieldData: it must say its length itself, or readers take it for empty (vtkXMLReader).
  std::string declare_field(std::string_view type, std::string_view name, int components, std::uint64_t tuples,
                            std::uint64_t bytes) {
    return element(type, name, components, fmt::format(" NumberOfTuples=\"{}\"", tuples), bytes);
  }

 private:
  std::string element(std::string_view type, std::string_view name, int components, std::string_view length,
                      std::uint64_t bytes) {
    const std::uint64_t offset = next_offset_;
    next_offset_ += sizeof(std::uint64_t) + bytes;
    return fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n",
        type, name, components, length, offset);
  }

  std::uint64_t next_offset_ = 0;
};

class VtpMap final : public MapFormat {
 public:
  VtpMap(OutputFile& output, const MapKind& kind) : output_(output), map_(kind) {
    if (kind.contents == MapContents::certified) certificates_.emplace().elements = kind.elements;
  }

  void append(std::span<const Point> points, std::span<const MapResult> results,
              std::span<const Certificate> certificates) override {
    map_.append(points, results);
    if (!certificates_) return;
    for (const Certificate& certificate : certificates) certificates_->append(certificate);
  }

  // Infinite ends are written as IEEE infinities: ParaView then wants a colour range set by hand, or dist_mid.
  void finish() override {
    map_.check_complete(output_);
    write_declarations();
    output_.write("  <AppendedData encoding=\"raw\">\n_");
    if (certificates_) write_further_normals(*certificates_);
    write_vectors(map_.vertices());
    write_cells();
    write_array(map_.lo());
    write_array(map_.hi());
    write_middles();
    write_array(map_.statuses());
    if (certificates_) write_certificates(*certificates_);
    output_.write("\n  </AppendedData>\n</VTKFile>\n");
  }

 private:
  [[nodiscard]] std::uint64_t points() const { return map_.vertices().size(); }
  [[nodiscard]] std::uint64_t rows() const { return map_.statuses().size(); }
  [[nodiscard]] bool has_triangles() const {
    return map_.elements() == MapElements::triangles || !map_.triangles().empty();
  }
  /// Triangles, or a vertex cell for each point: points without cells are invisible.
  [[nodiscard]] std::uint64_t cells() const { return has_triangles() ? map_.triangles().size() : points(); }
  [[nodiscard]] std::uint64_t corners() const { return has_triangles() ? 3 : 1; }

  void write_declarations() {
    const char* const cell_type = has_triangles() ? "Polys" : "Verts";
    const char* const data = map_.elements() == MapElements::vertices ? "PointData" : "CellData";
    ArrayDeclarations arrays;
    output_.write(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "  <PolyData>\n");
    if (certificates_) write_further_normals_declarations(*certificates_, arrays);
    output_.write(
        fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" "
                    "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
                    points(), has_triangles() ? 0 : cells(), has_triangles() ? cells() : 0));
    output_.write("      <Points>\n");
    output_.write(arrays.declare("Float64", "Points", 3, 3 * word * points()));
    output_.write(fmt::format("      </Points>\n      <{}>\n", cell_type));
    output_.write(arrays.declare("Int64", "connectivity", 1, word * corners() * cells()));
    output_.write(arrays.declare("Int64", "offsets", 1, word * cells()));
    output_.write(fmt::format("      </{}>\n      <{} Scalars=\"dist_mid\"{}>\n", cell_type, data,
                              certificates_ ? " Vectors=\"normal\"" : ""));
    output_.write(arrays.declare("Float64", "dist_lo", 1, word * rows()));
    output_.write(arrays.declare("Float64", "dist_hi", 1, word * rows()));
    output_.write(arrays.declare("Float64", "dist_mid", 1, word * rows()));
    output_.write(arrays.declare("UInt8", "status", 1, rows()));
    if (certificates_) write_certificates_declarations(arrays);
    output_.write(fmt::format("      </{}>\n", data));
    output_.write("    </Piece>\n  </PolyData>\n");
  }

  void write_further_normals_declarations(const CertificateColumns& columns, ArrayDeclarations& arrays) {
    const std::uint64_t count = columns.further_primitive.size();
    output_.write("    <FieldData>\n");
    output_.write(arrays.declare_field("Int32", "further_primitive", 1, count, sizeof(std::int32_t) * count));
    output_.write(arrays.declare_field("Float64", "further_normal", 3, count, 3 * word * count));
    output_.write("    </FieldData>\n");
  }

  void write_certificates_declarations(ArrayDeclarations& arrays) {
    output_.write(arrays.declare("Int32", "primitive", 1, sizeof(std::int32_t) * rows()));
    output_.write(arrays.declare("Float64", "normal", 3, 3 * word * rows()));
    if (map_.elements() == MapElements::vertices) {
      output_.write(arrays.declare("Float64", "escape", 3, 3 * word * rows()));
    } else {
      output_.write(arrays.declare("Float64", "weights", 2, 2 * word * rows()));
    }
    output_.write(arrays.declare("Int64", "further_normals_end", 1, word * rows()));
  }

  void write_further_normals(const CertificateColumns& columns) {
    write_array<std::int32_t>(columns.further_primitive);
    write_vectors(columns.further_normal);
  }

  void write_certificates(const CertificateColumns& columns) {
    write_array<std::int32_t>(columns.primitive);
    write_vectors(columns.normal);
    if (map_.elements() == MapElements::vertices) {
      write_vectors(columns.escape);
    } else {
      write_tuples<2>(columns.weights);
    }
    write_array<std::int64_t>(columns.further_normals_end);
  }

  template <class Number>
  void write_array(std::span<const Number> numbers) {
    write_number<std::uint64_t>(numbers.size_bytes());
    output_.write_little_endian(numbers);
  }

  template <class Number>
  void write_number(Number number) {
    output_.write_little_endian(std::span<const Number>(&number, 1));
  }

  void write_vectors(std::span<const Point> vectors) { write_tuples(vectors); }

  template <std::size_t N>
  void write_tuples(std::span<const std::array<double, N>> tuples) {
    write_number<std::uint64_t>(tuples.size_bytes());
    for (const auto& tuple : tuples) output_.write_little_endian<double>(tuple);
  }

  void write_cells() {
    write_number<std::uint64_t>(sizeof(std::int64_t) * corners() * cells());
    if (has_triangles()) {
      for (const auto& triangle : map_.triangles()) {
        output_.write_little_endian<std::int64_t>(std::array<std::int64_t, 3>{triangle[0], triangle[1], triangle[2]});
      }
    } else {
      for (std::uint64_t k = 0; k < cells(); ++k) write_number(static_cast<std::int64_t>(k));
    }
    write_number<std::uint64_t>(sizeof(std::int64_t) * cells());
    for (std::uint64_t k = 1; k <= cells(); ++k) write_number(static_cast<std::int64_t>(corners() * k));
  }

  void write_middles() {
    write_number<std::uint64_t>(map_.lo().size_bytes());
    for (std::size_t k = 0; k < map_.lo().size(); ++k) write_number(finite_middle(map_.lo()[k], map_.hi()[k]));
  }

  static constexpr std::uint64_t word = 8;  // bytes of a Float64 or an Int64

  OutputFile& output_;
  CollectedMap map_;
  std::optional<CertificateColumns> certificates_;
};

}  // namespace

std::unique_ptr<MapFormat> make_vtp_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<VtpMap>(output, kind);
}

}  // namespace verisq
