// Numbers as text: exact ends as they are, everything else rounded to the safe side and never more precise than useful.

// The shortest digits that give back the same binary64; infinities as in the program's own .csv.
export function exactText(number) {
  if (number === Infinity) return "inf";
  if (number === -Infinity) return "-inf";
  return Object.is(number, -0) ? "-0" : String(number);
}

// Few digits that are surely not above `number`. A text that reads as `number` itself may lie above it (decimal digits
// are read to the nearest binary64), so one unit less is taken, except for integers, whose digits are exact.
export function textBelow(number, digits = 5) {
  if (!Number.isFinite(number) || number === 0) return exactText(number);
  if (Math.abs(number) < 1e-290) return number < 0 ? "-1e-290" : "0"; // units of such numbers would underflow
  const text = number.toPrecision(digits);
  const isExact = Number.isInteger(number) && Math.abs(number) < 10 ** digits;
  if (isExact || Number(text) < number) return tidy(text);
  const unit = 10 ** (Math.floor(Math.log10(Math.abs(number))) - digits + 1);
  for (let steps = 1; ; ++steps) {
    const lower = (Number(text) - steps * unit).toPrecision(digits);
    if (Number(lower) < number) return tidy(lower);
  }
}

export function textAbove(number, digits = 5) {
  const text = textBelow(-number, digits);
  if (text === "-0" || text === "0") return "0";
  return text.startsWith("-") ? text.slice(1) : `-${text}`;
}

export function enclosureText(lo, hi, digits = 5) {
  return `[${textBelow(lo, digits)}, ${textAbove(hi, digits)}]`;
}

// Of ticks and edges of bins, which are round numbers up to rounding errors.
export function roundText(number) {
  return tidy(Number(number.toPrecision(6)).toString());
}

export function powerText(exponent) {
  const superscripts = {
    "-": "\u207b",
    0: "\u2070",
    1: "\u00b9",
    2: "\u00b2",
    3: "\u00b3",
    4: "\u2074",
    5: "\u2075",
    6: "\u2076",
    7: "\u2077",
    8: "\u2078",
    9: "\u2079",
  };
  return Number.isInteger(exponent)
    ? "10" + [...String(exponent)].map((digit) => superscripts[digit]).join("")
    : (10 ** exponent).toPrecision(2);
}

export const countText = (count) => count.toLocaleString("en");
const unitsOfLength = new Set(["m", "dm", "cm", "mm", "um", "µm", "μm", "nm", "km", "in", "inch", "ft"]);

// As behind a number on a terminal (host/errors/refusal.cpp): what is no unit of length stands in quotation marks,
// and nothing in it can break a line, turn the text round or pretend to be the page's own words.
export function shownUnits(units) {
  if (!units || unitsOfLength.has(units)) return units;
  const longest = 60;
  const signs = [...units];
  const shown = signs.slice(0, longest).map((sign) => {
    const isPlain = sign === " " || (/^[\p{L}\p{N}\p{P}\p{S}]$/u.test(sign) && sign !== '"' && sign !== "\\");
    return isPlain ? sign : `\\u{${sign.codePointAt(0).toString(16)}}`;
  });
  return `"${shown.join("")}${signs.length > longest ? "..." : ""}"`;
}

export const withUnits = (text, units) => (units ? `${text} ${units}` : text);

export function shareText(part, whole) {
  if (part === 0 || part === whole) return part === 0 ? "0 %" : "100 %";
  const percent = (100 * part) / whole;
  if (percent < 0.01) return "< 0.01 %";
  if (percent > 99.99) return "> 99.99 %";
  return `${percent < 1 || percent > 99 ? percent.toFixed(2) : percent.toFixed(1)} %`;
}

// 1, 2 or 5 times a power of ten, at least `number`.
export function roundStep(number) {
  const power = 10 ** Math.floor(Math.log10(number));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= number * (1 - 1e-12));
}

// About `wanted` round numbers within [from, to].
export function ticks(from, to, wanted = 5) {
  if (!(to > from)) return [from];
  const step = roundStep((to - from) / wanted);
  const result = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; ++k) result.push(k * step);
  return result;
}

function tidy(text) {
  const [mantissa, exponent] = text.split("e");
  const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
  return exponent === undefined ? short : `${short}e${exponent.replace("+", "")}`;
}
