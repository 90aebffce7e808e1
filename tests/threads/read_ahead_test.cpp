/// Reading ahead changes nothing of what is read, nor when its errors come.
#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>
#include <vector>

#include "host/threads/background_work.hpp"

namespace verisq {
namespace {

/// The numbers from 0 on; an error instead of the one at `fails_at`.
class Counting {
 public:
  using Element = std::size_t;

  explicit Counting(std::size_t count, std::size_t fails_at = static_cast<std::size_t>(-1))
      : count_(count), fails_at_(fails_at) {}

  std::size_t read(std::span<std::size_t> numbers) {
    const std::size_t part = std::min(numbers.size(), count_ - next_);
    if (next_ <= fails_at_ && fails_at_ < next_ + part) throw std::runtime_error("the number that fails");
    std::iota(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(part), next_);
    next_ += part;
    return part;
  }
  [[nodiscard]] double fraction(std::uint64_t done) const {
    return static_cast<double>(done) / static_cast<double>(count_);
  }

 private:
  std::size_t count_;
  std::size_t fails_at_;
  std::size_t next_ = 0;
};

TEST(ReadAhead, ReadsTheSame) {
  constexpr std::size_t all = 200'000;
  for (const std::size_t chunk : {std::size_t{7}, std::size_t{32768}, std::size_t{50'000}, all, all + 1}) {
    Counting stream(all);
    ReadAhead<Counting> ahead(stream);
    std::vector<std::size_t> numbers(chunk);
    std::size_t read = 0;
    for (std::size_t count = chunk; count == chunk;) {
      count = ahead.read(numbers);
      for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(numbers[k], read + k);
      read += count;
    }
    EXPECT_EQ(read, all);
    EXPECT_EQ(ahead.read(numbers), 0U);
    EXPECT_DOUBLE_EQ(ahead.fraction(all), 1.0);
    EXPECT_DOUBLE_EQ(ahead.fraction(all / 2), 0.5);
  }
}

TEST(ReadAhead, FailsWhereItsStreamFails) {
  constexpr std::size_t before = 65'536;
  Counting stream(200'000, before + 5);
  ReadAhead<Counting> ahead(stream);
  std::vector<std::size_t> numbers(before);
  EXPECT_EQ(ahead.read(numbers), before);
  EXPECT_EQ(numbers.back(), before - 1);
  EXPECT_THROW(ahead.read(numbers), std::runtime_error);
}

TEST(ReadAhead, EndsWhenNobodyReadsOn) {
  Counting stream(10'000'000);
  std::vector<std::size_t> numbers(10);
  ReadAhead<Counting> ahead(stream);
  EXPECT_EQ(ahead.read(numbers), 10U);
}

}  // namespace
}  // namespace verisq
