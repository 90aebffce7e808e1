/// Eight threads and two models: what may be shared is shared, what may not has an owner each, and every answer is that
/// of one thread alone. Says most under ThreadSanitizer: `./run races`.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>
#include <verisq/octree.hpp>

namespace verisq {
namespace {

constexpr std::size_t threads = 8;

/// VERISQ_RACES_SECONDS: how long to repeat it. One round without.
double seconds_asked() {
  const char* const text = std::getenv("VERISQ_RACES_SECONDS");
  return text == nullptr ? 0.0 : std::strtod(text, nullptr);
}

/// Devices are asked for only where VERISQ_RACES_DEVICE names one: OpenCL's libraries are not instrumented.
std::string device_asked() {
  const char* const text = std::getenv("VERISQ_RACES_DEVICE");
  return text == nullptr ? "host" : text;
}

/// Overlapping unions, one of them tapered.
std::array<Model, 2> models() {
  return {Model{"",
                {{"a", {{1.0, 0.6, 0.5}, {0.8, 1.2}}, {{0.4, 0.0, 0.0}, {1.0, 0.1, 0.2, 0.3}}},
                 {"b", {{0.9, 0.7, 0.6}, {1.0, 0.5}}, {{-0.3, 0.1, 0.0}, {1.0, -0.2, 0.1, 0.0}}}}},
          Model{"", {{"c", {{0.5, 0.8, 1.5}, {0.3, 0.9}, 1.6}, {{0.0, 0.2, 0.1}, {1.0, 0.3, 0.0, 0.1}}}}}};
}

std::vector<Point> points_around() {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> within(-2.0, 2.0);
  std::vector<Point> points(24);
  for (Point& point : points) point = {within(generator), within(generator), within(generator)};
  return points;
}

/// Everything that queries of both models answer, in an order of its own for each thread.
class Work {
 public:
  explicit Work(const std::array<Model, 2>& models)
      : models_(models),
        distances_{SignedDistance(models[0]), SignedDistance(models[1])},
        triangles_{TriangleDistance(models[0]), TriangleDistance(models[1])},
        pair_(models[0], models[1]),
        checkers_{Checker(models[0]), Checker(models[1])} {}

  /// The same whatever the order.
  [[nodiscard]] std::vector<Enclosure> answers(std::size_t order) const {
    std::vector<Enclosure> all;
    std::array<std::vector<Enclosure>, 2> of_models;
    for (const std::size_t k : {order % 2, 1 - order % 2}) of_models[k] = of_model(k);
    for (const auto& some : of_models) all.insert(all.end(), some.begin(), some.end());
    all.push_back(pair_({{3.0, 0.5, 0.2}, {1.0, 0.1, 0.0, 0.2}}, [] { return false; }).distance);
    return all;
  }

 private:
  [[nodiscard]] std::vector<Enclosure> of_model(std::size_t k) const {
    std::vector<Enclosure> found;
    for (const Point& point : points_) found.push_back(distances_[k](point, 1e-6));
    for (std::size_t i = 0; i + 2 < points_.size(); i += 3) {
      found.push_back(triangles_[k]({points_[i], points_[i + 1], points_[i + 2]}));
    }
    map(k, found);
    found.push_back(OctreeBuilder(models_[k], {.depth = 3, .device = "host"}).build().volume);
    return found;
  }

  /// By a mapper of this thread's own; a checker proves the rows that is everybody's.
  void map(std::size_t k, std::vector<Enclosure>& found) const {
    PointMapper mapper(models_[k], {.tolerance = 1e-6, .device = device_asked(), .certificates = true});
    std::size_t read = 0;
    const auto source = [&](std::span<Point> chunk) {
      std::size_t count = 0;
      for (; count < chunk.size() && read < points_.size(); ++count) chunk[count] = points_[read++];
      return count;
    };
    (void)mapper.map(source, [&](std::span<const Point> points, std::span<const MapResult> rows,
                                 std::span<const Certificate> certificates) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        found.push_back(rows[i].distance);
        EXPECT_EQ(checkers_[k](points[i], rows[i].distance, certificates[i]).verdict, Verdict::proved);
      }
    });
  }

  const std::array<Model, 2>& models_;
  std::array<SignedDistance, 2> distances_;
  std::array<TriangleDistance, 2> triangles_;
  PairDistance pair_;
  std::array<Checker, 2> checkers_;
  std::vector<Point> points_ = points_around();
};

TEST(SharedByThreads, EachIsToldWhatOneIsToldAlone) {
  const std::array<Model, 2> both = models();
  const Work work(both);
  const std::vector<Enclosure> expected = work.answers(0);
  const auto start = std::chrono::steady_clock::now();
  do {
    std::array<std::vector<Enclosure>, threads> found;
    {
      std::vector<std::jthread> running;
      for (std::size_t k = 0; k < threads; ++k) {
        running.emplace_back([&, k] { found[k] = work.answers(k); });
      }
    }
    for (const auto& answers : found) ASSERT_EQ(answers, expected);
  } while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds_asked());
}

}  // namespace
}  // namespace verisq
