/// Draws cells as rectangles, coloured by what is proven of them.
#include "host/stance/parameter_map.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/stance/svg_text.hpp"

namespace verisq::stance {
namespace {

constexpr double map_side = 480.0;
constexpr double map_left = 90.0;
constexpr double map_top = 30.0;

struct Meaning {
  const char* colour;
  const char* words;
};

constexpr const char* good = "#74c476";
constexpr const char* bad = "#fb6a4a";
constexpr Meaning unknown{"#d9d9d9", "open"};

Meaning meaning(StandingVerdict verdict) {
  switch (verdict) {
    case StandingVerdict::stands: return {good, "proven: in equilibrium on all cylinders"};
    case StandingVerdict::not_on_all: return {bad, "proven: no equilibrium on all cylinders near by"};
    case StandingVerdict::open: break;
  }
  return unknown;
}

Meaning meaning(StabilityVerdict verdict) {
  switch (verdict) {
    case StabilityVerdict::stable: return {good, "proven: small disturbances die out"};
    case StabilityVerdict::unstable: return {bad, "proven: some disturbances grow"};
    case StabilityVerdict::open: break;
  }
  return unknown;
}

/// From a parameter's range, which the cells fill, to pixels.
struct Axis {
  Enclosure range;

  [[nodiscard]] double place(double value) const {
    return range.hi > range.lo ? map_side * (value - range.lo) / (range.hi - range.lo) : 0.0;
  }
};

template <class Cells>
Axis axis_of(const Cells& cells, std::size_t k) {
  Axis axis{cells.front().ranges[k]};
  for (const auto& cell : cells)
    axis.range = {std::min(axis.range.lo, cell.ranges[k].lo), std::max(axis.range.hi, cell.ranges[k].hi)};
  return axis;
}

template <class Cells>
std::string rectangles(const Cells& cells, const Axis& across, const Axis& upward) {
  std::string text;
  for (const auto& cell : cells) {
    const double x = across.place(cell.ranges[0].lo);
    const double y = upward.place(cell.ranges[1].hi);
    text += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\" stroke=\"white\" "
        "stroke-width=\"0.3\"/>\n",
        map_left + x, map_top + map_side - y, across.place(cell.ranges[0].hi) - x, y - upward.place(cell.ranges[1].lo),
        meaning(cell.verdict).colour);
  }
  return text;
}

std::string label(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, svg_text(words));
}

std::string axis_labels(const Axis& across, const Axis& upward, const std::array<Parameter, 2>& axes) {
  const auto name = [](const Parameter& parameter) {
    return parameter.unit.empty() ? parameter.name : parameter.name + ", " + parameter.unit;
  };
  const double bottom = map_top + map_side;
  return label(map_left, bottom + 18.0, "start", fmt::format("{:.6g}", across.range.lo)) +
         label(map_left + map_side, bottom + 18.0, "end", fmt::format("{:.6g}", across.range.hi)) +
         label(map_left + 0.5 * map_side, bottom + 18.0, "middle", name(axes[0])) +
         label(map_left - 6.0, bottom, "end", fmt::format("{:.6g}", upward.range.lo)) +
         label(map_left - 6.0, map_top + 10.0, "end", fmt::format("{:.6g}", upward.range.hi)) +
         label(map_left - 6.0, map_top + 0.5 * map_side, "end", name(axes[1]));
}

template <class Verdict>
std::string legend(const std::array<Verdict, 3>& verdicts) {
  std::string text;
  double y = map_top + map_side + 40.0;
  for (const Verdict verdict : verdicts) {
    text += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"14\" fill=\"{}\"/>\n", map_left, y,
                        meaning(verdict).colour);
    text += label(map_left + 22.0, y + 12.0, "start", meaning(verdict).words);
    y += 20.0;
  }
  return text;
}

template <class Cells, class Verdict>
std::string map_of(const Cells& cells, const std::array<Parameter, 2>& axes, const std::array<Verdict, 3>& verdicts) {
  const Axis across = axis_of(cells, 0);
  const Axis upward = axis_of(cells, 1);
  return svg_document(map_left + map_side + 30.0, map_top + map_side + 110.0,
                      rectangles(cells, across, upward) + axis_labels(across, upward, axes) + legend(verdicts));
}

}  // namespace

std::string parameter_map(std::span<const EquilibriumCell> cells, const std::array<Parameter, 2>& axes) {
  return map_of(cells, axes, std::array{StandingVerdict::stands, StandingVerdict::not_on_all, StandingVerdict::open});
}

std::string parameter_map(std::span<const StabilityCell> cells, const std::array<Parameter, 2>& axes) {
  return map_of(cells, axes, std::array{StabilityVerdict::stable, StabilityVerdict::unstable, StabilityVerdict::open});
}

}  // namespace verisq::stance
