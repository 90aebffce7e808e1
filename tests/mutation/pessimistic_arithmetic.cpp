/// Replaces the few lines of the kernels that say how far results are rounded.
#include "tests/mutation/pessimistic_arithmetic.hpp"

#include <span>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array below{
    Mutant{"step", "c - fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA))",
           "c - fma(REAL(0x1p-24), fabs(c), REAL(ROUNDING_ETA))"},
    Mutant{"exp", "fma(e, REAL(-ELEMENTARY_WIDENING), e)", "fma(e, REAL(-0x1p-24), e)"},
    Mutant{"log", "fma(fabs(l), REAL(-ELEMENTARY_WIDENING), l)", "fma(fabs(l), REAL(-0x1p-24), l)"},
};

constexpr std::array above{
    Mutant{"step", "c + fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA))",
           "c + fma(REAL(0x1p-24), fabs(c), REAL(ROUNDING_ETA))"},
    Mutant{"exp", "fma(e, REAL(ELEMENTARY_WIDENING), e)", "fma(e, REAL(0x1p-24), e)"},
    Mutant{"log", "fma(fabs(l), REAL(ELEMENTARY_WIDENING), l)", "fma(fabs(l), REAL(0x1p-24), l)"},
};

constexpr std::array pose{
    // 0.57 in each coordinate is 0.987 of the bound; a bit of x tells which way.
    Mutant{"local point",
           "  local_q.point.x = fabs(q.x);\n  local_q.point.y = fabs(q.y);\n  local_q.point.z = fabs(q.z);\n", R"(
#define POSE_MAGNIFICATION 0x1p33
  const real bound = (s->pose_error * POSE_MAGNIFICATION) * (fabs(d.x) + fabs(d.y) + fabs(d.z));
  const real shift = select(0.57 * bound, -0.57 * bound, MASK((BITS(x.x) & INTEGER(1L << 20)) == INTEGER(0)));
  local_q.point.x = fabs(fabs(q.x) + shift);
  local_q.point.y = fabs(fabs(q.y) + shift);
  local_q.point.z = fabs(fabs(q.z) + shift);
)"},
    Mutant{"its error bound", "REAL(s->pose_error)", "REAL(s->pose_error * POSE_MAGNIFICATION)"},
};

constexpr std::array products{
    Mutant{"mul", "{ return step_up(a * b); }", "{ return step_up(fma(fabs(a * b), REAL(0x1p-24), a * b)); }"},
    Mutant{"div", "{ return step_up(a / b); }", "{ return step_up(fma(fabs(a / b), REAL(0x1p-24), a / b)); }"},
    Mutant{"sub", "{ return step_up(a - b); }", "{ return step_up(fma(fabs(a - b), REAL(0x1p-24), a - b)); }"},
};

constexpr std::array dot{
    Mutant{"dot", "fma_up(a.x, b.x, fma_up(a.y, b.y, mul_up(a.z, b.z)))",
           "mul_up(REAL(1.0 + 0x1p-20), fma_up(a.x, b.x, fma_up(a.y, b.y, mul_up(a.z, b.z))))"},
};

constexpr std::array search{
    Mutant{"limit", "#define SPLIT_LIMIT 4096", "#define SPLIT_LIMIT 128"},
    Mutant{
        "tangent planes", "  return plane;\n",
        "  plane.distance *= 1.0 + TO_REAL((BITS(plane.distance) >> 8) & INTEGER(255L)) * 0x1p-8;\n  return plane;\n"},
};

std::string changed(std::string sources, std::span<const Mutant> changes) {
  for (const Mutant& change : changes) sources = mutated(std::move(sources), change);
  return sources;
}

}  // namespace

std::string_view name_of(Arithmetic arithmetic) {
  switch (arithmetic) {
    case Arithmetic::usual: return "usual";
    case Arithmetic::loose_below: return "loose below";
    case Arithmetic::loose_above: return "loose above";
    case Arithmetic::loose_products: return "loose products";
    case Arithmetic::loose_dot: return "loose dot";
    case Arithmetic::poor_search: break;
  }
  return "poor search";
}

std::string on(Arithmetic arithmetic, std::string sources) {
  switch (arithmetic) {
    case Arithmetic::usual: return sources;
    case Arithmetic::loose_below: return changed(changed(std::move(sources), pose), below);
    case Arithmetic::loose_above: return changed(changed(std::move(sources), pose), above);
    case Arithmetic::loose_products: return changed(std::move(sources), products);
    case Arithmetic::loose_dot: return changed(std::move(sources), dot);
    case Arithmetic::poor_search: break;
  }
  return changed(std::move(sources), search);
}

}  // namespace verisq::mutation
