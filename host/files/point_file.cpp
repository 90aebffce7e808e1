/// Points from text and from NumPy arrays, and poses from CSV: streamed.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/model.hpp>

#include "host/files/input_file.hpp"
#include "host/files/npy_header.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

/// Has the members of `PointFile`.
class PointSource {
 public:
  PointSource() = default;
  PointSource(const PointSource&) = delete;
  PointSource& operator=(const PointSource&) = delete;
  virtual ~PointSource() = default;

  virtual std::size_t read(std::span<Point> points) = 0;
  /// Returns whether `go_to` may be called.
  [[nodiscard]] virtual bool can_go_to() const { return false; }
  /// Continues at this point, which is at most the count. Precondition: `can_go_to`.
  virtual void go_to(std::uint64_t /*point*/) {}
  [[nodiscard]] virtual std::uint64_t bytes_read() const = 0;
  [[nodiscard]] virtual std::uint64_t bytes_total() const = 0;
  [[nodiscard]] virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
};

static_assert(sizeof(Point) == 3 * sizeof(double));

class TextPoints final : public PointSource {
 public:
  explicit TextPoints(InputFile file)
      : rows_(std::move(file), {.item = "point", .count = "three", .header = "x,y,z", .free = true}) {}

  std::size_t read(std::span<Point> points) override {
    return rows_.read({points.empty() ? nullptr : points.front().data(), 3 * points.size()}) / 3;
  }
  [[nodiscard]] std::uint64_t bytes_read() const override { return rows_.bytes_read(); }
  [[nodiscard]] std::uint64_t bytes_total() const override { return rows_.bytes_total(); }

 private:
  NumberRows rows_;
};

std::unique_ptr<PointSource> text_points(InputFile file) {
  return std::make_unique<TextPoints>(std::move(file));
}

constexpr std::array<std::string_view, 3> coordinate_names{"x", "y", "z"};

/// The form in which a coordinate is stored.
struct CoordinateType {
  std::endian order;
  std::size_t bytes;

  [[nodiscard]] double value(const char* at) const {
    return bytes == sizeof(double) ? number_from<double>(at, order) : number_from<float>(at, order);
  }
};

CoordinateType type_of(const InputFile& file, const NpyHeader& header) {
  const std::string_view descr = header.descr;
  const auto order = descr.starts_with('<') ? std::endian::little : std::endian::big;
  if (descr == "<f8" || descr == ">f8") return {order, sizeof(double)};
  if (descr == "<f4" || descr == ">f4") return {order, sizeof(float)};
  file.fail(fmt::format("descr = {}: expected float64 or float32: '<f8', '>f8', '<f4', '>f4'", in_quotes(descr)));
}

/// The number of points of the array; the rest of the file must contain as many, if its size is known.
std::uint64_t count_of(const InputFile& file, const NpyHeader& header, const CoordinateType& type) {
  const std::vector<std::uint64_t>& shape = header.shape;
  if (shape.size() != 2 || shape[1] != 3) {
    file.fail(fmt::format("shape = ({}): expected (N, 3)", fmt::join(shape, ", ")));
  }
  const std::uint64_t row = 3 * type.bytes;
  if (shape[0] == 0) file.fail_whole("no points");
  if (shape[0] > std::numeric_limits<std::int64_t>::max() / row) {
    file.fail(fmt::format("shape = ({}, 3): more than a file can hold", shape[0]));
  }
  if (file.size() == 0) return shape[0];
  const std::uint64_t bytes = row * shape[0];
  if (file.remaining() < bytes) {
    file.fail_whole(
        fmt::format("truncated: {} points are {} bytes, and {} follow the header", shape[0], bytes, file.remaining()));
  }
  if (file.remaining() > bytes) {
    file.fail_whole(
        fmt::format("byte {}: {} bytes after the last point", file.position() + bytes, file.remaining() - bytes));
  }
  return shape[0];
}

/// The numbers of one column, or of all columns in C order, front to back.
class Numbers {
 public:
  Numbers(InputFile file, CoordinateType type) : file_(std::move(file)), type_(type) {}

  /// Passes the next `count` numbers to `use(k, number)`; numbers that are not finite are refused. `first` is the
  /// index, of all coordinates in C order, of the first number; the next is `stride` further.
  template <class Use>
  void read(std::size_t count, std::uint64_t first, std::uint64_t stride, const Use& use) {
    const std::uint64_t start = file_.position();
    const char* const bytes = file_.take(count * type_.bytes, "the points").data();
    for (std::size_t k = 0; k < count; ++k) {
      const double number = type_.value(bytes + k * type_.bytes);
      if (!std::isfinite(number)) refuse(start + k * type_.bytes, first + k * stride, number);
      use(k, number);
    }
  }

  [[nodiscard]] const InputFile& file() const { return file_; }

