/// Directed rounding of binary64.
#pragma once

#if defined(__FAST_MATH__)
#error "verisq proves rounding errors operation by operation: -ffast-math makes the proofs void"
#endif

namespace verisq::verify {

/// The side of the exact result on which a rounded result may lie.
enum class Direction { down, up };

// Each returns the tightest binary64 number on the given side of the exact result. This is the exact result itself if
// it is representable; an infinity or the largest finite number on overflow; a subnormal or zero on underflow. Operands
// are bounds of real numbers: 0 times an infinity is 0. An operation that has no value (infinity minus infinity, 0/0,
// the root of a negative number) returns NaN, which `Interval` refuses. The sign of a zero result is not specified.

[[nodiscard]] double add(double a, double b, Direction direction);
[[nodiscard]] double subtract(double a, double b, Direction direction);
[[nodiscard]] double multiply(double a, double b, Direction direction);
[[nodiscard]] double divide(double a, double b, Direction direction);
[[nodiscard]] double square_root(double a, Direction direction);

}  // namespace verisq::verify
