/// The diverging colours, and the range that shows most of a map.
#include "host/report/colour_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

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

/// How far from the implant's surface the rows are, by their lower bounds.
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