  void go_to(std::uint64_t position) { file_.go_to(position); }

  void expect_end() {
    if (!file_.peek(1).empty()) {
      file_.fail_whole(fmt::format("byte {}: more bytes after the last point", file_.position()));
    }
  }

 private:
  [[noreturn]] void refuse(std::uint64_t byte, std::uint64_t index, double number) const {
    file_.fail_whole(fmt::format("byte {}: {} of point {} = {}: not a finite number", byte, coordinate_names[index % 3],
                                 index / 3, number));
  }

  InputFile file_;
  CoordinateType type_;
};

/// Points at a time: no more than fit into a block of the file.
constexpr std::size_t most_at_once = std::size_t{1} << 14;

class NpyPoints : public PointSource {
 public:
  NpyPoints(std::uint64_t count, std::uint64_t header_bytes, std::size_t row_bytes)
      : count_(count), header_bytes_(header_bytes), row_bytes_(row_bytes) {}

  std::size_t read(std::span<Point> points) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(points.size(), count_ - read_));
    for (std::size_t done = 0; done < count;) {
      const std::size_t part = std::min(count - done, most_at_once);
      read_part(points.subspan(done, part));
      done += part;
      read_ += part;
    }
    if (read_ == count_ && !ended_) {
      ended_ = true;
      expect_end();
    }
    return count;
  }

  [[nodiscard]] std::uint64_t bytes_read() const override {
    return read_ == 0 ? 0 : header_bytes_ + read_ * row_bytes_;
  }
  [[nodiscard]] std::optional<std::uint64_t> count() const override { return count_; }

  void go_to(std::uint64_t point) override {
    read_ = std::min(point, count_);
    go_to_point();
    ended_ = read_ == count_;  // what follows the last point was looked at when the size of the file was known
  }

 protected:
  [[nodiscard]] std::uint64_t points_read() const { return read_; }
  [[nodiscard]] std::uint64_t header_bytes() const { return header_bytes_; }

 private:
  virtual void go_to_point() = 0;
  virtual void read_part(std::span<Point> points) = 0;
  virtual void expect_end() = 0;

  std::uint64_t count_;
  std::uint64_t header_bytes_;
  std::size_t row_bytes_;
  std::uint64_t read_ = 0;
  bool ended_ = false;
};

class PointsInCOrder final : public NpyPoints {
 public:
  PointsInCOrder(InputFile file, CoordinateType type, std::uint64_t count)
      : NpyPoints(count, file.position(), 3 * type.bytes),
        row_bytes_(3 * type.bytes),
        numbers_(std::move(file), type) {}

  [[nodiscard]] std::uint64_t bytes_total() const override { return numbers_.file().size(); }
  [[nodiscard]] bool can_go_to() const override { return numbers_.file().size() > 0; }

 private:
  void go_to_point() override { numbers_.go_to(header_bytes() + points_read() * row_bytes_); }
  void read_part(std::span<Point> points) override {
    double* const target = points.front().data();  // of all coordinates: Point is three numbers, no more
    numbers_.read(3 * points.size(), 3 * points_read(), 1, [&](std::size_t k, double number) { target[k] = number; });
  }
  void expect_end() override { numbers_.expect_end(); }

  std::uint64_t row_bytes_;
  Numbers numbers_;
};

/// All x before all y before all z: read at three places side by side.
class PointsInFortranOrder final : public NpyPoints {
 public:
  PointsInFortranOrder(const InputFile& file, const std::filesystem::path& path, CoordinateType type,
                       std::uint64_t count)
      : NpyPoints(count, file.position(), 3 * type.bytes), column_bytes_(count * type.bytes), bytes_(type.bytes) {
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
      InputFile column(path);
      column.go_to(file.position() + axis * column_bytes_);
      columns_.emplace_back(std::move(column), type);
    }
  }

  [[nodiscard]] std::uint64_t bytes_total() const override { return columns_.front().file().size(); }
  [[nodiscard]] bool can_go_to() const override { return true; }

 private:
  void go_to_point() override {
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
      columns_[axis].go_to(header_bytes() + axis * column_bytes_ + points_read() * bytes_);
    }
  }
  void read_part(std::span<Point> points) override {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      columns_[axis].read(points.size(), 3 * points_read() + axis, 3,
                          [&](std::size_t k, double number) { points[k][axis] = number; });
    }
  }
  void expect_end() override { columns_.back().expect_end(); }

  std::uint64_t column_bytes_;
  std::uint64_t bytes_;
  std::vector<Numbers> columns_;
};

/// `path` is that of the file; empty for the standard input.
std::unique_ptr<PointSource> npy_points(InputFile file, const std::filesystem::path& path) {
  const NpyHeader header = read_npy_header(file);
  const CoordinateType type = type_of(file, header);
  const std::uint64_t count = count_of(file, header, type);
  if (!header.fortran_order) return std::make_unique<PointsInCOrder>(std::move(file), type, count);
  if (path.empty() || file.size() == 0) {
    file.fail_whole("fortran_order = True: not of a stream, which is read front to back; give a file, or C order");
  }
  return std::make_unique<PointsInFortranOrder>(file, path, type, count);
}

