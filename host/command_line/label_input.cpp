/// Which label, in which space.
#include "host/command_line/label_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

/// "1 (250 voxels), 2 (17 voxels)".
std::string listed(const std::vector<LabelCount>& labels) {
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t k = 0; k < std::min(labels.size(), most); ++k)
    text += fmt::format("{}{} ({} voxels)", k == 0 ? "" : ", ", labels[k].label, labels[k].voxels);
  if (labels.size() > most) text += fmt::format(" and {} more", labels.size() - most);
  return text;
}

std::uint16_t chosen(const std::string& volume, const std::vector<LabelCount>& labels,
                     std::optional<std::uint16_t> label) {
  if (labels.empty()) refuse(fmt::format("{}: all of its voxels are 0, the background", volume));
  if (!label && labels.size() == 1) return labels.front().label;
  if (!label) refuse(fmt::format("{}: give --label, one of {}", volume, listed(labels)));
  if (std::ranges::find(labels, *label, &LabelCount::label) == labels.end())
    refuse(fmt::format("--label: {} has no label {}, but {}", volume, *label, listed(labels)));
  return *label;
}

}  // namespace

LabelInput read_label(const std::string& name, std::optional<std::uint16_t> label,
                      std::optional<AnatomicalSpace> space) {
  LabelVolume volume = read_label_volume(name);
  const std::uint16_t one = chosen(name, labels_of(volume), label);
  if (space && volume.space == AnatomicalSpace::unknown)
    refuse(fmt::format("--space: {} does not say in which space its coordinates are", name));
  if (space) volume = in_space(std::move(volume), *space);
  Point lengths{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    lengths[axis] = std::hypot(volume.steps[axis][0], volume.steps[axis][1], volume.steps[axis][2]);
  return {.label = one,
          .space = volume.space,
          .voxel_volume = voxel_volume(volume),
          .voxel_lengths = lengths,
          .surface = label_surface(volume, one)};
}

}  // namespace verisq::command_line
