/// What the searches of docs/mathematics.md §20 are given: who encloses signed distances, who works in parallel, how
/// narrow results shall be, and when to end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Fills each row with an enclosure of the signed distance of its point, to a model or to one primitive of it. False
/// where it ended early: the rows mean nothing then. Precondition: as many rows as points.
using SignedDistances = std::function<bool(std::span<const Point> points, std::span<Enclosure> rows)>;

/// Calls work(i) once for each i below `count`, in any order, by several threads.
using Parallel = std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)>;

struct DeviationSearch {
  SignedDistances to_model;
  /// To each primitive by itself; empty unless the model is a union of several convex ones.
  std::vector<SignedDistances> to_primitives = {};
  /// To each primitive by itself, whatever the model is; empty where it has one and no set operations.
  std::vector<SignedDistances> to_each_primitive = {};
  bool convex = false;                    ///< the model is one convex primitive
  std::function<double(double)> allowed;  ///< how wide an enclosure with this lower end may be; rises with it
  Parallel in_parallel;
  std::function<bool()> ended;             ///< polled; once true it stays so
  std::function<void(double)> progress;    ///< how much is done, from 0 to 1, about
  std::uint64_t most_samples = 1U << 24U;  ///< distances asked for, about
};

}  // namespace verisq::verify
