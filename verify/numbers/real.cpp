/// The life of MPFR's own cache.
#include "verify/numbers/real.hpp"

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

}  // namespace verisq::verify
