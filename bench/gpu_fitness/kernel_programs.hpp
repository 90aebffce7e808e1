/// The OpenCL programs that the library compiles, as texts: what is looked at before a graphics processor is at hand.
#pragma once

#include <string>
#include <vector>

namespace verisq::bench {

struct KernelProgram {
  std::string name;
  std::string source;
  std::string options;  ///< besides those that all have
};

/// All of them; those for models with bends or set operations for examples/bent_stem.json, in the folder `examples`.
[[nodiscard]] std::vector<KernelProgram> kernel_programs(const std::string& examples);

}  // namespace verisq::bench
