// What is proven, in words that say neither more nor less than the proof does.
import { surelyAbove, surelyBelow } from "./intervals.js";

// Rounded down: 100 % is all of it, and nothing else is.
const share = (part) => `${Math.floor(1e7 * part) / 1e5} %`;

export function equilibriumWords(result) {
  const { stands, not_on_all, not_on_all_within: reach } = result;
  const words = [];
  if (stands === 1) {
    words.push(["good", "Proven: for all parameters in these ranges, the body has an equilibrium on all of its cylinders."]);
  } else {
    const verdict = stands > 0 ? "warn" : "bad";
    words.push([verdict, `Proven for ${share(stands)} of the ranges only: an equilibrium on all cylinders.`]);
    words.push(["", `Proven that there is none within ${reach.rad} rad and ${reach.m} m of the file's posture: ${share(not_on_all)}. Neither is proven (open): ${share(result.open)}.`]);
  }
  words.push(["", "In equilibrium forces balance. Whether the body stays there or topples is not said by that, but by its stability."]);
  return words;
}

export function stabilityWords(result) {
  const words = [];
  if (result.stable === 1) {
    words.push(["good", "Proven STABLE: for all parameters in these ranges, the body returns to rest after every disturbance that is small enough, in whatever joint or direction."]);
  } else if (result.unstable === 1) {
    words.push(["bad", "Proven UNSTABLE: for all parameters in these ranges, some disturbances grow, however small they are. The body does not stay there by itself."]);
  } else {
    words.push(["warn", `Proven stable for ${share(result.stable)} of the ranges, unstable for ${share(result.unstable)}. Neither is proven (open): ${share(result.open)}.`]);
  }
  words.push(["", "How large a disturbance may be is not said: a stable body may topple when it is pushed hard."]);
  return words;
}

// How long disturbances take: ln 2 / |rate|, rounded outward.
export function paceWords({ lo, hi }) {
  const time = (rate) => Math.LN2 / Math.abs(rate);
  if (hi < 0) return `In the end, the slowest disturbance halves in ${surelyBelow(time(lo))} to ${surelyAbove(time(hi))} s.`;
  if (lo > 0) return `In the end, the fastest disturbance doubles in ${surelyBelow(time(hi))} to ${surelyAbove(time(lo))} s.`;
  return "";
}

export function motionWords(result, duration) {
  if (result.proven) {
    return [["good", `Proven from 0 to ${duration} s: whatever the parameters in these ranges are, every quantity is between its two curves at all times.`]];
  }
  const reason = result.open ? `: ${result.open}` : "";
  const why = result.open ? "OPEN" : "not computed (interrupted)";
  return [
    result.reached > 0
      ? ["warn", `Proven from 0 to ${surelyBelow(result.reached, 6)} s.`]
      : ["bad", "Nothing is proven of this motion."],
    ["bad", `From there to ${duration} s: ${why}${reason}. Nothing is said of these times: neither that the body falls nor that it stands.`],
  ];
}
