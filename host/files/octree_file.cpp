/// Collects the cubes of an octree, and writes them once they are all there.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/octree_file.hpp>

#include "host/files/octree_layout.hpp"
#include "host/files/output_file.hpp"

namespace verisq {
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

OctreeWriter::OctreeWriter(const std::filesystem::path& file, WhiteCubes white)
    : state_(std::make_unique<State>(file, white)) {}
OctreeWriter::~OctreeWriter() = default;
OctreeWriter::OctreeWriter(OctreeWriter&&) noexcept = default;
OctreeWriter& OctreeWriter::operator=(OctreeWriter&&) noexcept = default;

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
