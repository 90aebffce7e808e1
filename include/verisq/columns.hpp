/// Queries and rows of a map where the caller has them in memory: columns with any stride.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map_result.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Value i is first[i * stride]. A view: the memory must outlive it. A stride may be negative, of what is only read 0.
template <class Value>
struct Column {
  Value* first = nullptr;
  std::ptrdiff_t stride = 1;

  [[nodiscard]] Value& operator[](std::size_t i) const { return *at(i); }
  /// The column from value i on.
  [[nodiscard]] Column from(std::size_t i) const { return {at(i), stride}; }

 private:
  [[nodiscard]] Value* at(std::size_t i) const { return first + static_cast<std::ptrdiff_t>(i) * stride; }
};

/// Points wherever their coordinates lie.
class PointColumns {
 public:
  /// Points as they are, of stride 3: a vector or span of them.
  template <std::convertible_to<std::span<const Point>> Points>
  PointColumns(const Points& points) : PointColumns(of_points(points)) {}

  /// One column for each coordinate. Throws Error(input) unless they have one length.
  PointColumns(std::span<const double> x, std::span<const double> y, std::span<const double> z)
      : PointColumns(y.size() == x.size() && z.size() == x.size()
                         ? x.size()
                         : throw Error(ErrorKind::input, "the columns of the coordinates have different lengths"),
                     {x.data()}, {y.data()}, {z.data()}) {}

  PointColumns(std::size_t size, Column<const double> x, Column<const double> y, Column<const double> z)
      : size_(size), coordinates_{x, y, z} {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const std::array<Column<const double>, 3>& coordinates() const { return coordinates_; }
  [[nodiscard]] Point operator[](std::size_t i) const {
    return {coordinates_[0][i], coordinates_[1][i], coordinates_[2][i]};
  }

  /// Precondition: there are as many.
  [[nodiscard]] PointColumns subspan(std::size_t first, std::size_t count) const {
    return {count, coordinates_[0].from(first), coordinates_[1].from(first), coordinates_[2].from(first)};
  }

 private:
  static PointColumns of_points(std::span<const Point> points) {
    if (points.empty()) return {0, {}, {}, {}};
    const double* const first{points.front().data()};
    return {points.size(), {first, 3}, {first + 1, 3}, {first + 2, 3}};
  }

  std::size_t size_;
  std::array<Column<const double>, 3> coordinates_;
};

/// Where rows of a map go. Their values share memory neither with each other nor with the queries; columns that
/// interleave, like those of one record, are apart where their strides in bytes are the same.
class ResultColumns {
 public:
  /// Rows as they are.
  ResultColumns(std::span<MapResult> rows) : ResultColumns(of_rows(rows)) {}
  ResultColumns(std::vector<MapResult>& rows) : ResultColumns(of_rows(rows)) {}

  /// One column each. Throws Error(input) unless they have one length.
  ResultColumns(std::span<double> lo, std::span<double> hi, std::span<Status> status)
      : ResultColumns(hi.size() == lo.size() && status.size() == lo.size()
                          ? lo.size()
                          : throw Error(ErrorKind::input, "the columns of the rows have different lengths"),
                      {lo.data()}, {hi.data()}, {status.data()}) {}

  ResultColumns(std::size_t size, Column<double> lo, Column<double> hi, Column<Status> status)
      : size_(size), lo_(lo), hi_(hi), status_(status) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Column<double> lo() const { return lo_; }
  [[nodiscard]] Column<double> hi() const { return hi_; }
  [[nodiscard]] Column<Status> status() const { return status_; }
  [[nodiscard]] MapResult operator[](std::size_t i) const { return {{lo_[i], hi_[i]}, status_[i]}; }
  void set(std::size_t i, const MapResult& row) const {
    lo_[i] = row.distance.lo;
    hi_[i] = row.distance.hi;
    status_[i] = row.status;
  }

  /// Precondition: there are as many.
  [[nodiscard]] ResultColumns subspan(std::size_t first, std::size_t count) const {
    return {count, lo_.from(first), hi_.from(first), status_.from(first)};
  }

 private:
  static ResultColumns of_rows(std::span<MapResult> rows) {
    if (rows.empty()) return {0, ends(), ends(), {}};
    MapResult& first = rows[0];
    return {rows.size(), ends(&first.distance.lo), ends(&first.distance.hi), {&first.status, sizeof(MapResult)}};
  }

  static Column<double> ends(double* first = nullptr) { return {first, sizeof(MapResult) / sizeof(double)}; }

  std::size_t size_;
  Column<double> lo_;
  Column<double> hi_;
  Column<Status> status_;
};

/// All queries of a map: points wherever their coordinates lie, others as they are.
template <class Query>
struct QueriesInMemory {
  using type = std::span<const Query>;
};
template <>
struct QueriesInMemory<Point> {
  using type = PointColumns;
};

}  // namespace verisq
