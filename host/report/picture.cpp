/// The colours and drawings of projection.hpp.

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/report.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"
#include "host/report/projection.hpp"

namespace verisq::report {
namespace {

Colour colour_of(std::uint32_t rgb) {
  return Colour((rgb >> 16U) & 0xffU, (rgb >> 8U) & 0xffU, rgb & 0xffU) / 255.0;
}

using Stops = std::array<std::uint32_t, 6>;  // from zero to the end of the range

constexpr Stops outside{0xdfeaf1, 0xb3d1e4, 0x7db1d3, 0x4288bb, 0x2468a8, 0x174a80};
constexpr Stops inside{0xffc67d, 0xfb9a4b, 0xec6a2c, 0xc93f1c, 0x9e2318, 0x701414};
constexpr std::uint32_t unbounded = 0x8b8f96;

Colour blend(const Stops& stops, double t) {
  const double place = std::min(t, 1.0) * static_cast<double>(stops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const double part = place - static_cast<double>(k);
  return (1.0 - part) * colour_of(stops[k]) + part * colour_of(stops[k + 1]);
}

/// 1, 2 or 5 times a power of ten, no less than `size` but for rounding. Precondition: positive, finite.
double round_step(double size) {
  const double power = std::pow(10.0, std::floor(std::log10(size)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (size <= digit * power * (1.0 + 1e-9)) return digit * power;
  }
  return 10.0 * power;
}

/// The distances of the rows from the implant's surface, by their lower bounds.
std::vector<double> sizes_of(std::span<const MapResult> rows) {
  std::vector<double> sizes;
  for (const MapResult& row : rows) {
    if (std::isfinite(row.distance.lo)) sizes.push_back(std::abs(row.distance.lo));
  }
  return sizes;
}

/// 3 mm.
std::optional<double> decisive_range(std::string_view units) {
  if (units == "mm") return 3.0;
  if (units == "cm") return 0.3;
  if (units == "m") return 0.003;
  return std::nullopt;
}

/// Round, and so that few are beyond.
double usual_range(std::vector<double> sizes) {
  if (sizes.empty()) return 1.0;
  // A few far vertices must not take the contrast of all others.
  const auto usual = sizes.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(sizes.size() - 1));
  std::ranges::nth_element(sizes, usual);
  if (!std::isnormal(*usual)) return 1.0;
  const double step = round_step(*usual / 10.0);
  const double range = std::ceil(*usual / step * (1.0 - 1e-9)) * step;
  return std::isnormal(range) ? range : *usual;
}

}  // namespace

Colour ColourScale::colour(double value) const {
  if (!std::isfinite(value)) return colour_of(unbounded);
  return value < 0.0 ? blend(inside, -value / range_) : blend(outside, value / range_);
}

std::vector<double> ColourScale::ticks() const {
  const double step = round_step(range_ / 4.0);
  const int count = static_cast<int>(range_ / step * (1.0 + 1e-9));
  std::vector<double> ticks;
  for (int k = -count; k <= count; ++k) ticks.push_back(k * step);
  return ticks;
}

ColourScale scale_of(const Report& report) {
  return ColourScale(report.range ? *report.range : default_range(report.rows, report.units));
}

}  // namespace verisq::report

namespace verisq {

double default_range(std::span<const MapResult> rows, std::string_view units) {
  const std::vector<double> sizes = report::sizes_of(rows);
  const std::optional<double> decisive = report::decisive_range(units);
  if (!decisive) return report::usual_range(sizes);
  const auto near = std::ranges::count_if(sizes, [&](double size) { return size <= *decisive; });
  return 10 * near >= std::ssize(sizes) && near > 0 ? *decisive : report::usual_range(sizes);
}

}  // namespace verisq

namespace verisq::report {
namespace {

struct Destroy {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Context = std::unique_ptr<cairo_t, Destroy>;

std::uint32_t channel(double value) {
  return static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

bool continues_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0U) == 0x80U;
}

void choose_type(cairo_t* context, const Drawing::Type& type) {
  cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         type.weight == Drawing::Weight::bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, type.size);
  cairo_set_source_rgb(context, type.colour[0], type.colour[1], type.colour[2]);
}

double advance_of(cairo_t* context, const std::string& text) {
  cairo_text_extents_t extents{};
  cairo_text_extents(context, text.c_str(), &extents);
  return extents.x_advance;
}

/// Shortens by bisection, because a model may name its units by a text of any length.
std::string shortened(cairo_t* context, const std::string& text, double room) {
  if (advance_of(context, text) <= room) return text;
  const auto beginning = [&](std::size_t bytes) {
    while (bytes > 0 && continues_character(text[bytes])) --bytes;
    return text.substr(0, bytes) + "...";
  };
  std::size_t fits = 0;
  std::size_t too_long = text.size();
  while (too_long - fits > 1) {
    const std::size_t middle = fits + (too_long - fits) / 2;
    (advance_of(context, beginning(middle)) <= room ? fits : too_long) = middle;
  }
  return beginning(fits);
}

/// An output file to which cairo writes, and its error: exceptions must not cross C.
struct Target {
  OutputFile file;
  std::exception_ptr error = nullptr;
};

cairo_status_t write_bytes(void* closure, const unsigned char* bytes, unsigned count) {
  auto& target = *static_cast<Target*>(closure);
  try {
    target.file.write({reinterpret_cast<const char*>(bytes), count});
    return CAIRO_STATUS_SUCCESS;
  } catch (...) {
    target.error = std::current_exception();
    return CAIRO_STATUS_WRITE_ERROR;
  }
}

}  // namespace

void Drawing::Release::operator()(_cairo_surface* surface) const {
  cairo_surface_destroy(surface);
}

Drawing::Drawing(int width, int height)
    : width_(width), height_(height), surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)) {
  if (const auto status = cairo_surface_status(surface_.get()); status != CAIRO_STATUS_SUCCESS) {
    throw Error(ErrorKind::failure, std::string("the picture cannot be drawn: ") + cairo_status_to_string(status));
  }
  pixels_ = cairo_image_surface_get_data(surface_.get());
  row_size_ = cairo_image_surface_get_stride(surface_.get());
  fill_rectangle(0.0, 0.0, width, height, Colour(1.0, 1.0, 1.0));
}

