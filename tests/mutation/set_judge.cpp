/// This file implements the rows and queries whose answers are known, the launches of set_feet and set_bounds, and the
/// comparison.
#include "tests/mutation/set_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <verisq/distance.hpp>

#include "host/device/solid_model.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/mutation/launch.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/placed_model.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::mutation {
namespace {

using oracle::Membership;
using oracle::PlacedModel;
using oracle::PlacedPrimitive;
using oracle::RandomCases;
using EdgeRow = SetJudge::EdgeRow;
using KnownPoint = SetJudge::KnownPoint;
using Query = SetJudge::Query;

constexpr std::size_t rows_of_kind = 400;
constexpr std::size_t queries_of_kind = 24;
constexpr std::size_t queries_by_points = 160;  // of each scene, which known points alone judge
constexpr std::size_t known_points = 2000;
constexpr double beside_boundary = 2e-11;  // of the gauge: twice the margin of memberships
constexpr double rounding = 1e-12;         // of what is computed here
constexpr double tolerance = 1e-6;
constexpr double truth_tolerance = 1e-7;
constexpr double depth_tolerance = 1e-11;
constexpr double no_edge = -1.0;
constexpr double deep = -1e3;  // of balls that nobody asked for: whoever takes it shows
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double norm(const Point& a) {
  return std::hypot(a[0], a[1], a[2]);
}
Point between(const Point& from, const Point& to) {
  return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}
Point moved(const Point& x, double distance, const Point& direction) {
  return {x[0] + distance * direction[0], x[1] + distance * direction[1], x[2] + distance * direction[2]};
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Point normalized(const Point& a) {
  return moved({}, 1.0 / norm(a), a);
}

/// Of the gauge, in the model's frame; by differences, since what is near is good enough.
Point gradient_at(const PlacedPrimitive& solid, const Point& x) {
  constexpr double step = 1e-6;
  Point n{};
  for (std::size_t i = 0; i < 3; ++i) {
    Point up = x;
    Point down = x;
    up[i] += step;
    down[i] -= step;
    n[i] = (solid.norm().gauge(solid.own(up)) - solid.norm().gauge(solid.own(down))) / (up[i] - down[i]);
  }
  return n;
}

/// A primitive, or the closure of its complement, as set_bounds.cl numbers them.
struct Literal {
  std::size_t primitive;
  bool complement;

  [[nodiscard]] double number() const { return static_cast<double>(primitive) + (complement ? 64.0 : 0.0); }
  /// Of the gauge, as far out as is certain.
  [[nodiscard]] double level() const { return complement ? 1.0 + beside_boundary : 1.0 - beside_boundary; }
};

bool is_of_complement(double edge) {
  return edge >= 16384.0;
}
Literal literal_of(unsigned number) {
  return {number & 63U, (number & 64U) != 0};
}
double edge_number(const Literal& a, const Literal& b, bool of_complement) {
  return a.number() * 128.0 + b.number() + (of_complement ? 16384.0 : 0.0);
}

/// Makes rows and queries of one model.
class Maker {
 public:
  Maker(const Model& model, std::uint64_t seed) : placed_(model), random_(seed) {}

  /// A query whose nearest point is on an edge, with feet there or nearby.
  [[nodiscard]] std::optional<EdgeRow> on_edge() {
    const auto [a, b] = literals();
    const auto witness = edge_point(a, b);
    if (!witness) return std::nullopt;
    EdgeRow row = row_at(*witness, a, b);
    const Point n_a = outward(a, *witness);
    const Point n_b = outward(b, *witness);
    const double s = random_.log_uniform(1e-5, 0.4);
    const double t = random_.log_uniform(1e-5, 0.4);
    row.query = moved(moved(*witness, s, n_a), t, n_b);
    if (random_.choice(2) == 0)
      row.foot = moved(*witness, random_.log_uniform(random_.choice(2) == 0 ? 1e-9 : 1e-3, 0.2), random_.direction());
    const double least = a.complement && b.complement ? 2.3 : 1.15;
    if (a.complement) row.centres[a.primitive] = moved(*witness, s * ball_share(least), n_a);
    if (b.complement) row.centres[b.primitive] = moved(*witness, t * ball_share(least), n_b);
    return row;
  }

  /// The nearest point is on one ball alone. With the foot where it and the ball's centre see each other at a right
  /// angle the multiplier is the best one, and what is left of d is not zero.
  [[nodiscard]] std::optional<EdgeRow> on_ball() {
    const Literal a{random_.choice(set_primitives), true};
    const auto [witness, n] = boundary_point(a);
    const auto b = other_complement(a, witness);
    if (!b) return std::nullopt;
    const double radius = random_.log_uniform(0.05, 0.4);
    const Point centre = moved(witness, radius, n);
    const Point w = normalized(cross(n, random_.direction()));
    const double angle = random_.uniform(-1.2, 1.2);
    const Point chord = moved(moved({}, -std::cos(angle), n), std::sin(angle), w);
    EdgeRow row = random_.choice(2) == 0 ? row_at(witness, a, *b) : row_at(witness, *b, a);
    row.foot = moved(centre, radius * std::cos(angle), chord);
    row.query = moved(witness, random_.uniform(0.02, 0.44) * radius, n);
    row.centres[a.primitive] = centre;
    row.centres[b->primitive] = moved(row.foot, 0.3, cross(n, w));
    return row;
  }

  /// The nearest point is on a half-space alone, the foot beside it.
  [[nodiscard]] std::optional<EdgeRow> on_face() {
    const Literal a{random_.choice(set_primitives), false};
    const auto [witness, n] = boundary_point(a);
    const auto b = other_complement(a, witness);
    if (!b) return std::nullopt;
    const Point w = normalized(cross(n, random_.direction()));
    EdgeRow row = random_.choice(2) == 0 ? row_at(witness, a, *b) : row_at(witness, *b, a);
    row.foot = moved(witness, random_.log_uniform(1e-2, 0.4), w);
    if (random_.choice(4) == 0) row.foot = moved(row.foot, -random_.log_uniform(1e-6, 1e-2), n);
    row.query = moved(witness, random_.log_uniform(1e-2, 1.0), n);
    row.centres[b->primitive] = moved(row.foot, 0.3, cross(n, w));
    return row;
  }

  /// Whatever the foot and the centres are.
  [[nodiscard]] std::optional<EdgeRow> of_anything() {
    const Point witness = anywhere();
    auto [a, b] = literals();
    for (Literal* const literal : {&a, &b}) {
      const Membership place = placed_.primitives()[literal->primitive].membership(witness);
      if (place == Membership::boundary) return std::nullopt;
      literal->complement = place == Membership::outside;
    }
    EdgeRow row = row_at(witness, a, b);
    row.query = moved(witness, random_.log_uniform(1e-3, 2.0), random_.direction());
    row.foot = random_.choice(2) == 0 ? anywhere() : moved(witness, random_.uniform(0.0, 0.5), random_.direction());
    // At times parallel, in the witness, or nowhere.
    switch (random_.choice(12)) {
      case 0: row.centres[b.primitive] = moved(row.foot, 2.0, between(row.foot, row.centres[a.primitive])); break;
      case 1: row.centres[a.primitive] = row.centres[b.primitive] = witness; break;
      case 2: row.foot[random_.choice(3)] = nan; break;
      case 3: row.edge = no_edge; break;
      default: break;
    }
    return row;
  }

  [[nodiscard]] std::optional<Query> query_by_edge() {
    const auto row = on_edge();
    return row ? std::optional(query_at(row->query)) : std::nullopt;
  }

  [[nodiscard]] std::optional<Query> query_by_face() {
    const Literal a{random_.choice(set_primitives), random_.choice(2) == 0};
    const auto [x, n] = boundary_point(a);
    Query query = query_at(moved(x, random_.log_uniform(1e-9, 1.0), n));
    query.normals[a.primitive] = own_direction(a.primitive, query.point, moved({}, a.complement ? -1.0 : 1.0, n));
    return query;
  }

  [[nodiscard]] std::optional<Query> query_anywhere() { return query_at(anywhere()); }

  /// Just beside the boundaries of primitives, and on edges.
  [[nodiscard]] KnownPoint known_point() {
    const auto [a, b] = literals();
    const auto on_both = random_.choice(2) == 0 ? edge_point(a, b) : std::nullopt;
    KnownPoint known{on_both ? *on_both : boundary_point(a).point, {}, {}};
    for (std::size_t i = 0; i < set_primitives; ++i)
      known.in_primitives[i] = placed_.primitives()[i].membership(known.point);
    known.in_model = placed_(known.point);
    return known;
  }

  /// Enclosures as wide as they may be.
  void widen(Query& query) {
    for (Enclosure& e : query.of_primitives) {
      if (random_.choice(12) == 0) e = {-infinity, infinity};
      e.lo -= random_.choice(3) == 0 ? 0.0 : random_.log_uniform(1e-8, 1e-2);
      e.hi += random_.choice(3) == 0 ? 0.0 : random_.log_uniform(1e-8, 1e-2);
    }
  }

 private:
  struct BoundaryPoint {
    Point point;
    Point outward;  ///< of the literal
  };

  [[nodiscard]] std::pair<Literal, Literal> literals() {
    const std::size_t first = random_.choice(set_primitives);
    const std::size_t second = (first + 1 + random_.choice(set_primitives - 1)) % set_primitives;
    return {{first, random_.choice(2) == 0}, {second, random_.choice(2) == 0}};
  }

  /// A ball's radius by its share of d; at times so small that its multiplier is cut off.
  [[nodiscard]] double ball_share(double least) {
    return random_.choice(6) == 0 ? random_.uniform(0.3, least) : least * random_.uniform(1.0, 3.0);
  }

  [[nodiscard]] Point anywhere() {
    Point x = placed_.bounding_ball().centre;
    for (double& c : x) c += random_.uniform(-2.0, 2.0);
    return x;
  }

  [[nodiscard]] Point outward(const Literal& literal, const Point& x) const {
    const Point n = normalized(gradient_at(placed_.primitives()[literal.primitive], x));
    return literal.complement ? moved({}, -1.0, n) : n;
  }

  [[nodiscard]] bool holds(const Literal& literal, const Point& x) const {
    const Membership place = placed_.primitives()[literal.primitive].membership(x);
    return place == (literal.complement ? Membership::outside : Membership::inside);
  }

  [[nodiscard]] BoundaryPoint boundary_point(const Literal& literal) {
    const PlacedPrimitive& solid = placed_.primitives()[literal.primitive];
    const Point x = random_.boundary_point(solid.primitive().superquadric).point;
    const double level = literal.level();
    const Point point = solid.placed({level * x[0], level * x[1], level * x[2]});
    return {point, outward(literal, point)};
  }

  /// Another literal that has the point.
  [[nodiscard]] std::optional<Literal> other_complement(const Literal& literal, const Point& x) {
    for (std::size_t i = 1; i < set_primitives; ++i) {
      const Literal other{(literal.primitive + i) % set_primitives, true};
      if (holds(other, x)) return other;
    }
    return std::nullopt;
  }

  /// On both boundaries, by Newton's method.
  [[nodiscard]] std::optional<Point> edge_point(const Literal& a, const Literal& b) {
    const PlacedPrimitive& solid_a = placed_.primitives()[a.primitive];
    const PlacedPrimitive& solid_b = placed_.primitives()[b.primitive];
    Point x = boundary_point(a).point;
    for (int step = 0; step < 60; ++step) {
      const double missing_a = a.level() - solid_a.norm().gauge(solid_a.own(x));
      const double missing_b = b.level() - solid_b.norm().gauge(solid_b.own(x));
      if (std::max(std::abs(missing_a), std::abs(missing_b)) < 0.25 * beside_boundary)
        return holds(a, x) && holds(b, x) ? std::optional(x) : std::nullopt;
      const Point n_a = gradient_at(solid_a, x);
      const Point n_b = gradient_at(solid_b, x);
      const double aa = dot(n_a, n_a);
      const double ab = dot(n_a, n_b);
      const double bb = dot(n_b, n_b);
      const double determinant = aa * bb - ab * ab;
      if (!(determinant > 1e-3 * aa * bb)) return std::nullopt;
      x = moved(moved(x, (bb * missing_a - ab * missing_b) / determinant, n_a),
                (aa * missing_b - ab * missing_a) / determinant, n_b);
    }
    return std::nullopt;
  }

  /// With the foot in the witness; centres are anywhere.
  [[nodiscard]] EdgeRow row_at(const Point& witness, const Literal& a, const Literal& b) {
    EdgeRow row{};
    row.witness = row.foot = witness;
    row.complement = random_.choice(2) == 0;
    row.edge = edge_number(a, b, row.complement);
    row.others = random_.choice(3) == 0 ? random_.log_uniform(1e-3, 1.0) : infinity;
    for (Point& centre : row.centres) centre = anywhere();
    row.ball_his.fill(deep);
    for (const Literal& literal : {a, b})
      if (literal.complement) row.ball_his[literal.primitive] = nan;  // to be found
    return row;
  }

  [[nodiscard]] Query query_at(const Point& x) const {
    Query query{x, {}, {}, {}};
    for (std::size_t i = 0; i < set_primitives; ++i)
      query.normals[i] = own_direction(i, x, gradient_at(placed_.primitives()[i], x));
    return query;
  }

  [[nodiscard]] Point own_direction(std::size_t primitive, const Point& x, const Point& direction) const {
    const PlacedPrimitive& solid = placed_.primitives()[primitive];
    return between(solid.own(x), solid.own(moved(x, 1.0, direction)));
  }

  PlacedModel placed_;
  RandomCases random_;
};

using Hosts = std::array<std::optional<SignedDistance>, set_primitives>;

Hosts hosts_of_primitives(const Model& model) {
  Hosts hosts;
  for (std::size_t i = 0; i < set_primitives; ++i) hosts[i].emplace(Model{"", {model.primitives[i]}, {}});
  return hosts;
}

std::vector<EdgeRow> rows_of(Maker& maker, const Hosts& hosts) {
  std::vector<EdgeRow> rows;
  using Make = std::optional<EdgeRow> (Maker::*)();
  // Most on balls, where the bound shows every rounding.
  for (const Make make : {&Maker::on_edge, &Maker::on_ball, &Maker::on_ball, &Maker::on_ball, &Maker::on_ball,
                          &Maker::on_ball, &Maker::on_face, &Maker::of_anything})
    for (std::size_t n = 0; n < rows_of_kind; ++n)
      if (const auto row = (maker.*make)()) rows.push_back(*row);
  oracle::in_parallel(rows.size(), [&](std::size_t n) {
    for (std::size_t i = 0; i < set_primitives; ++i)
      if (std::isnan(rows[n].ball_his[i])) rows[n].ball_his[i] = (*hosts[i])(rows[n].centres[i], depth_tolerance).hi;
  });
  return rows;
}

std::vector<Query> queries_of(Maker& maker, const Model& model, const Hosts& hosts) {
  std::vector<Query> queries;
  using Make = std::optional<Query> (Maker::*)();
  for (const Make make : {&Maker::query_by_edge, &Maker::query_by_face, &Maker::query_anywhere})
    for (std::size_t n = 0; n < queries_of_kind; ++n)
      if (const auto query = (maker.*make)()) queries.push_back(*query);
  const std::size_t with_truth = queries.size();
  while (queries.size() < with_truth + queries_by_points)
    if (const auto query = maker.query_by_edge()) queries.push_back(*query);
  const SignedDistance host(model);
  oracle::in_parallel(queries.size(), [&](std::size_t n) {
    Query& query = queries[n];
    query.distance = n < with_truth ? host(query.point, truth_tolerance) : Enclosure{-infinity, infinity};
    for (std::size_t i = 0; i < set_primitives; ++i) query.of_primitives[i] = (*hosts[i])(query.point, truth_tolerance);
  });
  for (Query& query : queries) maker.widen(query);
  return queries;
}

/// What the kernels say of a query.
struct Found {
  Enclosure distance;
  double edge;
  double others;
};

class Launcher {
 public:
  Launcher(const CompiledKernels& kernels, const Model& model)
      : kernels_(kernels),
        queue_(kernels.context, kernels.device),
        primitives_(device::uploaded_box_primitives(kernels, model, 0)) {}

  /// Both ends of all rows by set_bounds, from what each witness proves.
  [[nodiscard]] std::vector<Enclosure> bounded(const std::vector<EdgeRow>& rows) const {
    const auto column = [&](const auto& number) { return uploaded_column(rows, number); };
    const auto of_primitives = [&](const auto& number) { return uploaded_columns(rows, number); };
    const auto proven = [](const EdgeRow& row) { return (1.0 + rounding) * norm(between(row.query, row.witness)); };
    const std::array ends{
        column([&](const EdgeRow& row) { return row.complement ? -proven(row) : -infinity; }),
        column([&](const EdgeRow& row) { return row.complement ? infinity : proven(row); }),
    };
    const Axes centres = axes([&](std::size_t k) {
      return of_primitives([k](const EdgeRow& row, std::size_t i) { return row.centres[i][k]; });
    });
    const Axes points = axes([&](std::size_t k) { return column([k](const EdgeRow& row) { return row.query[k]; }); });
    const Axes feet = axes([&](std::size_t k) { return column([k](const EdgeRow& row) { return row.foot[k]; }); });
    run_bounds(rows.size(), points, column([](const EdgeRow& row) { return row.others; }),
               column([](const EdgeRow& row) { return row.edge; }), feet, centres,
               of_primitives([](const EdgeRow& row, std::size_t i) { return row.ball_his[i]; }), ends);
    return read_ends(ends, rows.size());
  }

  /// Enclosures of the queries' distances by set_feet and set_bounds.
  [[nodiscard]] std::vector<Found> enclosed(const std::vector<Query>& queries, const Hosts& hosts) const {
    const std::size_t size = queries.size();
    const std::size_t length = padded(size, kernels_);
    const auto of_primitives = [&](const auto& number) { return uploaded_columns(queries, number); };
    const cl::Buffer part_los = of_primitives([](const Query& q, std::size_t i) { return q.of_primitives[i].lo; });
    const cl::Buffer part_his = of_primitives([](const Query& q, std::size_t i) { return q.of_primitives[i].hi; });
    const Axes normals = axes(
        [&](std::size_t k) { return of_primitives([k](const Query& q, std::size_t i) { return q.normals[i][k]; }); });
    const Axes points =
        axes([&](std::size_t k) { return uploaded_column(queries, [k](const Query& q) { return q.point[k]; }); });
    // Of an earlier chunk.
    const cl::Buffer others = filled(length, 1e3);
    const cl::Buffer edges = filled(length, 1.0);
    const std::array ends{filled(length, 1e3), filled(length, -1e3)};
    const Axes feet = axes([&](std::size_t) { return filled(length, 0.5); });
    const Axes centres = axes([&](std::size_t) { return filled(set_primitives * length, 0.5); });
    const cl::Buffer wanted_balls = filled(set_primitives * length, infinity);
    run("set_feet", groups_of(length), groups_of(length), cl_ulong{length}, points[0], points[1], points[2],
        primitives_, tolerance, part_los, part_his, normals[0], normals[1], normals[2], ends[0], ends[1], others, edges,
        feet[0], feet[1], feet[2], centres[0], centres[1], centres[2], wanted_balls);
    run_bounds(size, points, others, edges, feet, centres, depths(hosts, size, wanted_balls, centres), ends);
    const std::vector<double> of_edges = read(queue_, edges, size);
    const std::vector<double> of_others = read(queue_, others, size);
    std::vector<Found> found;
    for (const Enclosure& distance : read_ends(ends, size))
      found.push_back({distance, of_edges[found.size()], of_others[found.size()]});
    return found;
  }

 private:
  using Axes = std::array<cl::Buffer, 3>;

  template <class Axis>
  [[nodiscard]] static Axes axes(const Axis& axis) {
    return {axis(0), axis(1), axis(2)};
  }

  [[nodiscard]] cl_ulong groups_of(std::size_t length) const {
    return length / static_cast<std::size_t>(kernels_.vector_width);
  }

  [[nodiscard]] cl::Buffer filled(std::size_t length, double value) const {
    return uploaded(kernels_, Columns{std::vector<double>(length, value)});
  }

  /// The last row fills the columns up.
  template <class Rows, class Number>
  [[nodiscard]] std::vector<double> column_of(const Rows& rows, const Number& number) const {
    std::vector<double> column(padded(rows.size(), kernels_));
    for (std::size_t n = 0; n < column.size(); ++n) column[n] = number(rows[std::min(n, rows.size() - 1)]);
    return column;
  }

  template <class Rows, class Number>
  [[nodiscard]] cl::Buffer uploaded_column(const Rows& rows, const Number& number) const {
    return uploaded(kernels_, Columns{column_of(rows, number)});
  }

  /// Primitive by primitive.
  template <class Rows, class Number>
  [[nodiscard]] cl::Buffer uploaded_columns(const Rows& rows, const Number& number) const {
    Columns columns;
    for (std::size_t i = 0; i < set_primitives; ++i)
      columns.push_back(column_of(rows, [&](const auto& row) { return number(row, i); }));
    return uploaded(kernels_, columns);
  }

  /// Of the balls that are wanted, by the host.
  [[nodiscard]] cl::Buffer depths(const Hosts& hosts, std::size_t size, const cl::Buffer& wanted_balls,
                                  const Axes& centres) const {
    const std::size_t length = padded(size, kernels_);
    const std::vector<double> wanted = read(queue_, wanted_balls, set_primitives * length);
    Columns at;
    for (const cl::Buffer& axis : centres) at.push_back(read(queue_, axis, set_primitives * length));
    std::vector<double> his(set_primitives * length, deep);
    oracle::in_parallel(his.size(), [&](std::size_t n) {
      const Point centre{at[0][n], at[1][n], at[2][n]};
      if (wanted[n] != infinity || !std::isfinite(norm(centre))) return;
      his[n] = (*hosts[n / length])(centre, tolerance).hi;
    });
    return uploaded(kernels_, Columns{his});
  }

  void run_bounds(std::size_t size, const Axes& points, const cl::Buffer& others, const cl::Buffer& edges,
                  const Axes& feet, const Axes& centres, const cl::Buffer& ball_his,
                  const std::array<cl::Buffer, 2>& ends) const {
    const std::size_t length = padded(size, kernels_);
    run("set_bounds", groups_of(length), groups_of(length), cl_ulong{length}, points[0], points[1], points[2],
        primitives_, others, edges, feet[0], feet[1], feet[2], centres[0], centres[1], centres[2], ball_his, ends[0],
        ends[1]);
  }

  [[nodiscard]] std::vector<Enclosure> read_ends(const std::array<cl::Buffer, 2>& ends, std::size_t size) const {
    const std::vector<double> los = read(queue_, ends[0], size);
    const std::vector<double> his = read(queue_, ends[1], size);
    std::vector<Enclosure> found;
    for (std::size_t n = 0; n < size; ++n) found.push_back({los[n], his[n]});
    return found;
  }

  template <class... Arguments>
  void run(const char* name, std::size_t work_items, const Arguments&... arguments) const {
    cl::Kernel kernel(kernels_.program, name);
    cl_uint next = 0;
    (kernel.setArg(next++, arguments), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(work_items));
    queue_.finish();  // a kernel does not keep the buffers that it is given
  }

  const CompiledKernels& kernels_;
  cl::CommandQueue queue_;
  cl::Buffer primitives_;
};

std::string described(const EdgeRow& row) {
  return fmt::format("edge {} of ({:.17g}, {:.17g}, {:.17g})", row.edge, row.query[0], row.query[1], row.query[2]);
}

/// A bound beyond the witness or the other terms, or another end moved. NaN is false.
std::string row_fault(const EdgeRow& row, const Enclosure& found) {
  const double distance = norm(between(row.query, row.witness));
  const double limit = (1.0 + rounding) * std::min(distance, row.others) + rounding;
  const double lower = row.complement ? -found.hi : found.lo;
  const double upper = row.complement ? -found.lo : found.hi;
  if (!(lower <= limit)) return fmt::format("{}: {:.17g}, at most {:.17g}", described(row), lower, limit);
  if (!(upper >= distance)) return fmt::format("{}: upper end {:.17g}", described(row), upper);
  return {};
}

std::string described(const Query& query, const Enclosure& found) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g}) gave [{:.17g}, {:.17g}]", query.point[0], query.point[1],
                     query.point[2], found.lo, found.hi);
}

