/// Maps of a mesh as VTK XML PolyData, streamed: how many rows and cells there will be is known before the first, and
/// so is where in the file each of them belongs. The bytes are those of vtp_map.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "host/files/finite_middle.hpp"
#include "host/files/map_format.hpp"
#include "host/files/vtp_layout.hpp"

namespace verisq {
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

  /// How many of `all` are to be written with the rows so far, so that no row has to wait for many of them.
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

}  // namespace verisq
