/// The common inputs of `verisq` and `verisq-mpi`: parts of maps, ways of implants, models in one unit.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/insertion.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model.hpp>

#include "host/command_line/options.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

// Lengths of two models can be compared only in one unit.

/// The units of two models, exact or uncertain; empty if neither has any. Throws Error(input), naming the file of `b`,
/// if they differ.
template <class AnyModel>
[[nodiscard]] std::string common_units(const AnyModel& a, const AnyModel& b, const std::string& path_of_a,
                                       const std::string& path_of_b) {
  if (!a.units.empty() && !b.units.empty() && a.units != b.units)
    refuse(
        fmt::format("{}: units {} differ from {} of {}", path_of_b, quotation(b.units), quotation(a.units), path_of_a));
  return a.units.empty() ? b.units : a.units;
}

/// A mesh states no units. Asks on the standard error whether they are the model's, if one is fifty times as large as
/// the other: metres and millimetres differ by a thousand.
void tell_of_other_size(const Model& model, const std::string& path_of_model, std::span<const Point> vertices,
                        const std::string& path_of_mesh);

// The common inputs of `verisq insert` and `verisq-mpi insert`: an implant, a bone, the way into its seat, a tolerance.

/// As typed.
struct InsertionInputs {
  std::string implant;
  std::optional<Pose> pose;
  std::string mesh;
  std::optional<std::string> poses;  ///< a file, or instead of it:
  std::optional<Point> along;        ///< a direction, with
  std::optional<double> length;
  std::optional<double> turn;  ///< degrees about the direction, on the way
  std::optional<double> tolerance;
};

/// Adds --implant, --pose, --mesh, --poses, --along, --length, --turn and --tol.
void declare_inputs(Options& options, InsertionInputs& inputs);

/// Throws Error(input) where they contradict each other, or leave the way open.
void check_usage(const InsertionInputs& inputs);

/// Throws Error(input) if `output` is one of their files.
void refuse_to_overwrite(const std::string& output, const InsertionInputs& inputs);

/// Precondition: a direction.
[[nodiscard]] WayIn given_way(const InsertionInputs& inputs);

/// Throws Error(input) as `read_poses`.
[[nodiscard]] inline std::vector<Pose> path_of(const InsertionInputs& inputs, const Model& implant) {
  return inputs.poses ? read_poses(*inputs.poses) : verisq::path_of(given_way(inputs), turning_centre(implant));
}

/// The value of --tol, or its default.
[[nodiscard]] double tolerance_of(const InsertionInputs& inputs, const Model& implant);

// A part of a map: the option --part, its rows, and the record beside its file.

/// Part `part`, from 1 on, of `parts`.
struct PartOption {
  std::uint64_t part;
  std::uint64_t parts;
};

/// Adds --part.
void add_part(Options& options, std::optional<PartOption>& part);

/// The extension of a form that rows of parts have. Throws Error(input) for others, and for the standard output.
[[nodiscard]] std::string format_of_part(const std::string& output, const std::optional<std::string>& format);

/// The format of a drawn part, of points; it may also be `.vtp`.
[[nodiscard]] std::string format_of_drawn_part(const std::string& output, const std::optional<std::string>& format);

/// The number of elements that a stream (see PointStream) delivers. If the stream does not know it, it is read to its
/// end, and its position is unspecified afterwards.
template <class Stream>
[[nodiscard]] std::uint64_t count_elements(Stream& stream) {
  if (const std::optional<std::uint64_t> count = stream.count()) return *count;
  std::vector<typename Stream::Element> chunk(std::size_t{1} << 14U);
  std::uint64_t all = 0;
  while (const std::size_t count = stream.read(chunk)) all += count;
  return all;
}

/// All its numbers, bit for bit: for the settings of a part.
[[nodiscard]] std::string text_of(const PoseUncertainty& bounds);

/// The record beside the file of a part. The digests of models and input are computed while the map is made.
class PartRecord {
 public:
  /// `part` is complete but for digests, summaries and the version; `models` and `input` are files. Throws Error(input)
  /// for files that cannot be read again.
  PartRecord(MapPart part, const std::vector<std::string>& models, const std::string& input);

  /// Writes the record when the part's file is finished.
  void write(const std::string& output, const MapSummary& summary, const std::optional<ClosestPointSummary>& closest);

  [[nodiscard]] const RowRange& rows() const { return part_.rows; }

  /// The device that `--device` stands for: it is the same for the whole map; "auto" leaves few rows to the host.
  [[nodiscard]] std::string device_for(const std::string& requested) const {
    return requested == "auto" && part_.rows_in_all <= few_rows ? "host" : requested;
  }

 private:
  MapPart part_;
  std::vector<std::future<SubjectFile>> models_;
  std::future<SubjectFile> input_;
};

/// The elements of a stream that belong to a part, to which it moves; all elements without a part. Has the functions of
/// PointStream.
template <class Stream>
class PartStream {
 public:
  using Element = typename Stream::Element;

  /// `stream` must outlive this.
  PartStream(Stream& stream, const std::optional<PartRecord>& part) : stream_(stream) {
    if (!part) return;
    rows_ = part->rows();
    stream.go_to(rows_->first);
  }

  std::size_t read(std::span<Element> elements) {
    const std::uint64_t most = rows_ ? std::min<std::uint64_t>(elements.size(), rows_->count - read_) : elements.size();
    const std::size_t count = stream_.read(elements.first(static_cast<std::size_t>(most)));
    read_ += count;
    return count;
  }
  [[nodiscard]] double fraction(std::uint64_t done) const {
    if (!rows_) return stream_.fraction(done);
    return rows_->count == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(rows_->count);
  }

 private:
  Stream& stream_;
  std::optional<RowRange> rows_;
  std::uint64_t read_ = 0;
};

}  // namespace verisq::command_line