/// The host's enclosure is missed. NaN misses everything.
std::string query_fault(const Query& query, const Enclosure& found) {
  const Enclosure& truth = query.distance;
  if (found.lo <= truth.hi + rounding && found.hi >= truth.lo - rounding) return {};
  return fmt::format("{}, the truth is in [{:.17g}, {:.17g}]", described(query, found), truth.lo, truth.hi);
}

bool in_both(double edge, const KnownPoint& known) {
  const auto number = static_cast<unsigned>(edge);
  const auto may_hold = [&](const Literal& literal) {
    return known.in_primitives[literal.primitive] != (literal.complement ? Membership::inside : Membership::outside);
  };
  return may_hold(literal_of(number >> 7U & 127U)) && may_hold(literal_of(number & 127U));
}

/// A point of a target that is nearer than said of the target, or of its terms other than the edge's.
std::string point_fault(const Query& query, const Found& found, const KnownPoint& known) {
  if (known.in_model == Membership::boundary) return {};
  const bool in_solid = known.in_model == Membership::inside;
  const double distance = (1.0 + rounding) * norm(between(query.point, known.point)) + rounding;
  if (!((in_solid ? found.distance.lo : -found.distance.hi) <= distance))
    return fmt::format("{}, a point is at {:.17g}", described(query, found.distance), distance);
  if (found.edge == no_edge || is_of_complement(found.edge) == in_solid) return {};
  if (found.others <= distance || in_both(found.edge, known)) return {};
  return fmt::format("{}: edge {}, other terms at {:.17g}, a point of theirs at {:.17g}",
                     described(query, found.distance), found.edge, found.others, distance);
}

}  // namespace