void Drawing::set_row(int x, int y, std::span<const Colour> colours) {
  cairo_surface_flush(surface_.get());
  unsigned char* pixel = pixels_ + y * row_size_ + std::ptrdiff_t{4} * x;
  for (const Colour& colour : colours) {
    const std::uint32_t rgb = channel(colour[0]) << 16U | channel(colour[1]) << 8U | channel(colour[2]);
    std::memcpy(pixel, &rgb, sizeof rgb);
    pixel += sizeof rgb;
  }
  cairo_surface_mark_dirty(surface_.get());
}

void Drawing::fill_rectangle(double x, double y, double width, double height, const Colour& colour) {
  const Context context(cairo_create(surface_.get()));
  cairo_set_source_rgb(context.get(), colour[0], colour[1], colour[2]);
  cairo_rectangle(context.get(), x, y, width, height);
  cairo_fill(context.get());
}

void Drawing::write(double x, double y, double room, const std::string& text, const Type& type) {
  const Context context(cairo_create(surface_.get()));
  choose_type(context.get(), type);
  const std::string line = shortened(context.get(), on_one_line(text), room);
  cairo_move_to(context.get(), x, y);
  cairo_show_text(context.get(), line.c_str());
}

double Drawing::width_of(const std::string& text, const Type& type) const {
  const Context context(cairo_create(surface_.get()));
  choose_type(context.get(), type);
  return advance_of(context.get(), on_one_line(text));
}

void Drawing::save(const std::filesystem::path& path) const {
  Target target{OutputFile(path)};
  const auto status = cairo_surface_write_to_png_stream(surface_.get(), write_bytes, &target);
  if (target.error) std::rethrow_exception(target.error);
  if (status != CAIRO_STATUS_SUCCESS) target.file.fail(cairo_status_to_string(status));
  target.file.finish();
}

}  // namespace verisq::report

namespace verisq {
namespace {

using report::BoneShown;
using report::Colour;
using report::ColourScale;
using report::Drawing;

const Colour ink(0.10, 0.11, 0.13);
const Colour faint_ink(0.40, 0.42, 0.46);

/// Lengths in pixels. Sizes of letters and gaps are defined for the usual picture and grow with it.
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

/// Values in ranges of the scale: binary32 can represent these for any units.
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
  drawing.write(
      layout.legend_left, y, layout.legend_width,
      report.units.empty() ? "proven lower bound" : std::string("proven lower bound, in") + units_behind(report.units),
      faint);
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

/// Writes as many entries as there is room for.
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
