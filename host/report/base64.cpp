/// Boost's iterators, which know no padding: the last bytes are completed by zeros, and those said to be none.
#include "host/report/base64.hpp"

#include <algorithm>
#include <array>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

namespace verisq::report {
namespace {

using Digits = boost::archive::iterators::base64_from_binary<
    boost::archive::iterators::transform_width<const char*, 6, 8>>;  // 6 bits a digit, from bytes of 8

}  // namespace

std::string base64(std::span<const std::byte> bytes) {
  const auto* const begin = reinterpret_cast<const char*>(bytes.data());
  const std::size_t rest = bytes.size() % 3;
  const char* const end_of_whole = begin + (bytes.size() - rest);
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  text.append(Digits(begin), Digits(end_of_whole));
  if (rest == 0) return text;
  std::array<char, 3> last{};
  std::copy_n(end_of_whole, rest, last.begin());
  text.append(Digits(last.data()), Digits(last.data() + last.size()));
  text.replace(text.size() - (3 - rest), 3 - rest, 3 - rest, '=');
  return text;
}

}  // namespace verisq::report
