/// The rows "SQ to SQ" of Table 6: every tool on the same poses of one object of Table 5 beside another.
#pragma once

#include <span>
#include <verisq/device.hpp>
#include <verisq/model.hpp>

#include "bench/paper_tables.hpp"
#include "bench/query_rows.hpp"

namespace verisq::bench {

class Table6Pairs {
 public:
  explicit Table6Pairs(const BenchmarkPair& pair);
  Table6Pairs(const Table6Pairs&) = delete;
  Table6Pairs& operator=(const Table6Pairs&) = delete;

  /// The rows refer to this object.
  void add_rows(std::span<const DeviceReport> devices) const;

 private:
  void add_device_rows(const DeviceReport& device) const;

  Primitive a_;
  Primitive b_;
  Queries<Pose> queries_;
};

}  // namespace verisq::bench
