/// The paper's figures that the benchmarks repeat: the objects of Table 5 and the rows "GJK, point to SQ" of Table 6.
#pragma once

#include <array>
#include <string_view>
#include <verisq/model.hpp>

namespace verisq::bench {

/// One row of Table 6, measured by the paper's authors on a 1.6 GHz Core 2 Duo.
struct PaperPointDistance {
  double seconds;           ///< a point, floating-point GJK
  double verified_seconds;  ///< a point, with enclosure
  double absolute_error;    ///< width of the enclosure
  double relative_error;    ///< width divided by midpoint
};

struct BenchmarkObject {
  std::string_view name;
  Superquadric solid;
  PaperPointDistance paper;
};

/// Table 5 with Table 6 beside it. The paper's relative errors imply points some 100 units away; ours are closer.
inline constexpr std::array<BenchmarkObject, 3> table5_objects{{
    {"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}, {1.25e-5, 6.54e-4, 4.97e-5, 4.76e-7}},
    {"gem", {{0.43, 0.6, 1.9}, {1.5, 0.4}}, {9.3e-6, 6.54e-4, 3.185e-4, 3.083e-6}},
    {"soap", {{3.4, 4.3, 1.7}, {0.1, 0.1}}, {1.1e-5, 6.04e-4, 1.205e-5, 1.191e-7}},
}};

}  // namespace verisq::bench
