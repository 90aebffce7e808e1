/// Whether a device's enclosures hold: random cases of every kind of query beside MPFR and the host's own proofs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace verisq::bench {

struct SoundnessSample {
  std::string queries;  ///< "points", "triangles", "pairs", "solids", "octree"
  std::string judge;    ///< "MPFR at 200 bits", "host"
  std::size_t cases;
  std::size_t by_device;           ///< of these, what the device itself proved
  std::vector<std::string> wrong;  ///< one line a case whose enclosure cannot be right
};

/// `device` as MapOptions take it; `bent_stem` is examples/bent_stem.json.
[[nodiscard]] std::vector<SoundnessSample> sampled_soundness(const std::string& device, const std::string& bent_stem);

}  // namespace verisq::bench
