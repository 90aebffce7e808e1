/// Every vertex of a mesh, on the best device there is: how many are proven to be farther than a limit?
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <span>
#include <verisq/files.hpp>
#include <verisq/map.hpp>

int main() {
  const verisq::Mesh mesh = verisq::read_mesh("examples/cavity.off");
  auto next = mesh.vertices.begin();
  const auto source = [&](std::span<verisq::Point> chunk) {
    const auto count = std::min(chunk.size(), static_cast<std::size_t>(mesh.vertices.end() - next));
    std::copy_n(next, count, chunk.begin());
    next += static_cast<std::ptrdiff_t>(count);
    return count;
  };
  std::ptrdiff_t farther = 0;
  const auto sink = [&](auto /*points*/, std::span<const verisq::MapResult> rows, auto /*certificates*/) {
    farther += std::ranges::count_if(rows, [](const verisq::MapResult& row) { return row.distance.lo > 1.99; });
  };
  const verisq::Model implant = verisq::read_model("examples/stem_mm.json");
  const verisq::MapSummary summary = verisq::PointMapper(implant, {.tolerance = 1e-6}).map(source, sink);
  std::printf("%td of %zu vertices are farther than 1.99 mm; the nearest is [%.17g, %.17g] mm away\n", farther,
              mesh.vertices.size(), summary.minimum_lo, summary.minimum_hi);
}
