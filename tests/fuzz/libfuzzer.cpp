/// libFuzzer's entry point, built once for each target: VERISQ_FUZZ_TARGET is the name of its function.
#include <cstddef>

#include "tests/fuzz/targets.hpp"

/// An exception that leaves the target ends the process, which libFuzzer reports as a crash.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  verisq::fuzz::VERISQ_FUZZ_TARGET({data, size});
  return 0;
}
