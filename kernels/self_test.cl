// This file implements the self-test's way into the arithmetic layers: one operation applied to arrays of operands.

kernel void apply_operation(uint operation, ulong groups, global const double* as, global const double* bs,
                            global const double* cs, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const real a = LOAD(group, as);
  const real b = LOAD(group, bs);
  const real c = LOAD(group, cs);
  real result = REAL(NAN);
  switch (operation) { // numbered as in host/device/self_test.cpp
    case 0: result = a + b; break;
    case 1: result = a - b; break;
    case 2: result = a * b; break;
    case 3: result = a / b; break;
    case 4: result = sqrt(a); break;
    case 5: result = fma(a, b, c); break;
    case 6: result = a * b + c; break; // two roundings, unless the compiler contracts them
    case 7: result = add_down(a, b); break;
    case 8: result = add_up(a, b); break;
    case 9: result = sub_down(a, b); break;
    case 10: result = sub_up(a, b); break;
    case 11: result = mul_down(a, b); break;
    case 12: result = mul_up(a, b); break;
    case 13: result = div_down(a, b); break;
    case 14: result = div_up(a, b); break;
    case 15: result = fma_down(a, b, c); break;
    case 16: result = fma_up(a, b, c); break;
    case 17: result = sqrt_down(a); break;
    case 18: result = sqrt_up(a); break;
    case 19: result = exp_down(a); break;
    case 20: result = exp_up(a); break;
    case 21: result = log_down(a); break;
    case 22: result = log_up(a); break;
    case 23: result = pow_unit_down(a, b); break;
    case 24: result = pow_unit_up(a, b); break;
    case 25: result = atan_ratio_down(a); break;
    case 26: result = atan_ratio_up(a); break;
    case 27: result = least_or_nan(a, b); break;
    case 28: result = greatest_or_nan(a, b); break;
    case 29: result = log_norm_up(a, b, 2.0, 0.5); break;
    default: break;
  }
  STORE(result, group, results);
}

kernel void apply_interval_operation(uint operation, ulong groups, global const double* as_lo,
                                     global const double* as_hi, global const double* bs_lo,
                                     global const double* bs_hi, global double* results_lo,
                                     global double* results_hi) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const interval a = interval_of(LOAD(group, as_lo), LOAD(group, as_hi));
  const interval b = interval_of(LOAD(group, bs_lo), LOAD(group, bs_hi));
  interval result = interval_entire();
  switch (operation) { // numbered as in host/device/sample_operations.cpp
    case 0: result = interval_neg(a); break;
    case 1: result = interval_abs(a); break;
    case 2: result = interval_square(a); break;
    case 3: result = interval_sqrt(a); break;
    case 4: result = interval_exp(a); break;
    case 5: result = interval_log(a); break;
    case 6: result = interval_add(a, b); break;
    case 7: result = interval_sub(a, b); break;
    case 8: result = interval_mul(a, b); break;
    case 9: result = interval_div(a, b); break;
    case 10: result = interval_pow(a, b); break;
    case 11: result = interval_scaled_add(a.lo, b, a); break;
    case 12: result = interval_min(a, b); break;
    case 13: result = interval_max(a, b); break;
    case 14: result = interval_hull(a, b); break;
    case 15: result = interval_intersection(a, b); break;
    case 16: result = interval_atan_ratio(a); break;
    default: break;
  }
  STORE(result.lo, group, results_lo);
  STORE(result.hi, group, results_hi);
}
