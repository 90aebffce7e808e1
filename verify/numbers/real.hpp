/// Floating-point numbers of a fixed, higher precision with directed rounding: MPFR without heap and without state.
#pragma once

#include <mpfr.h>

#include <array>
#include <cfloat>

#include "verify/numbers/rounding.hpp"

namespace verisq::verify {

[[nodiscard]] constexpr mpfr_rnd_t mpfr_rounding(Direction direction) {
  return direction == Direction::down ? MPFR_RNDD : MPFR_RNDU;
}

/// An MPFR number that keeps its digits inside the object (MPFR's documented custom interface), so that it is copied
/// like a double and owns nothing. Relies on MPFR's default exponent range, which no code of this library changes.
template <mpfr_prec_t Bits>
class MpfrNumber {
 public:
  MpfrNumber() { mpfr_custom_init_set(value_, MPFR_ZERO_KIND, 0, Bits, limbs_.data()); }
  MpfrNumber(double value) : MpfrNumber() {  // NOLINT(google-explicit-constructor): exact
    static_assert(Bits >= DBL_MANT_DIG);
    mpfr_set_d(value_, value, MPFR_RNDN);
  }
  MpfrNumber(long double value) : MpfrNumber() {  // NOLINT(google-explicit-constructor): exact
    static_assert(Bits >= LDBL_MANT_DIG);
    mpfr_set_ld(value_, value, MPFR_RNDN);
  }
  MpfrNumber(int value) : MpfrNumber(static_cast<double>(value)) {}  // NOLINT(google-explicit-constructor): exact
  MpfrNumber(const MpfrNumber& other) { *this = other; }
  MpfrNumber& operator=(const MpfrNumber& other) {
    limbs_ = other.limbs_;
    value_[0] = other.value_[0];
    mpfr_custom_move(value_, limbs_.data());
    return *this;
  }
  ~MpfrNumber() = default;

  [[nodiscard]] mpfr_srcptr get() const { return value_; }
  [[nodiscard]] mpfr_ptr get() { return value_; }

  [[nodiscard]] double to_double(Direction direction) const { return mpfr_get_d(value_, mpfr_rounding(direction)); }
  /// Rounds to nearest: for floating-point proposals, never for bounds.
  [[nodiscard]] long double to_long_double() const { return mpfr_get_ld(value_, MPFR_RNDN); }

  friend MpfrNumber operator-(const MpfrNumber& a) {
    MpfrNumber result;
    mpfr_neg(result.get(), a.get(), MPFR_RNDN);
    return result;
  }
  friend bool operator<(const MpfrNumber& a, const MpfrNumber& b) { return mpfr_less_p(a.get(), b.get()) != 0; }
  friend bool operator>(const MpfrNumber& a, const MpfrNumber& b) { return mpfr_greater_p(a.get(), b.get()) != 0; }
  friend bool operator<=(const MpfrNumber& a, const MpfrNumber& b) { return mpfr_lessequal_p(a.get(), b.get()) != 0; }
  friend bool operator>=(const MpfrNumber& a, const MpfrNumber& b) {
    return mpfr_greaterequal_p(a.get(), b.get()) != 0;
  }
  friend bool operator==(const MpfrNumber& a, const MpfrNumber& b) { return mpfr_equal_p(a.get(), b.get()) != 0; }

 private:
  static constexpr std::size_t kLimbs = (Bits + GMP_NUMB_BITS - 1) / GMP_NUMB_BITS;
  std::array<mp_limb_t, kLimbs> limbs_{};
  mpfr_t value_;
};

/// Two limbs less one bit: MPFR's fastest kernels serve precisions strictly between one and two limbs.
using Real = MpfrNumber<127>;

template <mpfr_prec_t Bits>
[[nodiscard]] bool is_integer(const MpfrNumber<Bits>& a) {
  return mpfr_integer_p(a.get()) != 0;
}
[[nodiscard]] bool is_integer(double a);

/// MPFR keeps constants such as log 2 for each thread; this frees them when the calling thread ends.
void release_mpfr_cache_at_thread_exit();

template <mpfr_prec_t Bits, class Operation, class... Operands>
[[nodiscard]] MpfrNumber<Bits> rounded_result(Operation operation, Direction direction, Operands... operands) {
  MpfrNumber<Bits> result;
  operation(result.get(), operands..., mpfr_rounding(direction));
  return result;
}

// The same contract as the binary64 functions of rounding.hpp.

template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> add(const MpfrNumber<Bits>& a, const MpfrNumber<Bits>& b, Direction direction) {
  return rounded_result<Bits>(mpfr_add, direction, a.get(), b.get());
}

template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> subtract(const MpfrNumber<Bits>& a, const MpfrNumber<Bits>& b, Direction direction) {
  return rounded_result<Bits>(mpfr_sub, direction, a.get(), b.get());
}

template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> multiply(const MpfrNumber<Bits>& a, const MpfrNumber<Bits>& b, Direction direction) {
  if (mpfr_zero_p(a.get()) || mpfr_zero_p(b.get())) return {};
  return rounded_result<Bits>(mpfr_mul, direction, a.get(), b.get());
}

template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> divide(const MpfrNumber<Bits>& a, const MpfrNumber<Bits>& b, Direction direction) {
  return rounded_result<Bits>(mpfr_div, direction, a.get(), b.get());
}

template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> square_root(const MpfrNumber<Bits>& a, Direction direction) {
  return rounded_result<Bits>(mpfr_sqrt, direction, a.get());
}

/// base^exponent for base >= 0
template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> power(const MpfrNumber<Bits>& base, const MpfrNumber<Bits>& exponent,
                                     Direction direction) {
  release_mpfr_cache_at_thread_exit();
  // To MPFR -0 is a negative number: its odd negative powers are -infinity.
  const MpfrNumber<Bits> unsigned_base = mpfr_zero_p(base.get()) ? MpfrNumber<Bits>() : base;
  return rounded_result<Bits>(mpfr_pow, direction, unsigned_base.get(), exponent.get());
}

/// The power at binary64, which has no directed elementary functions of its own: MPFR at 53 bits, then to binary64 in
/// the same direction. The second step is exact but for overflow and underflow, where rounding twice in one direction
/// is rounding once.
[[nodiscard]] double power(double base, double exponent, Direction direction);

}  // namespace verisq::verify
