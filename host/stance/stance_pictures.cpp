/// This file implements the pictures and tables of stance_results.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "host/stance/stance_results.hpp"
#include "verify/stance/rnea.hpp"

namespace verisq::stance {
namespace {

/// "pelvis tx" as a word of a header: without commas of its own, and without a sign that makes it a formula in a
/// spreadsheet.
std::string column_name(const std::string& name, const char* quantity) {
  std::string word = name + "_" + quantity;
  std::ranges::replace_if(
      word, [](char c) { return std::string_view(" ,\"").find(c) != std::string_view::npos; }, '_');
  return std::string_view("=+-@").find(word.front()) == std::string_view::npos ? word : "_" + word;
}

void add_enclosures(std::string& row, const std::vector<Enclosure>& enclosures) {
  for (const Enclosure& e : enclosures) fmt::format_to(std::back_inserter(row), ",{},{}", e.lo, e.hi);
}

using PlottedQuantity = std::function<Enclosure(const MotionSlab&)>;

struct Panel {
  std::string title;
  PlottedQuantity of;
};

constexpr double width = 900.0;
constexpr double panel_height = 130.0;
constexpr double left = 90.0;
constexpr double gap = 40.0;

/// The values that a panel shows.
struct ShownRange {
  Enclosure shown;
  Enclosure all;  ///< the hull of all enclosures

  [[nodiscard]] bool is_cut() const { return all.lo < shown.lo || all.hi > shown.hi; }
};

/// If a motion opens, its last enclosures grow beyond all measure and would flatten the curve before them. The tightest
/// enclosures of nine tenths of the time set the scale; an end that is more than 20 times their span away is cut off.
/// `report/stance/chart.js` does the same.
ShownRange shown_range(const Motion& motion, const PlottedQuantity& of) {
  constexpr double share_of_time = 0.9;
  constexpr double farthest = 20.0;
  const auto hull_with = [](const Enclosure& a, const Enclosure& b) {
    return Enclosure{std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
  };
  std::vector<MotionSlab> slabs = motion.slabs;
  std::erase_if(slabs, [&](const MotionSlab& slab) { return !std::isfinite(of(slab).width()); });
  if (slabs.empty()) return {{-1.0, 1.0}, {-infinity, infinity}};
  std::ranges::sort(slabs, {}, [&](const MotionSlab& slab) { return of(slab).width(); });
  Enclosure tight = of(slabs.front());
  Enclosure all = tight;
  double time = 0.0;
  for (const MotionSlab& slab : slabs) {
    if (time < share_of_time * motion.reached) tight = hull_with(tight, of(slab));
    all = hull_with(all, of(slab));
    time += slab.to - slab.from;
  }
  const double span = tight.width();
  return {{all.lo < tight.lo - farthest * span ? tight.lo - span : all.lo,
           all.hi > tight.hi + farthest * span ? tight.hi + span : all.hi},
          all};
}

/// One quantity's tube, as the union of the slabs' boxes.
std::string panel_text(const Motion& motion, const Panel& panel, double top) {
  const ShownRange range = shown_range(motion, panel.of);
  const double lowest = range.shown.lo;
  const double highest = range.shown.hi;
  const double margin = std::max(0.05 * (highest - lowest), 1e-9 + 1e-6 * std::fabs(highest));
  const double bottom_value = lowest - margin;
  const double scale = panel_height / (highest + margin - bottom_value);
  const auto y = [&](double value) {
    return top + panel_height - scale * (std::clamp(value, bottom_value, highest + margin) - bottom_value);
  };
  const std::string title = range.is_cut() ? fmt::format("{} (cut off: the enclosures reach about [{:.3g}, {:.3g}])",
                                                         panel.title, range.all.lo, range.all.hi)
                                           : panel.title;
  const auto x = [&](double time) { return left + (width - left) * time / motion.reached; };
  std::string text = fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"bold\">{}</text>\n"
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#999\"/>\n",
      left, top - 6.0, svg_text(title), left, top, width - left, panel_height);
  for (const double value : {lowest, highest}) {
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.4g}</text>\n", left - 6.0,
                        y(value) + 4.0, value);
  }
  std::string above;
  std::vector<std::string> below;
  for (const MotionSlab& slab : motion.slabs) {
    const Enclosure e = panel.of(slab);
    above += fmt::format("{:.3f},{:.3f} {:.3f},{:.3f} ", x(slab.from), y(e.hi), x(slab.to), y(e.hi));
    below.push_back(fmt::format("{:.3f},{:.3f} {:.3f},{:.3f}", x(slab.to), y(e.lo), x(slab.from), y(e.lo)));
  }
  // A line of its own colour keeps a tube visible that is thinner than a pixel.
  return text + fmt::format("<polygon points=\"{}{}\" fill=\"#9ecae1\" stroke=\"#3182bd\" stroke-width=\"0.8\"/>\n",
                            above, fmt::join(below.rbegin(), below.rend(), " "));  // back along the lower ends
}

}  // namespace

