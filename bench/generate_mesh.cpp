/// Writes a closed bone-like mesh with any number of vertices, for benchmarks of scale:
///   generate_mesh VERTICES OUT.ply
#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <string_view>

namespace {

// The size and place of the proximal femur libhip/m3_lfemur_mm.stl, so that both meshes suit one implant model.
constexpr double shaft_bottom = -973.0;
constexpr double length = 164.0;

static_assert(std::endian::native == std::endian::little, "the header below promises little-endian numbers");

/// The vertices lie on one spiral from the lower to the upper pole, `turn` of them a turn. Each quadrilateral
/// (i, i+1, i+turn+1, i+turn) gives two triangles, a fan closes each end: a closed manifold whatever the count.
class Spiral {
 public:
  /// Precondition: at least `smallest` vertices.
  explicit Spiral(std::uint32_t vertices)
      : on_spiral_(vertices - 2), turn_(static_cast<std::uint32_t>(std::sqrt(0.7 * on_spiral_))) {}

  static constexpr std::uint32_t smallest = 64;

  [[nodiscard]] std::uint32_t triangles() const { return 2 * (on_spiral_ - turn_ - 1) + 2 * (turn_ + 1); }

  template <class Visit>
  void for_each_vertex(Visit visit) const {
    for (std::uint32_t i = 0; i < on_spiral_; ++i)
      visit(surface_point(static_cast<double>(i) / on_spiral_, 2.0 * std::numbers::pi * i / turn_));
    visit(axis_point(-0.01));
    visit(axis_point(1.01));
  }

  template <class Visit>
  void for_each_triangle(Visit visit) const {
    for (std::uint32_t i = 0; i + turn_ + 1 < on_spiral_; ++i) {
      visit(std::array{i, i + 1, i + turn_ + 1});
      visit(std::array{i, i + turn_ + 1, i + turn_});
    }
    close_end(0, on_spiral_, [&](std::uint32_t a, std::uint32_t b, std::uint32_t pole) {
      visit(std::array{b, a, pole});
    });
    close_end(on_spiral_ - turn_ - 1, on_spiral_ + 1, [&](std::uint32_t a, std::uint32_t b, std::uint32_t pole) {
      visit(std::array{a, b, pole});
    });
  }

 private:
  using Vertex = std::array<float, 3>;

  /// A fan over the boundary loop first, first + 1, ..., first + turn, first.
  template <class Visit>
  void close_end(std::uint32_t first, std::uint32_t pole, Visit visit) const {
    for (std::uint32_t i = first; i < first + turn_; ++i) visit(i, i + 1, pole);
    visit(first + turn_, first, pole);
  }

  /// `height` from 0 to 1 along the shaft's axis, which leans as that of the scanned bone.
  static std::array<double, 3> axis(double height) {
    return {123.5 + 5.0 * height, -124.5 + 32.0 * height, shaft_bottom + length * height};
  }

  static Vertex axis_point(double height) {
    const auto [x, y, z] = axis(height);
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  }

  /// A shaft of radius 14 that widens towards the trochanters, with waves a few millimetres long.
  static Vertex surface_point(double height, double angle) {
    const double widening = 10.0 / (1.0 + std::exp(-14.0 * (height - 0.65)));
    const double waves =
        0.4 * std::sin(7.0 * angle) * std::sin(60.0 * height) + 0.2 * std::cos(11.0 * angle + 90.0 * height);
    const double radius = 14.0 + widening + waves;
    const auto [x, y, z] = axis(height);
    return {static_cast<float>(x + radius * std::cos(angle)), static_cast<float>(y + radius * std::sin(angle)),
            static_cast<float>(z)};
  }

  std::uint32_t on_spiral_;
  std::uint32_t turn_;
};

void write_ply(const Spiral& mesh, std::uint32_t vertices, std::ostream& out) {
  out << fmt::format(
      "ply\nformat binary_little_endian 1.0\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      vertices, mesh.triangles());
  const auto write = [&out](const auto& numbers) {
    out.write(reinterpret_cast<const char*>(numbers.data()), static_cast<std::streamsize>(sizeof numbers));
  };
  mesh.for_each_vertex(write);
  mesh.for_each_triangle([&](const std::array<std::uint32_t, 3>& triangle) {
    out.put(3);
    write(triangle);
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: generate_mesh VERTICES OUT.ply\n");
    return 2;
  }
  const std::string_view count = argv[1];
  std::uint32_t vertices = 0;
  const auto parsed = std::from_chars(count.data(), count.data() + count.size(), vertices);
  if (parsed.ec != std::errc{} || parsed.ptr != count.data() + count.size() || vertices < Spiral::smallest ||
      vertices > 1'000'000'000) {
    fmt::print(stderr, "VERTICES is {}: a number from {} to 1000000000 is needed\n", count, Spiral::smallest);
    return 2;
  }
  std::ofstream out(argv[2], std::ios::binary);
  write_ply(Spiral(vertices), vertices, out);
  out.close();
  if (!out) {
    fmt::print(stderr, "{}: cannot be written\n", argv[2]);
    return 1;
  }
}
