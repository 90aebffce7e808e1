/// The contact problem in binary64, in long double and in 50 digits.
#include "verify/search/contact.hpp"

#include "verify/analysis/fifty_digits.hpp"
#include "verify/search/contact_problem.hpp"
#include "verify/search/tapered_contact_problem.hpp"

namespace verisq::verify {

namespace {

template <class Float>
Contact solve(const Superquadric& solid, const Proposal& q, const logarithmic::Resolution& resolution) {
  Contact contact = is_tapered(solid) ? logarithmic::TaperedContactProblem<Float>(solid, q, resolution).solve()
                                      : logarithmic::ContactProblem<Float>(solid, q, resolution).solve();
  // Lengths hundreds of decades apart exceed even logarithms; the ray from the centre is never useless.
  if (!usable(contact.point)) contact.point = q;
  if (!usable(contact.normal)) contact.normal = q;
  return contact;
}

}  // namespace

Contact rough_contact(const Superquadric& solid, const Proposal& q) {
  return solve<double>(solid, q, logarithmic::kResolution<double>);
}

Contact fast_contact(const Superquadric& solid, const Proposal& q) {
  return solve<long double>(solid, q, logarithmic::kResolution<long double>);
}

Contact thorough_contact(const Superquadric& solid, const Proposal& q) {
  release_mpfr_cache_at_thread_exit();
  return solve<FiftyDigits>(solid, q, {.surface = 1e-40, .step = 1e-25, .below_two = 0.0, .above_zero = 1e-18});
}

}  // namespace verisq::verify
