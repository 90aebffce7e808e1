/// Maps as VTK XML PolyData with appended raw arrays: what ParaView opens. Those of a mesh without certificates are
/// streamed (streamed_vtp_map.cpp), the others are kept in memory.
#include <algorithm>
#include <array>
#include <concepts>
#include <optional>
#include <vector>

#include "host/files/certificate_columns.hpp"
#include "host/files/collected_map.hpp"
#include "host/files/finite_middle.hpp"
#include "host/files/map_columns.hpp"
#include "host/files/map_format.hpp"
#include "host/files/vtp_layout.hpp"

namespace verisq {
namespace {

Point lower_corner(const EnclosedPoint& box) {
  return {box[0].lo, box[1].lo, box[2].lo};
}

Point upper_corner(const EnclosedPoint& box) {
  return {box[0].hi, box[1].hi, box[2].hi};
}

/// To be drawn as a glyph; zero where nothing is known.
Point middle(const EnclosedPoint& box) {
  return {finite_middle(box[0].lo, box[0].hi), finite_middle(box[1].lo, box[1].hi),
          finite_middle(box[2].lo, box[2].hi)};
}

class VtpMap final : public MapFormat {
 public:
  VtpMap(OutputFile& output, const MapKind& kind) : output_(output), map_(kind) {
    if (has_certificates(kind.contents)) certificates_.emplace().elements = kind.elements;
    if (kind.contents == MapContents::covered) certificates_->covered = true;
    if (kind.contents == MapContents::closest_points) closest_.emplace();
  }

  void append(const MapChunk& chunk) override {
    map_.append(chunk.points, chunk.results);
    if (closest_) closest_->insert(closest_->end(), chunk.closest.begin(), chunk.closest.end());
    if (!certificates_) return;
    for (const Certificate& certificate : chunk.certificates) certificates_->append(certificate);
  }

  // Infinite ends are written as IEEE infinities: ParaView then wants a colour range set by hand, or dist_mid.
  void finish() override {
    map_.check_complete(output_);
    output_.write(vtp_declarations(layout()));
    if (certificates_) write_further_normals(*certificates_);
    write_vectors(map_.vertices());
    write_cells();
    write_array(map_.lo());
    write_array(map_.hi());
    write_middles();
    write_array(map_.statuses());
    if (certificates_) write_certificates(*certificates_);
    if (closest_) write_closest_points(*closest_);
    output_.write(vtp_end);
  }

 private:
  [[nodiscard]] VtpLayout layout() const {
    VtpLayout layout{map_.elements(), map_.vertices().size(), map_.triangles().size(), {}};
    if (certificates_) layout.further_normals = certificates_->further_primitive.size();
    if (certificates_ && certificates_->covered) layout.cover_bits = certificates_->cover.size();
    layout.closest_points = closest_.has_value();
    return layout;
  }

  void write_further_normals(const CertificateColumns& columns) {
    write_array<std::int32_t>(columns.further_primitive);
    write_vectors(columns.further_normal);
    if (columns.covered) write_array<std::uint8_t>(columns.cover);
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
    if (!columns.covered) return;
    write_vectors(columns.witness);
    write_array<std::int64_t>(columns.cover_end);
  }

  void write_closest_points(const std::vector<ClosestPoint>& rows) {
    write_column<std::uint8_t>(rows, [](const ClosestPoint& row) { return static_cast<std::uint8_t>(row.unique); });
    write_column<Point>(rows, [](const ClosestPoint& row) { return lower_corner(row.point); });
    write_column<Point>(rows, [](const ClosestPoint& row) { return upper_corner(row.point); });
    write_column<Point>(rows, [](const ClosestPoint& row) { return lower_corner(row.normal); });
    write_column<Point>(rows, [](const ClosestPoint& row) { return upper_corner(row.normal); });
    write_column<Point>(rows, [](const ClosestPoint& row) { return middle(row.normal); });
    write_column<std::int32_t>(rows, primitive_in);
  }

  template <class Value, class Get>
  void write_column(const std::vector<ClosestPoint>& rows, const Get& get) {
    std::vector<Value> values(rows.size());
    std::ranges::transform(rows, values.begin(), get);
    if constexpr (std::same_as<Value, Point>) {
      write_vectors(values);
    } else {
      write_array(std::span<const Value>(values));
    }
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
    output_.write_little_endian(std::span(reinterpret_cast<const double*>(tuples.data()), N * tuples.size()));
  }

  void write_cells() {
    const std::uint64_t cells = layout().cells();
    const auto corners = static_cast<std::int64_t>(layout().corners());
    write_number<std::uint64_t>(sizeof(std::int64_t) * layout().corners() * cells);
    if (layout().has_triangles()) {
      for (const auto& triangle : map_.triangles()) {
        output_.write_little_endian<std::int64_t>(std::array<std::int64_t, 3>{triangle[0], triangle[1], triangle[2]});
      }
    } else {
      for (std::uint64_t k = 0; k < cells; ++k) write_number(static_cast<std::int64_t>(k));
    }
    write_number<std::uint64_t>(sizeof(std::int64_t) * cells);
    for (std::uint64_t k = 1; k <= cells; ++k) write_number(corners * static_cast<std::int64_t>(k));
  }

  void write_middles() {
    write_number<std::uint64_t>(map_.lo().size_bytes());
    for (std::size_t k = 0; k < map_.lo().size(); ++k) write_number(finite_middle(map_.lo()[k], map_.hi()[k]));
  }

  OutputFile& output_;
  CollectedMap map_;
  std::optional<CertificateColumns> certificates_;
  std::optional<std::vector<ClosestPoint>> closest_;
};

}  // namespace

std::unique_ptr<MapFormat> make_vtp_map(OutputFile& output, const MapKind& kind) {
  const bool has_places = kind.mesh != nullptr && kind.contents == MapContents::enclosures;
  if (has_places && output.can_be_rewritten()) return make_streamed_vtp_map(output, kind);
  return std::make_unique<VtpMap>(output, kind);
}

}  // namespace verisq
