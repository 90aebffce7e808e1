/// The layout of a picture: title, two views of the bone, and beside them the colours' meaning and the summary.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>
#include <verisq/report.hpp>

#include "host/report/bone_panel.hpp"
#include "host/report/drawing.hpp"
#include "host/report/projection.hpp"
#include "host/report/seated_implant.hpp"

namespace verisq {
namespace {

using report::BoneShown;
using report::Colour;
using report::ColourScale;
using report::Drawing;

const Colour ink(0.10, 0.11, 0.13);
const Colour faint_ink(0.40, 0.42, 0.46);

/// In pixels. Sizes of letters and gaps are stated for the usual picture and grow with it.
struct Layout {
  double unit;  ///< 1 for 1600 x 1000
  double margin;
  int panel_width;
  int panel_height;
  int panel_top;
  double legend_left;
  double legend_width;

  explicit Layout(int width, int height)
      : unit(std::min(width / 1600.0, height / 1000.0)),
        margin(36.0 * unit),
        panel_width(std::max(1, static_cast<int>((width - 360.0 * unit - 4.0 * margin) / 2.0))),
        panel_height(std::max(1, static_cast<int>(height - 150.0 * unit))),
        panel_top(static_cast<int>(90.0 * unit)),
        legend_left(width - margin - 360.0 * unit),
        legend_width(360.0 * unit) {}

