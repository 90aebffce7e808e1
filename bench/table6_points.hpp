/// The rows "point to SQ" of Table 6: every tool on the same points outside one object of Table 5.
#pragma once

#include <span>
#include <verisq/device.hpp>
#include <verisq/model.hpp>

#include "bench/paper_tables.hpp"
#include "bench/query_rows.hpp"

namespace verisq::bench {

class Table6Points {
 public:
  explicit Table6Points(const BenchmarkObject& object);
  Table6Points(const Table6Points&) = delete;
  Table6Points& operator=(const Table6Points&) = delete;

  /// The rows refer to this object.
  void add_rows(std::span<const DeviceReport> devices) const;

 private:
  void add_device_rows(const DeviceReport& device) const;

  Primitive solid_;
  Model model_;
  Queries<Point> queries_;
};

}  // namespace verisq::bench
