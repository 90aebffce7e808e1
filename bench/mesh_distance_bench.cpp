/// Distances of points to a closed mesh beside Embree's point query and CGAL's AABB tree, in one process, on one core:
/// thousand points a second, and ours over theirs. `mesh_distance_bench MESH [OTHER]`: about MESH, also from the
/// vertices of OTHER, which are moved to the middle of MESH. Ours are proven and signed; Embree's are unsigned, of
/// binary32 and a callback of this file; CGAL's are unsigned, of binary64. Each number is the median of rounds in which
/// all take turns; of ratios likewise. "one by one" knows nothing of other points, "hint" begins with the triangle of
/// the point before, "all at once" sorts by itself.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>

#include "verify/proof/triangle_tree.hpp"
#include "verify/search/closed_mesh.hpp"

namespace verisq::bench {
namespace {

using verify::ClosedMesh;

constexpr std::size_t points_of_a_kind = 60'000;
constexpr int rounds = 7;

/// The processor time of this thread.
double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Embree's point query over triangles, by the recipe of its tutorial "closest_point".
class EmbreePeer {
 public:
  explicit EmbreePeer(std::span<const Triangle> triangles)
      : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangles.size()));
    auto* const indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size()));
    for (std::size_t n = 0; n < triangles.size(); ++n) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) vertices[9 * n + 3 * k + i] = static_cast<float>(triangles[n][k][i]);
        indices[3 * n + k] = static_cast<unsigned>(3 * n + k);
      }
    }
    corners_.assign(vertices, vertices + 9 * triangles.size());
    rtcSetGeometryPointQueryFunction(geometry, &EmbreePeer::look_at);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  EmbreePeer(const EmbreePeer&) = delete;
  EmbreePeer& operator=(const EmbreePeer&) = delete;
  ~EmbreePeer() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] double distance(const Point& point) const {
    RTCPointQuery query{};
    query.x = static_cast<float>(point[0]);
    query.y = static_cast<float>(point[1]);
    query.z = static_cast<float>(point[2]);
    query.radius = HUGE_VALF;
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, nullptr, const_cast<EmbreePeer*>(this));
    return query.radius;
  }

 private:
  using Vector = std::array<float, 3>;

  static Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static float dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  /// Ericson, Real-Time Collision Detection (2005), 5.1.5.
  static float square(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
    const Vector ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
    const auto at = [&](float v, float w) {
      const Vector way{ap[0] - v * ab[0] - w * ac[0], ap[1] - v * ab[1] - w * ac[1], ap[2] - v * ab[2] - w * ac[2]};
      return dot(way, way);
    };
    const float d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return at(0, 0);
    const Vector bp = minus(p, b);
    const float d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return at(1, 0);
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return at(d1 / (d1 - d3), 0);
    const Vector cp = minus(p, c);
    const float d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return at(0, 1);
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return at(0, d2 / (d2 - d6));
    const float va = d3 * d6 - d5 * d4;
    const float w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    if (va <= 0 && d4 >= d3 && d5 >= d6) return at(1 - w, w);
    const float scale = 1 / (va + vb + vc);
    return at(vb * scale, vc * scale);
  }

  static bool look_at(RTCPointQueryFunctionArguments* arguments) {
    const auto& peer = *static_cast<const EmbreePeer*>(arguments->userPtr);
    const float* const t = &peer.corners_[9 * std::size_t{arguments->primID}];
    RTCPointQuery& query = *arguments->query;
    const float found =
        std::sqrt(square({query.x, query.y, query.z}, {t[0], t[1], t[2]}, {t[3], t[4], t[5]}, {t[6], t[7], t[8]}));
    if (!(found < query.radius)) return false;
    query.radius = found;
    return true;
  }

  RTCDevice device_;
  RTCScene scene_;
  std::vector<float> corners_;
};

class CgalPeer {
 public:
  explicit CgalPeer(std::span<const Triangle> triangles) {
    for (const auto& [a, b, c] : triangles) triangles_.emplace_back(at(a), at(b), at(c));
    tree_.rebuild(triangles_.begin(), triangles_.end());
    tree_.accelerate_distance_queries();
  }