std::unique_ptr<PointSource> open_points(const std::filesystem::path& path) {
  const bool from_standard_input = path == "-";
  InputFile file = from_standard_input ? InputFile::standard_input() : InputFile(path);
  const bool is_array = lower_case(path.extension().string()) == ".npy" || file.peek(npy_magic.size()) == npy_magic;
  if (!is_array) return text_points(std::move(file));
  return npy_points(std::move(file), from_standard_input ? std::filesystem::path() : path);
}

}  // namespace

struct PointFile::State {
  std::filesystem::path path;
  std::unique_ptr<PointSource> source;
  std::uint64_t next = 0;  // point to be read
};

PointFile::PointFile(const std::filesystem::path& path) : state_(hidden<State>(State{path, open_points(path)})) {}

std::size_t PointFile::read(std::span<Point> points) {
  const std::size_t count = state_->source->read(points);
  state_->next += count;
  return count;
}

void PointFile::go_to(std::uint64_t point) {
  if (state_->source->can_go_to()) {
    state_->source->go_to(point);
    state_->next = point;
    return;
  }
  if (point < state_->next) {
    if (!std::filesystem::is_regular_file(state_->path)) refuse_file(state_->path.string(), "cannot be read again");
    *state_ = State{state_->path, open_points(state_->path)};
  }
  std::vector<Point> passed(std::size_t{1} << 14U);
  while (state_->next < point) {
    const std::uint64_t most = std::min<std::uint64_t>(passed.size(), point - state_->next);
    if (read(std::span(passed).first(static_cast<std::size_t>(most))) == 0) break;
  }
}

std::optional<std::uint64_t> PointFile::count() const {
  return state_->source->count();
}

std::uint64_t PointFile::bytes_read() const {
  return state_->source->bytes_read();
}
std::uint64_t PointFile::bytes_total() const {
  return state_->source->bytes_total();
}

struct PoseFile::State {
  std::filesystem::path path;
  NumberRows rows;
  std::uint64_t next = 0;  // pose to be read

  std::optional<Pose> next_pose();
};

std::optional<Pose> PoseFile::State::next_pose() {
  std::array<double, 7> numbers{};
  if (rows.read(numbers) == 0) return std::nullopt;
  const auto [tx, ty, tz, qw, qx, qy, qz] = numbers;
  // Also if the text is another number that rounds to zero: the nearest binary64 is the exact input.
  if (qw == 0.0 && qx == 0.0 && qy == 0.0 && qz == 0.0) rows.fail("quaternion = 0,0,0,0: must not be zero");
  return Pose{.translation = {tx, ty, tz}, .quaternion = {qw, qx, qy, qz}};
}

PoseFile::PoseFile(const std::filesystem::path& path)
    : state_(hidden<State>(
          State{path, {InputFile(path), {.item = "pose", .count = "seven", .header = "tx,ty,tz,qw,qx,qy,qz"}}})) {}

std::size_t PoseFile::read(std::span<Pose> poses) {
  std::size_t count = 0;
  while (count < poses.size()) {
    const std::optional<Pose> pose = state_->next_pose();
    if (!pose) break;
    poses[count++] = *pose;
  }
  state_->next += count;
  return count;
}

void PoseFile::go_to(std::uint64_t pose) {
  if (pose < state_->next) *this = PoseFile(state_->path);
  std::vector<Pose> passed(1024);
  while (state_->next < pose) {
    const std::uint64_t most = std::min<std::uint64_t>(passed.size(), pose - state_->next);
    if (read(std::span(passed).first(static_cast<std::size_t>(most))) == 0) break;
  }
}

std::uint64_t PoseFile::bytes_read() const {
  return state_->rows.bytes_read();
}
std::uint64_t PoseFile::bytes_total() const {
  return state_->rows.bytes_total();
}

std::vector<Pose> read_poses(const std::filesystem::path& path) {
  PoseFile file(path);
  std::vector<Pose> poses;
  std::vector<Pose> chunk(1024);
  while (const std::size_t count = file.read(chunk)) {
    poses.insert(poses.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return poses;
}

Mesh read_cloud(const std::filesystem::path& path) {
  if (is_mesh_name(path)) return {.vertices = read_mesh(path).vertices, .triangles = {}};
  PointFile file(path);
  Mesh cloud;
  std::array<Point, 4096> chunk{};
  for (std::size_t count = chunk.size(); count == chunk.size();) {
    count = file.read(chunk);
    cloud.vertices.insert(cloud.vertices.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return cloud;
}

}  // namespace verisq