std::string motion_table(const Motion& motion) {
  std::string text = "from,to";
  const auto add_names = [&](const std::vector<std::string>& names, const char* quantity) {
    for (const std::string& name : names) text += fmt::format(",{0}_lo,{0}_hi", column_name(name, quantity));
  };
  add_names(motion.joints, "position");
  add_names(motion.joints, "velocity");
  add_names(motion.contacts, "normal_force");
  add_names(motion.contacts, "friction");
  text += "\n";
  for (const MotionSlab& slab : motion.slabs) {
    std::string row = fmt::format("{},{}", slab.from, slab.to);
    add_enclosures(row, slab.positions);
    add_enclosures(row, slab.velocities);
    std::vector<Enclosure> normal;
    std::vector<Enclosure> friction;
    for (const MotionContact& contact : slab.contacts) {
      normal.push_back(contact.normal);
      friction.push_back(contact.friction);
    }
    add_enclosures(row, normal);
    add_enclosures(row, friction);
    text += row + "\n";
  }
  return text;
}

std::string motion_picture(const Motion& motion) {
  std::vector<Panel> panels;
  for (std::size_t j = 0; j < 3; ++j) {
    const char* unit = j < 2 ? "m" : "rad";
    panels.push_back(
        {fmt::format("{}, {}", motion.joints[j], unit), [j](const MotionSlab& slab) { return slab.positions[j]; }});
  }
  for (std::size_t c = 0; c < motion.contacts.size(); ++c) {
    panels.push_back({fmt::format("normal force on each {}, N", motion.contacts[c]),
                      [c](const MotionSlab& slab) { return slab.contacts[c].normal; }});
  }
  const double height = gap + (panel_height + gap) * static_cast<double>(panels.size()) + 30.0;
  std::string text;
  double top = gap;
  for (const Panel& panel : panels) {
    if (!motion.slabs.empty()) text += panel_text(motion, panel, top);
    top += panel_height + gap;
  }
  text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">0 to {:.6g} s: proven enclosures{}</text>\n", left, top - 10.0,
                      motion.reached, motion.proven ? "" : "; from there on OPEN");
  return svg_document(width + 20.0, height, text);
}

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

/// A map from a parameter's range, which the cells fill, to pixels.
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

namespace {

using verify::Interval;

SidePoint side_point(const Vector3<Interval>& point) {
  return {{point[0].lower(), point[0].upper()}, {point[1].lower(), point[1].upper()}};
}

}  // namespace

SideView side_view(const Model& model, UncertainSet uncertain, std::span<const Enclosure> positions) {
  const std::vector<Interval> parameters = parameter_box(model, uncertain);
  const auto in_body = [&](const QuantityVector& point) {
    return values_of(point, std::span<const Interval>(parameters));
  };
  std::vector<Interval> joints;
  for (const Enclosure& position : positions) joints.emplace_back(position.lo, position.hi);
  const Tree<Interval> tree = tree_of(model, std::span<const Interval>(parameters), joints);
  const std::vector<BodyPose<Interval>> poses = forward_kinematics(tree);
  SideView view;
  for (const BodyPose<Interval>& pose : poses) view.origins.push_back(side_point(pose.position));
  for (const ContactCylinder& cylinder : model.cylinders)
    view.cylinders.push_back(side_point(poses[cylinder.body].point(in_body(cylinder.centre))));
  view.trunk = side_point(poses.front().point(in_body(model.bodies.front().centre_of_mass)));
  return view;
}

std::vector<Enclosure> all_positions(const SagittalModel& sagittal, std::span<const Enclosure> positions) {
  std::vector<Enclosure> all;
  for (const Body& body : sagittal.model.bodies) {
    for (const Joint& joint : body.joints) all.push_back({joint.position, joint.position});
  }
  for (std::size_t k = 0; k < positions.size(); ++k) {
    for (const std::size_t joint : sagittal.joints[k].joints) all[joint] = positions[k];
  }
  return all;
}

}  // namespace verisq::stance