  [[nodiscard]] double distance(const Point& point) const { return std::sqrt(tree_.squared_distance(at(point))); }

 private:
  using Kernel = CGAL::Simple_cartesian<double>;
  using Triangles = std::vector<Kernel::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

  static Kernel::Point_3 at(const Point& x) { return {x[0], x[1], x[2]}; }

  Triangles triangles_;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

struct Kind {
  std::string name;
  std::vector<Point> points;
};

/// By the bits of ten of each coordinate in turn.
void sort_by_morton_code(std::vector<Point>& points, const Point& lower, double size) {
  const auto code = [&](const Point& x) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto cell = static_cast<std::uint32_t>(std::clamp((x[i] - lower[i]) / size * 1023.0, 0.0, 1023.0));
      for (std::uint32_t bit = 0; bit < 10; ++bit) sum |= (cell >> bit & 1U) << (3 * bit + i);
    }
    return sum;
  };
  std::ranges::sort(points, {}, code);
}

std::vector<Point> about_surface(std::span<const Triangle> triangles, double sigma, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, sigma);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Point> points(points_of_a_kind);
  for (Point& point : points) {
    const auto& [a, b, c] = triangles[random() % triangles.size()];
    double u = share(random), v = share(random);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    for (std::size_t i = 0; i < 3; ++i) point[i] = a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]) + noise(random);
  }
  return points;
}

std::vector<Kind> kinds_of_points(std::span<const Triangle> triangles, const verify::WideTree& tree) {
  std::mt19937_64 random(1);
  std::vector<Kind> kinds{{"box", std::vector<Point>(points_of_a_kind)}};
  for (Point& point : kinds[0].points) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double width = tree.upper()[i] - tree.lower()[i];
      point[i] = tree.lower()[i] + width * std::uniform_real_distribution<double>(-0.25, 1.25)(random);
    }
  }
  kinds.push_back({"2 mm", about_surface(triangles, 2.0, random)});
  kinds.push_back({"0.05 mm", about_surface(triangles, 0.05, random)});
  double size = 0.0;
  Point lower;
  for (std::size_t i = 0; i < 3; ++i) size = std::max(size, 1.5 * (tree.upper()[i] - tree.lower()[i]));
  for (std::size_t i = 0; i < 3; ++i) lower[i] = tree.lower()[i] / 2 + tree.upper()[i] / 2 - size / 2;
  for (std::size_t k = 0; k < 3; ++k) {
    Kind sorted{kinds[k].name + ", sorted", kinds[k].points};
    sort_by_morton_code(sorted.points, lower, size);
    kinds.push_back(std::move(sorted));
  }
  return kinds;
}

std::vector<Point> moved_to_middle(std::vector<Point> points, const verify::WideTree& tree) {
  Point lower = points[0], upper = points[0];
  for (const Point& point : points) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], point[i]);
      upper[i] = std::max(upper[i], point[i]);
    }
  }
  for (Point& point : points) {
    for (std::size_t i = 0; i < 3; ++i) point[i] += (tree.lower()[i] + tree.upper()[i] - lower[i] - upper[i]) / 2;
  }
  return points;
}

struct Contestant {
  std::string name;
  std::function<void(std::span<const Point>)> answer;
};

/// Thousand points a second of each in each round, all in turn.
std::vector<std::vector<double>> rates(const std::vector<Contestant>& contestants, std::span<const Point> points) {
  std::vector<std::vector<double>> found(contestants.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < contestants.size(); ++k) {
      const double begin = processor_seconds();
      contestants[k].answer(points);
      found[k].push_back(1e-3 * static_cast<double>(points.size()) / (processor_seconds() - begin));
    }
  }
  return found;
}

std::vector<double> quotients(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> found;
  for (std::size_t i = 0; i < a.size(); ++i) found.push_back(a[i] / b[i]);
  return found;
}

