/// Elementary functions of binary64 by MPFR, and the life of MPFR's own cache.
#include "verify/numbers/real.hpp"

#include <cmath>

namespace verisq::verify {

namespace {

struct MpfrCache {
  MpfrCache() = default;
  MpfrCache(const MpfrCache&) = delete;
  MpfrCache& operator=(const MpfrCache&) = delete;
  ~MpfrCache() { mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE); }
};

using Binary64 = MpfrNumber<DBL_MANT_DIG>;

}  // namespace

bool is_integer(double a) {
  return std::isfinite(a) && std::trunc(a) == a;
}

void release_mpfr_cache_at_thread_exit() {
  [[maybe_unused]] static thread_local const MpfrCache cache;
}

double exponential(double a, Direction direction) {
  return exponential(Binary64(a), direction).to_double(direction);
}

double logarithm(double a, Direction direction) {
  return logarithm(Binary64(a), direction).to_double(direction);
}

double logarithm_1p(double a, Direction direction) {
  return logarithm_1p(Binary64(a), direction).to_double(direction);
}

double power(double base, double exponent, Direction direction) {
  return power(Binary64(base), Binary64(exponent), direction).to_double(direction);
}

}  // namespace verisq::verify
