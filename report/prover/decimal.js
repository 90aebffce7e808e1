// Decimal text to the nearest binary64 number, ties to even; checked in whole numbers, because the language promises it
// of twenty digits only.
export function nearestBinary64(text) {
  const number = Number(text);
  if (!Number.isFinite(number)) throw new Error(`${text} is beyond binary64`);
  if (!isNearest(text, Math.abs(number))) throw new Error(`this browser does not read ${text} correctly`);
  return number;
}

const view = new DataView(new ArrayBuffer(8));

// A finite binary64 number is significand * 2^exponent.
export function partsOf(number) {
  view.setFloat64(0, number);
  const bits = view.getBigUint64(0);
  const exponent = Number((bits >> 52n) & 0x7ffn);
  const fraction = bits & ((1n << 52n) - 1n);
  return exponent === 0
    ? { significand: fraction, exponent: -1074, isPowerOfTwo: false }
    : { significand: fraction | (1n << 52n), exponent: exponent - 1075, isPowerOfTwo: fraction === 0n && exponent > 1 };
}

function isNearest(text, number) {
  const [, whole, fraction = "", power = "0"] = /^-?(\d+)(?:\.(\d+))?(?:[eE]([+-]?\d+))?$/.exec(text);
  const digits = BigInt(whole + fraction);
  const tens = Number(power) - fraction.length;
  if (digits === 0n) return number === 0;
  if (whole.length + fraction.length + tens < -400) return number === 0; // below a half of the smallest number
  const { significand, exponent, isPowerOfTwo } = partsOf(number);
  // Everything times 4 * 10^max(0, -tens) * 2^max(0, -exponent); below a power of two numbers lie twice as dense.
  const scaledTens = (k) => 10n ** BigInt(Math.max(0, k));
  const scaledTwos = (k) => 2n ** BigInt(Math.max(0, k));
  const exact = 4n * digits * scaledTens(tens) * scaledTwos(-exponent);
  const unit = scaledTwos(exponent) * scaledTens(-tens);
  const above = (4n * significand + 2n) * unit;
  const below = (4n * significand - (isPowerOfTwo ? 1n : 2n)) * unit;
  const isEven = significand % 2n === 0n;
  return isEven ? below <= exact && exact <= above : below < exact && exact < above;
}
