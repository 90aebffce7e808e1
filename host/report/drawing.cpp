/// An image surface of cairo; each call has a context of its own, so that one that fails spoils no other.
#include "host/report/drawing.hpp"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>
#include <string_view>
#include <verisq/error.hpp>

#include "host/files/output_file.hpp"

namespace verisq::report {
namespace {

struct Destroy {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Context = std::unique_ptr<cairo_t, Destroy>;

std::uint32_t channel(double value) {
  return static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

/// Cairo refuses what is not UTF-8; the JSON library can replace it. Control characters would be drawn as boxes.
std::string printable(const std::string& text) {
  using nlohmann::json;
  std::string line = json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return line.substr(0, line.find('\0'));
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

/// By bisection, because a model may name its units by a text of any length.
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

/// An output file that cairo writes to, and what went wrong there: exceptions must not cross C.
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
  const std::string line = shortened(context.get(), printable(text), room);
  cairo_move_to(context.get(), x, y);
  cairo_show_text(context.get(), line.c_str());
}

double Drawing::width_of(const std::string& text, const Type& type) const {
  const Context context(cairo_create(surface_.get()));
  choose_type(context.get(), type);
  return advance_of(context.get(), printable(text));
}

void Drawing::save(const std::filesystem::path& path) const {
  Target target{OutputFile(path)};
  const auto status = cairo_surface_write_to_png_stream(surface_.get(), write_bytes, &target);
  if (target.error) std::rethrow_exception(target.error);
  if (status != CAIRO_STATUS_SUCCESS) target.file.fail(cairo_status_to_string(status));
  target.file.finish();
}

}  // namespace verisq::report
