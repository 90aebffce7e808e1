/// A stream whose first elements are read before a device is chosen: a map of few rows is not worth a device's start.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/map.hpp>

namespace verisq::command_line {

/// As `Stream` (see PointStream), which must outlive this.
template <class Stream>
class PeekedStream {
 public:
  using Element = typename Stream::Element;

  /// Reads one element more than are few. Throws as `Stream`.
  explicit PeekedStream(Stream& stream) : stream_(stream), peeked_(few_rows + 1) {
    peeked_.resize(stream_.read(peeked_));
  }

  [[nodiscard]] bool has_few() const { return peeked_.size() <= few_rows; }

  /// Fills `elements` from the front; returns how many, fewer than asked only at the end. Throws as `Stream`.
  std::size_t read(std::span<Element> elements) {
    const std::size_t count = std::min(elements.size(), peeked_.size() - delivered_);
    std::copy_n(peeked_.begin() + static_cast<std::ptrdiff_t>(delivered_), count, elements.begin());
    delivered_ += count;
    return has_few() ? count : count + stream_.read(elements.subspan(count));
  }

  [[nodiscard]] double fraction(std::uint64_t done) const { return stream_.fraction(done); }

 private:
  Stream& stream_;
  std::vector<Element> peeked_;
  std::size_t delivered_ = 0;
};

/// What `--device` stands for: "auto" leaves few rows to the host.
template <class Stream>
[[nodiscard]] std::string device_for(const PeekedStream<Stream>& stream, const std::string& requested) {
  return requested == "auto" && stream.has_few() ? "host" : requested;
}

}  // namespace verisq::command_line
