/// Points as text, a line each.
#include "host/files/number_rows.hpp"
#include "host/files/point_source.hpp"

namespace verisq {
namespace {

static_assert(sizeof(Point) == 3 * sizeof(double));

class TextPoints final : public PointSource {
 public:
  explicit TextPoints(InputFile file)
      : rows_(std::move(file), {.item = "point", .count = "three", .header = "x,y,z", .free = true}) {}

  std::size_t read(std::span<Point> points) override {
    return rows_.read({points.empty() ? nullptr : points.front().data(), 3 * points.size()}) / 3;
  }
  [[nodiscard]] std::uint64_t bytes_read() const override { return rows_.bytes_read(); }
  [[nodiscard]] std::uint64_t bytes_total() const override { return rows_.bytes_total(); }

 private:
  NumberRows rows_;
};

}  // namespace

std::unique_ptr<PointSource> text_points(InputFile file) {
  return std::make_unique<TextPoints>(std::move(file));
}

}  // namespace verisq