  [[nodiscard]] int panel_left(int panel) const { return static_cast<int>(margin + panel * (panel_width + margin)); }
};

/// In ranges of the scale: binary32 holds these whatever the units.
std::vector<float> values_of(std::span<const MapResult> rows, const ColourScale& scale) {
  constexpr double far = 64.0;  // well beyond the colours, near enough to interpolate by
  std::vector<float> values(rows.size());
  std::ranges::transform(rows, values.begin(), [&](const MapResult& row) {
    const double lo = row.distance.lo;
    return std::isfinite(lo) ? static_cast<float>(std::clamp(lo / scale.range(), -far, far))
                             : std::numeric_limits<float>::quiet_NaN();
  });
  return values;
}

void draw_bone(Drawing& drawing, const Report& report, const ColourScale& scale, const Layout& layout) {
  const Mesh implant = report::seated_surface(report);
  const report::View view = report::broad_view(report.bone, implant, report::upright(report.bone, implant, report.up));
  constexpr int side = report::samples_a_pixel_side;
  const auto raster = report::fitted(view, report.bone, implant, side * layout.panel_width, side * layout.panel_height,
                                     4.0 * side * layout.unit);
  const report::Scene scene{projected(report.bone, values_of(report.rows, scale), view, raster),
                            projected(implant, {}, view, raster)};
  const Drawing::Type type{18.0 * layout.unit, faint_ink};
  const auto draw = [&](int panel, BoneShown shown, const std::string& caption) {
    const int left = layout.panel_left(panel);
    draw_panel(
        scene, shown, scale, layout.panel_width, layout.panel_height,
        [&](int row, std::span<const Colour> colours) { drawing.set_row(left, layout.panel_top + row, colours); });
    drawing.write(left, layout.panel_top + layout.panel_height + 36.0 * layout.unit, layout.panel_width, caption, type);
  };
  draw(0, BoneShown::whole, fmt::format("whole; the {} shows through", report.solid_name));
  draw(1, BoneShown::cut, fmt::format("cut open by a plane through the {}", report.solid_name));
}

std::string number(double value) {
  return fmt::format("{:.4g}", value);
}

/// Returns the y below it.
double draw_colour_bar(Drawing& drawing, const Report& report, const ColourScale& scale, const Layout& layout) {
  const double unit = layout.unit;
  const Drawing::Type heading{20.0 * unit, ink, Drawing::Weight::bold};
  const Drawing::Type plain{18.0 * unit, ink};
  const Drawing::Type faint{16.0 * unit, faint_ink};
  double y = layout.panel_top + 18.0 * unit;
  drawing.write(layout.legend_left, y, layout.legend_width, "distance to the " + report.solid_name, heading);
  y += 26.0 * unit;
  if (!report.path.empty()) {
    drawing.write(layout.legend_left, y, layout.legend_width, "the smallest along its whole way;", faint);
    y += 22.0 * unit;
  }
  drawing.write(layout.legend_left, y, layout.legend_width,
                report.units.empty() ? "proven lower bound" : "proven lower bound, in " + report.units, faint);
  y += 26.0 * unit;

  const double width = 34.0 * unit;
  const double height = 320.0 * unit;
  const int steps = std::max(2, 2 * static_cast<int>(std::ceil(height / 2.0)));  // even: zero lies between two
  for (int k = 0; k < steps; ++k) {
    const double value = scale.range() * (1.0 - 2.0 * (k + 0.5) / steps);
    drawing.fill_rectangle(layout.legend_left, y + k * height / steps, width,
                           height / steps + (k + 1 < steps ? 1.0 : 0.0), scale.colour(value));
  }
  const double text_left = layout.legend_left + width + 16.0 * unit;
  const double text_width = layout.legend_width - width - 16.0 * unit;
  const std::vector<double> ticks = scale.ticks();
  for (const double tick : ticks) {
    const double place = y + height / 2.0 * (1.0 - tick / scale.range());
    drawing.fill_rectangle(layout.legend_left + width, place - unit, 8.0 * unit, 2.0 * unit, ink);
    const std::string meaning = tick == 0.0 ? fmt::format("  surface of the {}", report.solid_name) : "";
    drawing.write(text_left, place + 6.0 * unit, text_width, number(tick) + meaning, plain);
  }
  y += height + 30.0 * unit;
  const auto below = [&](const std::string& line) {
    drawing.write(layout.legend_left, y, layout.legend_width, line, faint);
    y += 22.0 * unit;
  };
  below(fmt::format("Warm: within the {}. The ends of the", report.solid_name));
  below("bar stand for all beyond. Proven at every");
  below("vertex, interpolated in between.");
  if (std::ranges::any_of(report.rows, [](const MapResult& row) { return !std::isfinite(row.distance.lo); })) {
    below("Grey: no bound is proven.");
  }
  return y;
}

/// `text` in lines of at most `room`, broken at spaces; a longer word has a line of its own.
std::vector<std::string> broken(const Drawing& drawing, const std::string& text, double room,
                                const Drawing::Type& type) {
  std::vector<std::string> lines{""};
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || drawing.width_of(longer, type) <= room) {
      lines.back() = longer;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

/// As many entries as there is room for.
void write_summary(Drawing& drawing, const Report& report, const Layout& layout, double y) {
  const double unit = layout.unit;
  const double bottom = drawing.height() - layout.margin;
  y += 30.0 * unit;
  for (const ReportLine& line : report.summary) {
    const Drawing::Type type{18.0 * unit, ink};
    const std::vector<std::string> values = broken(drawing, line.value, layout.legend_width, type);
    if (y + 23.0 * unit * static_cast<double>(values.size()) > bottom) return;
    drawing.write(layout.legend_left, y, layout.legend_width, line.label, {15.0 * unit, faint_ink});
    for (const std::string& value : values) {
      y += 23.0 * unit;
      drawing.write(layout.legend_left, y, layout.legend_width, value, type);
    }
    y += 31.0 * unit;
  }
}

}  // namespace

void write_picture(const std::filesystem::path& path, const Report& report, int width, int height) {
  Drawing drawing(width, height);
  const Layout layout(width, height);
  const ColourScale scale = report::scale_of(report);
  drawing.write(layout.margin, layout.margin + 24.0 * layout.unit, width - 2.0 * layout.margin, report.title,
                {30.0 * layout.unit, ink, Drawing::Weight::bold});
  draw_bone(drawing, report, scale, layout);
  write_summary(drawing, report, layout, draw_colour_bar(drawing, report, scale, layout));
  drawing.save(path);
}

}  // namespace verisq