SetJudge::SetJudge(std::vector<SetScene> scenes) {
  for (SetScene& scene : scenes) {
    Maker maker(scene.model, scenes_.size());
    const Hosts hosts = hosts_of_primitives(scene.model);
    std::vector<EdgeRow> rows = rows_of(maker, hosts);
    std::vector<Query> queries = queries_of(maker, scene.model, hosts);
    std::vector<KnownPoint> points;
    for (std::size_t n = 0; n < known_points; ++n) points.push_back(maker.known_point());
    scenes_.push_back({std::move(scene), std::move(rows), std::move(queries), std::move(points)});
  }
}

std::string SetJudge::sources() {
  return device::model_source(set_scenes().front().model, kernels::embedded_set_bounds());
}

std::string SetJudge::false_claim(const CompiledKernels& kernels) const {
  for (const KnownScene& known : scenes_) {
    const Launcher launcher(kernels, known.scene.model);
    const std::vector<Enclosure> bounded = launcher.bounded(known.rows);
    for (std::size_t n = 0; n < bounded.size(); ++n) {
      const std::string fault = row_fault(known.rows[n], bounded[n]);
      if (!fault.empty()) return fmt::format("{}, row {}: {}", known.scene.name, n, fault);
    }
    const std::vector<Found> enclosed = launcher.enclosed(known.queries, hosts_of_primitives(known.scene.model));
    for (std::size_t n = 0; n < enclosed.size(); ++n) {
      std::string fault = query_fault(known.queries[n], enclosed[n].distance);
      for (const KnownPoint& point : known.points)
        if (fault.empty()) fault = point_fault(known.queries[n], enclosed[n], point);
      if (!fault.empty()) return fmt::format("{}, query {}: {}", known.scene.name, n, fault);
    }
  }
  return {};
}

}  // namespace verisq::mutation
