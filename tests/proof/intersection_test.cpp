/// Proofs that contradict each other are noticed, with all that a report needs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "verify/proof/verdict.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string what() {
  return "the distance at " + text_of({1.0, 0.1, -2e300});
}

TEST(IntersectionTest, KeepsWhatBothContain) {
  EXPECT_EQ(intersection({1.0, 3.0}, {2.0, 4.0}, what), (Enclosure{2.0, 3.0}));
  EXPECT_EQ(intersection({-infinity, infinity}, {2.0, 4.0}, what), (Enclosure{2.0, 4.0}));
  EXPECT_EQ(intersection({1.0, 2.0}, {2.0, 4.0}, what), (Enclosure{2.0, 2.0}));
  EXPECT_EQ(between(-1.0, infinity, what), (Enclosure{-1.0, infinity}));
}

struct Contradiction {
  Enclosure a, b;
  const char* text;
};

TEST(IntersectionTest, NamesBothWhereTheyHaveNothingInCommon) {
  for (const Contradiction& c : {Contradiction{{1.0, 2.0}, {3.0, 4.0}, "[1, 2] and in [3, 4]"},
                                 Contradiction{{3.0, 4.0}, {1.0, 2.0}, "[3, 4] and in [1, 2]"},
                                 Contradiction{{3.0, 2.0}, {1.0, 9.0}, "[3, 2] and in [1, 9]"},
                                 Contradiction{{nan, nan}, {1.0, 9.0}, "and in [1, 9]"}}) {
    const auto intersect = [&c] { (void)intersection(c.a, c.b, what); };
    EXPECT_THAT(intersect, ThrowsMessage<Error>(AllOf(HasSubstr(c.text), HasSubstr("at (1, 0.1, -2e+300)"),
                                                      HasSubstr("please report"))));
  }
  EXPECT_THAT([] { (void)between(2.0, 1.0, what); }, ThrowsMessage<Error>(HasSubstr("[2, inf] and in [-inf, 1]")));
}

TEST(IntersectionTest, IsNotTheUsersFault) {
  try {
    (void)between(2.0, 1.0, what);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failure);
  }
}

TEST(IntersectionTest, AnEmptyEnclosureIsNotVerified) {
  EXPECT_TRUE(verified({1.0, 1.5}, 0.5));
  EXPECT_FALSE(verified({1.5, 1.0}, 0.5));
  EXPECT_FALSE(verified({nan, nan}, 0.5));
}

}  // namespace
}  // namespace verisq::verify
