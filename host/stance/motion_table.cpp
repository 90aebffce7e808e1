/// Writes the slabs of a motion: numbers between commas, or boxes in panels over a common axis of time.
#include "host/stance/motion_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "host/stance/svg_text.hpp"

namespace verisq::stance {
namespace {

/// "pelvis tx" as a word of a header.
std::string column_name(const std::string& name, const char* quantity) {
  std::string word = name + "_" + quantity;
  std::ranges::replace(word, ' ', '_');
  return word;
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

/// One quantity's tube, as the union of the slabs' boxes.
std::string panel_text(const Motion& motion, const Panel& panel, double top) {
  double lowest = infinity;
  double highest = -infinity;
  for (const MotionSlab& slab : motion.slabs) {
    lowest = std::min(lowest, panel.of(slab).lo);
    highest = std::max(highest, panel.of(slab).hi);
  }
  const double margin = std::max(0.05 * (highest - lowest), 1e-9 + 1e-6 * std::fabs(highest));
  const double bottom_value = lowest - margin;
  const double scale = panel_height / (highest + margin - bottom_value);
  const auto y = [&](double value) { return top + panel_height - scale * (value - bottom_value); };
  const auto x = [&](double time) { return left + (width - left) * time / motion.reached; };
  std::string text = fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"bold\">{}</text>\n"
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#999\"/>\n",
      left, top - 6.0, svg_text(panel.title), left, top, width - left, panel_height);
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

}  // namespace verisq::stance
