/// Streams poses from CSV.
#include <algorithm>
#include <array>
#include <optional>
#include <verisq/pose_file.hpp>

#include "host/files/number_rows.hpp"

namespace verisq {

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
  // Also where the text is another number that rounds to zero: the nearest binary64 is the exact input.
  if (qw == 0.0 && qx == 0.0 && qy == 0.0 && qz == 0.0) rows.fail("quaternion = 0,0,0,0: must not be zero");
  return Pose{.translation = {tx, ty, tz}, .quaternion = {qw, qx, qy, qz}};
}

PoseFile::PoseFile(const std::filesystem::path& path)
    : state_(new State{path, {InputFile(path), {.item = "pose", .count = "seven", .header = "tx,ty,tz,qw,qx,qy,qz"}}}) {
}
PoseFile::~PoseFile() = default;
PoseFile::PoseFile(PoseFile&&) noexcept = default;
PoseFile& PoseFile::operator=(PoseFile&&) noexcept = default;

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

}  // namespace verisq