/// Widths over the size, and how far the peers are from the enclosure at most.
void print_widths(const ClosedMesh& solid, const CgalPeer& cgal, const Kind& kind, double size) {
  std::vector<double> widths;
  std::size_t outside = 0, by_planes = 0;
  for (const Point& point : kind.points) {
    const ClosedMesh::Distance found = solid.signed_distance(point);
    const double sign = found.side == ClosedMesh::Side::inside ? -1.0 : 1.0;
    const double peer = sign * cgal.distance(point);
    widths.push_back(found.signed_distance.width() / size);
    outside += found.signed_distance.contains(peer) ? 0 : 1;
    by_planes += found.means == ClosedMesh::Means::planes ? 1 : 0;
  }
  std::ranges::sort(widths);
  fmt::print("{:16} width over size: median {:.1e}, 99 % {:.1e}, most {:.1e}; CGAL outside of {}; side by planes {}\n",
             kind.name, widths[widths.size() / 2], widths[widths.size() * 99 / 100], widths.back(), outside, by_planes);
}

int run(std::span<char*> arguments) {
  if (arguments.size() < 2) {
    fmt::print(stderr, "usage: mesh_distance_bench MESH [OTHER]\n");
    return 2;
  }
  const Mesh mesh = read_mesh(arguments[1]);
  const std::vector<Triangle> triangles = verify::triangles_of(mesh);
  double begin = processor_seconds();
  const ClosedMesh solid(mesh);
  const double ours = processor_seconds() - begin;
  begin = processor_seconds();
  const EmbreePeer embree(triangles);
  const double of_embree = processor_seconds() - begin;
  begin = processor_seconds();
  const CgalPeer cgal(triangles);
  fmt::print("{} triangles; made in {:.2f} s, Embree {:.2f} s, CGAL {:.2f} s\n", triangles.size(), ours, of_embree,
             processor_seconds() - begin);

  std::vector<Kind> kinds = kinds_of_points(triangles, solid.tree());
  if (arguments.size() > 2)
    kinds.push_back({"other mesh", moved_to_middle(read_mesh(arguments[2]).vertices, solid.tree())});
  double sum = 0.0;  // so that no answer is left out
  std::vector<ClosedMesh::Distance> distances;
  const std::vector<Contestant> contestants{{"one by one",
                                             [&](std::span<const Point> points) {
                                               for (const Point& point : points)
                                                 sum += solid.signed_distance(point).signed_distance.lo;
                                             }},
                                            {"hint",
                                             [&](std::span<const Point> points) {
                                               std::optional<std::uint32_t> hint;
                                               for (const Point& point : points) {
                                                 const ClosedMesh::Distance found = solid.signed_distance(point, hint);
                                                 sum += found.signed_distance.lo;
                                                 hint = found.triangle;
                                               }
                                             }},
                                            {"all at once",
                                             [&](std::span<const Point> points) {
                                               distances.resize(points.size());
                                               solid.signed_distances(points, distances);
                                             }},
                                            {"Embree",
                                             [&](std::span<const Point> points) {
                                               for (const Point& point : points) sum += embree.distance(point);
                                             }},
                                            {"CGAL", [&](std::span<const Point> points) {
                                               for (const Point& point : points) sum += cgal.distance(point);
                                             }}};
  fmt::print("{:16}", "");
  for (const Contestant& contestant : contestants) fmt::print(" {:>12}", contestant.name);
  fmt::print("   one by one, hint, all at once: over Embree | over CGAL\n");
  for (const Kind& kind : kinds) {
    const auto found = rates(contestants, kind.points);
    fmt::print("{:16}", kind.name);
    for (const std::vector<double>& rate : found) fmt::print(" {:12.0f}", median(rate));
    fmt::print("  ");
    for (const std::size_t peer : {3U, 4U}) {
      for (const std::size_t way : {0U, 1U, 2U}) fmt::print(" {:6.2f}", median(quotients(found[way], found[peer])));
      fmt::print("{}", peer == 3 ? " |" : "\n");
    }
  }
  double size = 0.0;
  for (std::size_t i = 0; i < 3; ++i) size = std::max(size, solid.tree().upper()[i] - solid.tree().lower()[i]);
  for (const Kind& kind : kinds) print_widths(solid, cgal, kind, size);
  return std::isnan(sum) ? 1 : 0;
}

}  // namespace
}  // namespace verisq::bench

int main(int count, char** values) {
  return verisq::bench::run({values, static_cast<std::size_t>(count)});
}
