// SHA-256 (FIPS 180-4) of a text's UTF-8 bytes: the browser's own serves secure pages alone.

const isPrime = (n) => {
  for (let d = 2; d * d <= n; ++d) if (n % d === 0) return false;
  return true;
};
const primes = (count) => {
  const found = [];
  for (let n = 2; found.length < count; ++n) if (isPrime(n)) found.push(n);
  return found;
};

// The first 32 bits behind the point of a prime's root: of the integer root of the prime times 2^(32 k).
function rootBits(prime, degree) {
  const power = BigInt(prime) << BigInt(32 * degree);
  let low = 0n;
  let high = 1n << 40n;
  while (high - low > 1n) {
    const middle = (low + high) / 2n;
    if (middle ** BigInt(degree) <= power) low = middle;
    else high = middle;
  }
  return Number(low & 0xffffffffn);
}

const rotated = (x, by) => (x >>> by) | (x << (32 - by));

export function sha256(text) {
  const constants = primes(64).map((prime) => rootBits(prime, 3));
  const state = Uint32Array.from(primes(8).map((prime) => rootBits(prime, 2)));
  const bytes = new TextEncoder().encode(text);
  const padded = new Uint8Array(64 * Math.ceil((bytes.length + 9) / 64));
  padded.set(bytes);
  padded[bytes.length] = 0x80;
  const view = new DataView(padded.buffer);
  view.setBigUint64(padded.length - 8, 8n * BigInt(bytes.length));
  const w = new Uint32Array(64);
  for (let block = 0; block < padded.length; block += 64) {
    for (let t = 0; t < 16; ++t) w[t] = view.getUint32(block + 4 * t);
    for (let t = 16; t < 64; ++t) {
      const s0 = rotated(w[t - 15], 7) ^ rotated(w[t - 15], 18) ^ (w[t - 15] >>> 3);
      const s1 = rotated(w[t - 2], 17) ^ rotated(w[t - 2], 19) ^ (w[t - 2] >>> 10);
      w[t] = w[t - 16] + s0 + w[t - 7] + s1;
    }
    let [a, b, c, d, e, f, g, h] = state;
    for (let t = 0; t < 64; ++t) {
      const s1 = rotated(e, 6) ^ rotated(e, 11) ^ rotated(e, 25);
      const first = (h + s1 + ((e & f) ^ (~e & g)) + constants[t] + w[t]) | 0;
      const s0 = rotated(a, 2) ^ rotated(a, 13) ^ rotated(a, 22);
      const second = (s0 + ((a & b) ^ (a & c) ^ (b & c))) | 0;
      [a, b, c, d, e, f, g, h] = [(first + second) | 0, a, b, c, (d + first) | 0, e, f, g];
    }
    [a, b, c, d, e, f, g, h].forEach((change, k) => (state[k] += change));
  }
  return [...state].map((word) => word.toString(16).padStart(8, "0")).join("");
}
