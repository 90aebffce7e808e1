/// The paper's figures that the benchmarks repeat: the objects of Table 5 and all rows of Tables 6 and 7.
#pragma once

#include <array>
#include <optional>
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

/// One goal of Table 7 on the same machine.
struct PaperSearch {
  double seconds;
  double width;  ///< of the enclosure
};

/// Two objects of Table 5, bent or not, in their own frames, and a pose of B. The paper does not print its poses: these
/// are ours, separated and off every plane of symmetry.
struct BenchmarkScenario {
  std::string_view name;
  Superquadric a;
  std::optional<Bend> bend_a;
  Superquadric b;
  std::optional<Bend> bend_b;
  Pose pose;
  PaperSearch coarse;               ///< with the goal 0.1
  std::optional<PaperSearch> fine;  ///< with the goal 0.01
};

inline constexpr Bend table7_capsule_bend{1e-5, 0.0};
inline constexpr Bend table7_soap_bend{0.001, 70.0};

inline constexpr Pose table7_capsule_gem{{3.1, 1.7, 2.3}, {0.7, 0.2, -0.5, 0.4}};
inline constexpr Pose table7_capsule_soap{{7.3, 3.9, 2.6}, {0.6, -0.3, 0.5, 0.7}};
inline constexpr Pose table7_gem_soap{{6.7, -4.1, 3.8}, {0.8, 0.45, 0.3, -0.2}};

inline constexpr std::array<BenchmarkScenario, 6> table7_scenarios{{
    {"capsule_gem",
     table5_objects[0].solid,
     {},
     table5_objects[1].solid,
     {},
     table7_capsule_gem,
     {85.0, 0.06},
     PaperSearch{574.0, 0.009}},
    {"capsule_soap",
     table5_objects[0].solid,
     {},
     table5_objects[2].solid,
     {},
     table7_capsule_soap,
     {33.0, 0.09},
     PaperSearch{557.0, 0.001}},
    {"gem_soap",
     table5_objects[1].solid,
     {},
     table5_objects[2].solid,
     {},
     table7_gem_soap,
     {38.0, 0.09},
     PaperSearch{344.0, 0.009}},
    {"bent_capsule_gem",
     table5_objects[0].solid,
     table7_capsule_bend,
     table5_objects[1].solid,
     {},
     table7_capsule_gem,
     {224.0, 0.09},
     {}},
    {"bent_capsule_bent_soap",
     table5_objects[0].solid,
     table7_capsule_bend,
     table5_objects[2].solid,
     table7_soap_bend,
     table7_capsule_soap,
     {1206.0, 0.17},
     {}},
    {"gem_bent_soap",
     table5_objects[1].solid,
     {},
     table5_objects[2].solid,
     table7_soap_bend,
     table7_gem_soap,
     {1284.0, 0.12},
     {}},
}};

}  // namespace verisq::bench
