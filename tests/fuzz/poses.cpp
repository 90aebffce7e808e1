/// Fuzz target of PoseFile.
#include <algorithm>
#include <array>
#include <cmath>
#include <verisq/files.hpp>

#include "tests/fuzz/memory_file.hpp"
#include "tests/fuzz/promise.hpp"

namespace verisq::fuzz {
namespace {

void check_pose(const Pose& pose) {
  for (const double coordinate : pose.translation) check(std::isfinite(coordinate), "translations are finite");
  for (const double component : pose.quaternion) check(std::isfinite(component), "quaternions are finite");
  check(std::ranges::any_of(pose.quaternion, [](double component) { return component != 0.0; }),
        "quaternions are not zero");
}

void read_to_the_end(PoseFile file) {
  std::array<Pose, 5> chunk{};  // small, so that chunks end inside the file
  std::size_t count = chunk.size();
  std::size_t total = 0;
  while (count == chunk.size()) {
    count = file.read(chunk);
    check(count <= chunk.size(), "no more poses are read than asked for");
    for (const Pose& pose : std::span(chunk).first(count)) check_pose(pose);
    total += count;
    check(file.bytes_read() <= file.bytes_total(), "no more bytes are read than the file has");
  }
  check(total > 0, "a file has poses");
  check(file.read(chunk) == 0, "nothing follows the end");
}

}  // namespace

void poses(Bytes bytes) {
  static const MemoryFile memory(".csv");
  memory.write(bytes);
  read_or_refuse(memory.path().string(), [] { read_to_the_end(PoseFile(memory.path())); });
}

}  // namespace verisq::fuzz
