/// MPFR's functions at one end, and the Lipschitz constant 1 for the way to the other; the life of MPFR's own cache.
#include "verify/numbers/interval.hpp"

#include <algorithm>

namespace verisq::verify {

namespace {

struct MpfrCache {
  MpfrCache() = default;
  MpfrCache(const MpfrCache&) = delete;
  MpfrCache& operator=(const MpfrCache&) = delete;
  ~MpfrCache() { mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE); }
};

}  // namespace

void release_mpfr_cache_at_thread_exit() {
  [[maybe_unused]] static thread_local const MpfrCache cache;
}

namespace {

template <class Operation, class... Operands>
PreciseInterval both_ways(Operation operation, Operands... operands) {
  release_mpfr_cache_at_thread_exit();
  Real down;
  const int inexact = operation(down.get(), operands..., MPFR_RNDD);
  Real up = down;
  if (inexact != 0) mpfr_nextabove(up.get());
  return {down, up};
}

/// Encloses a function whose values and derivatives lie in [-1, 1].
template <class Operation>
PreciseInterval wave(Operation operation, const PreciseInterval& angle) {
  const PreciseInterval at_lower = both_ways(operation, angle.lower().get());
  const Real spread = subtract(angle.upper(), angle.lower(), Direction::up);
  return {std::max(Real(-1), subtract(at_lower.lower(), spread, Direction::down)),
          std::min(Real(1), add(at_lower.upper(), spread, Direction::up))};
}

/// f(a)/a of an odd f with |f(a)| <= |a| and f(a) = a - a³/divisor + ..., an alternating series whose terms fall for
/// |a| <= 1.
template <class Function>
PreciseInterval odd_quotient_of(const Function& f, const PreciseInterval& a, int divisor) {
  const PreciseInterval size = abs(a);
  if (size.upper() > Real(0x1p-64)) return size.lower() > Real(0) ? f(size) / size : PreciseInterval(-1, 1);
  return {(PreciseInterval(1) - square(size) / PreciseInterval(divisor)).lower(), Real(1)};
}

}  // namespace

PreciseInterval sine_of(const PreciseInterval& angle) {
  return wave(mpfr_sin, angle);
}

PreciseInterval cosine_of(const PreciseInterval& angle) {
  return wave(mpfr_cos, angle);
}

PreciseInterval arctangent_of(const PreciseInterval& a) {
  return {both_ways(mpfr_atan, a.lower().get()).lower(), both_ways(mpfr_atan, a.upper().get()).upper()};
}

PreciseInterval quotient_of_sine(const PreciseInterval& a) {
  return odd_quotient_of(sine_of, a, 6);
}

PreciseInterval quotient_of_arctangent(const PreciseInterval& a) {
  return odd_quotient_of(arctangent_of, a, 3);
}

PreciseInterval sine_of_degrees(double degrees) {
  const auto sine = [](mpfr_ptr y, mpfr_srcptr x, mpfr_rnd_t rounding) { return mpfr_sinu(y, x, 360, rounding); };
  return both_ways(sine, Real(degrees).get());
}

PreciseInterval cosine_of_degrees(double degrees) {
  const auto cosine = [](mpfr_ptr y, mpfr_srcptr x, mpfr_rnd_t rounding) { return mpfr_cosu(y, x, 360, rounding); };
  return both_ways(cosine, Real(degrees).get());
}

PreciseInterval half_turn() {
  return both_ways(mpfr_const_pi);
}

}  // namespace verisq::verify
