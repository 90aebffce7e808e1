/// This file implements the checksum by Boost.CRC: maintained, header-only, and part of a library that we use anyway.
#include "host/opencl/checksum.hpp"

#include <boost/crc.hpp>

namespace verisq::device {

std::uint64_t checksum(std::string_view bytes) {
  boost::crc_optimal<64, 0x42F0E1EBA9EA3693, ~std::uint64_t{0}, ~std::uint64_t{0}, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

}  // namespace verisq::device
