/// A program of somebody else: maps one point by the installed package and checks the enclosure.
#include <cstdio>
#include <span>
#include <string_view>
#include <verisq/verisq.hpp>

#if VERISQ_VERSION_MAJOR == 0 && VERISQ_VERSION_MINOR < 1
#error "older than the first release"
#endif

int main() {
  const verisq::Model model{
      .units = "mm",
      .primitives = {
          {.name = "ball", .superquadric = {.semi_axes = {1.0, 1.0, 1.0}, .exponents = {1.0, 1.0}}, .pose = {}}}};
  const verisq::Point point{3.0, 0.0, 0.0};  // exactly 2 from the ball
  const auto direct = verisq::SignedDistance(model)(point, 1e-12);

  bool given = false;
  const auto source = [&](std::span<verisq::Point> points) -> std::size_t {
    if (given || points.empty()) return 0;
    given = true;
    points[0] = point;
    return 1;
  };
  verisq::Enclosure mapped{};
  const auto sink = [&](std::span<const verisq::Point>, std::span<const verisq::MapResult> results,
                        std::span<const verisq::Certificate>) { mapped = results[0].distance; };
  const auto summary = verisq::PointMapper(model, {.tolerance = 1e-12, .device = "host"}).map(source, sink);

  std::printf("direct [%.17g, %.17g], mapped [%.17g, %.17g]\n", direct.lo, direct.hi, mapped.lo, mapped.hi);
  std::printf("header %s, package %s\n", VERISQ_VERSION, PACKAGE_VERSION);
  const bool same_version = std::string_view(VERISQ_VERSION) == PACKAGE_VERSION;
  const bool right = same_version && direct.contains(2.0) && mapped.contains(2.0) && verisq::verified(mapped, 1e-12);
  return right && summary.points == 1 ? 0 : 1;
}
