/// The paper's figures that the benchmarks repeat: the objects of Table 5 and all rows of Table 6.
#pragma once

#include <array>
#include <string_view>
#include <verisq/model.hpp>

namespace verisq::bench {

/// One row of Table 6, measured by the paper's authors on a 1.6 GHz Core 2 Duo.
struct PaperDistance {
  double seconds;           ///< a query in floating point
  double verified_seconds;  ///< a query with enclosure
  double absolute_error;    ///< width of the enclosure
  double relative_error;    ///< width divided by midpoint
};

struct BenchmarkObject {
  std::string_view name;
  Superquadric solid;
  PaperDistance paper;  ///< "GJK, point to SQ"
  PaperDistance paper_ipopt;
};

/// Table 5 with Table 6 beside it. The paper's relative errors imply points some 100 units away; ours are closer.
inline constexpr std::array<BenchmarkObject, 3> table5_objects{{
    {"capsule",
     {{0.75, 0.75, 1.0}, {1.0, 0.8}},
     {1.25e-5, 6.54e-4, 4.97e-5, 4.76e-7},
     {0.0263, 0.0275, 2.095e-7, 2.773e-8}},
    {"gem",
     {{0.43, 0.6, 1.9}, {1.5, 0.4}},
     {9.3e-6, 6.54e-4, 3.185e-4, 3.083e-6},
     {0.0476, 0.0573, 4.456e-7, 6.442e-8}},
    {"soap",
     {{3.4, 4.3, 1.7}, {0.1, 0.1}},
     {1.1e-5, 6.04e-4, 1.205e-5, 1.191e-7},
     {0.0434, 0.0459, 2.092e-7, 4.959e-8}},
}};

/// Two objects of Table 5 and the rows "SQ to SQ". The paper does not print its poses.
struct BenchmarkPair {
  std::string_view name;
  Superquadric a;
  Superquadric b;
  PaperDistance paper;
  PaperDistance paper_ipopt;
};

inline constexpr std::array<BenchmarkPair, 3> table6_pairs{{
    {"capsule_gem",
     table5_objects[0].solid,
     table5_objects[1].solid,
     {7.8e-5, 1.39e-3, 1.551e-5, 1.51e-7},
     {0.079, 0.0837, 2.906e-8, 2.81e-10}},
    {"gem_soap",
     table5_objects[1].solid,
     table5_objects[2].solid,
     {8.27e-6, 1.37e-3, 6.707e-5, 6.767e-7},
     {0.0996, 0.1032, 1.09e-7, 1.0882e-10}},
    {"capsule_soap",
     table5_objects[0].solid,
     table5_objects[2].solid,
     {7.64e-5, 1.34e-3, 1.753e-5, 1.76e-7},
     {0.092, 0.0927, 2.815e-8, 2.854e-10}},
}};

}  // namespace verisq::bench
