/// Files for ParaView: maps as VTK XML PolyData, octrees as VTK XML unstructured grids.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/octree.hpp>

#include "host/files/map_file.hpp"
#include "host/files/map_layout.hpp"
#include "host/files/octree_reader.hpp"
#include "host/files/output_file.hpp"

namespace verisq {
namespace {

Point lower_corner(const EnclosedPoint& box) {
  return {box[0].lo, box[1].lo, box[2].lo};
}

Point upper_corner(const EnclosedPoint& box) {
  return {box[0].hi, box[1].hi, box[2].hi};
}

/// A point to be drawn as a glyph; zero if nothing is known.
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

namespace {

/// Items of one kind, the next of which belongs at a known place of the file.
template <class Number>
class PlacedArray {
 public:
  /// `numbers` of them behind their length at `position`, which moves behind the array.
  PlacedArray(OutputFile& output, std::uint64_t& position, std::uint64_t numbers) : output_(&output) {
    const std::uint64_t bytes = sizeof(Number) * numbers;
    output.write_little_endian_at(position, std::span<const std::uint64_t>(&bytes, 1));
    next_ = position + sizeof bytes;
    position = next_ + bytes;
  }

  void append(std::span<const Number> numbers) {
    output_->write_little_endian_at(next_, numbers);
    next_ += numbers.size_bytes();
  }

 private:
  OutputFile* output_;
  std::uint64_t next_ = 0;
};

class StreamedVtpMap final : public MapFormat {
 public:
  StreamedVtpMap(OutputFile& output, const MapKind& kind)
      : output_(output),
        mesh_(*kind.mesh),
        layout_{kind.elements, mesh_.vertices.size(), mesh_.triangles.size(), {}},
        position_(write_declarations()),
        points_(output, position_, 3 * layout_.points),
        connectivity_(output, position_, layout_.corners() * layout_.cells()),
        offsets_(output, position_, layout_.cells()),
        lo_(output, position_, layout_.rows()),
        hi_(output, position_, layout_.rows()),
        middles_(output, position_, layout_.rows()),
        statuses_(output, position_, layout_.rows()) {
    output_.write_at(position_, vtp_end);
  }

  void append(const MapChunk& chunk) override {  // the points are those of the mesh
    rows_ += chunk.results.size();
    if (rows_ > layout_.rows()) return;  // there is no place for them, as `finish` says
    append_points(share_of(layout_.points));
    append_cells(share_of(layout_.cells()));
    append_results(chunk.results);
  }

  void finish() override {
    if (rows_ != layout_.rows()) {
      output_.fail(fmt::format("{} results for {} {}", rows_, layout_.rows(),
                               layout_.elements == MapElements::vertices ? "vertices" : "triangles"));
    }
    append_points(layout_.points);
    append_cells(layout_.cells());
  }

 private:
  /// Returns where they end.
  std::uint64_t write_declarations() {
    const std::string declarations = vtp_declarations(layout_);
    output_.write_at(0, declarations);
    return declarations.size();
  }

  /// The number of items, of `all`, to be written with the rows so far, so that no row has to wait for many of them.
  [[nodiscard]] std::uint64_t share_of(std::uint64_t all) const {
    const std::uint64_t a_row = all / std::max<std::uint64_t>(1, layout_.rows()) + 1;
    return std::min(all, rows_ * a_row);
  }

  void append_points(std::uint64_t end) {
    const std::span<const Point> points = std::span(mesh_.vertices).subspan(points_done_, end - points_done_);
    points_.append({reinterpret_cast<const double*>(points.data()), 3 * points.size()});
    points_done_ = end;
  }

  void append_cells(std::uint64_t end) {
    std::vector<std::int64_t> numbers;
    numbers.reserve(layout_.corners() * (end - cells_done_));
    for (std::uint64_t cell = cells_done_; cell < end; ++cell) {
      if (layout_.has_triangles()) {
        for (const std::uint32_t corner : mesh_.triangles[cell]) numbers.push_back(corner);
      } else {
        numbers.push_back(static_cast<std::int64_t>(cell));
      }
    }
    connectivity_.append(numbers);
    numbers.resize(end - cells_done_);
    const auto corners = static_cast<std::int64_t>(layout_.corners());
    for (std::uint64_t cell = cells_done_; cell < end; ++cell) {
      numbers[cell - cells_done_] = corners * static_cast<std::int64_t>(cell + 1);
    }
    offsets_.append(numbers);
    cells_done_ = end;
  }

  void append_results(std::span<const MapResult> results) {
    std::vector<double> numbers(results.size());
    const auto append = [&](PlacedArray<double>& array, const auto& number_of) {
      std::ranges::transform(results, numbers.begin(), number_of);
      array.append(numbers);
    };
    append(lo_, [](const MapResult& result) { return result.distance.lo; });
    append(hi_, [](const MapResult& result) { return result.distance.hi; });
    append(middles_, [](const MapResult& result) { return finite_middle(result.distance.lo, result.distance.hi); });
    std::vector<std::uint8_t> statuses(results.size());
    std::ranges::transform(results, statuses.begin(),
                           [](const MapResult& result) { return static_cast<std::uint8_t>(result.status); });
    statuses_.append(statuses);
  }

  OutputFile& output_;
  const Mesh& mesh_;
  VtpLayout layout_;
  std::uint64_t position_;  // behind what is placed
  PlacedArray<double> points_;
  PlacedArray<std::int64_t> connectivity_;
  PlacedArray<std::int64_t> offsets_;
  PlacedArray<double> lo_;
  PlacedArray<double> hi_;
  PlacedArray<double> middles_;
  PlacedArray<std::uint8_t> statuses_;
  std::uint64_t rows_ = 0;
  std::uint64_t points_done_ = 0;
  std::uint64_t cells_done_ = 0;
};

}  // namespace

std::unique_ptr<MapFormat> make_streamed_vtp_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<StreamedVtpMap>(output, kind);
}

namespace {

std::filesystem::path with_known_extension(const std::filesystem::path& file) {
  if (file.extension() != ".vtu")
    throw Error(ErrorKind::input, fmt::format("{}: octrees are written as .vtu", file.string()));
  return file;
}

}  // namespace

struct OctreeWriter::State {
  State(const std::filesystem::path& file, WhiteCubes written_white)
      : output(with_known_extension(file)), white(written_white) {}

  const OctreeLayout& finished_layout() {
    if (!layout) layout.emplace(cubes);
    return *layout;
  }

  OutputFile output;
  WhiteCubes white;
  std::vector<OctreeCube> cubes;
  std::optional<OctreeLayout> layout;  // once no cubes are appended any more
};

OctreeWriter::OctreeWriter(const std::filesystem::path& file, WhiteCubes white) : state_(hidden<State>(file, white)) {}

void OctreeWriter::append(std::span<const OctreeCube> cubes) {
  state_->layout.reset();
  std::ranges::copy_if(cubes, std::back_inserter(state_->cubes), [&](const OctreeCube& cube) {
    return state_->white == WhiteCubes::written || cube.colour != CubeColour::white;
  });
}

std::uint64_t OctreeWriter::bytes() {
  return state_->finished_layout().bytes();
}

void OctreeWriter::finish(const OctreeRoot& root) {
  state_->finished_layout().write([this](std::string_view bytes) { state_->output.write(bytes); }, root);
  state_->output.finish();
}

}  // namespace verisq
