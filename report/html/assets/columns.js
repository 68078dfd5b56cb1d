// Columns of numbers as report.html holds them, and back to exactly the decimals they stand for.

/** A number as an integer over a power of ten, from its shortest decimal form: 0.25 is 25 / 10^2. */
function asDecimal(number) {
  const [digits, exponent = "0"] = String(number).split("e");
  const [whole, fraction = ""] = digits.split(".");
  const places = fraction.length - Number(exponent);
  const integer = Number(whole + fraction);
  return places >= 0 ? {integer, places} : {integer: integer * 10 ** -places, places: 0};
}

const NO_VALUE = -(2 ** 31);

/** Undoes the differences and the shuffle of the bytes: n little-endian int32. */
function unshuffled(bytes, n) {
  if (bytes.length !== 4 * n) throw new Error(`a column has ${bytes.length} bytes, not ${4 * n}`);
  const integers = new Int32Array(n);
  let sum = 0;
  for (let i = 0; i < n; i++) {
    const difference =
        bytes[i] | (bytes[n + i] << 8) | (bytes[2 * n + i] << 16) | (bytes[3 * n + i] << 24);
    sum = (sum + difference) | 0;
    integers[i] = sum;
  }
  return integers;
}

async function inflated(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * A column as integers over a power of ten, NaN where there is no value. The quotient of two such
 * numbers is the double nearest to the decimal, so 3 steps of 0.1 print as 0.3.
 */
async function decodedColumn({length, start = 0, interval, step, data}) {
  const from = asDecimal(start);
  const by = asDecimal(data === undefined ? interval : step);
  const places = Math.max(from.places, by.places);
  const first = from.integer * 10 ** (places - from.places);
  const each = by.integer * 10 ** (places - by.places);
  const multiples = data === undefined ? null : unshuffled(await inflated(data), length);
  const integers = new Float64Array(length);
  for (let i = 0; i < length; i++) {
    const multiple = multiples ? multiples[i] : i;
    integers[i] = multiple === NO_VALUE ? NaN : first + multiple * each;
  }
  return {integers, places};
}

/** The values of a column, less those of another where one is given. */
function valuesOf(column, less) {
  if (!less) return column.integers.map((k) => k / 10 ** column.places);
  const places = Math.max(column.places, less.places);
  const a = 10 ** (places - column.places);
  const b = 10 ** (places - less.places);
  const values = new Float64Array(Math.min(column.integers.length, less.integers.length));
  for (let i = 0; i < values.length; i++)
    values[i] = (column.integers[i] * a - less.integers[i] * b) / 10 ** places;
  return values;
}

/** The columns of a page, decoded when first asked for; who shares a column gets the same array. */
class Columns {
  constructor(list) {
    this.list = list;
    this.decoded = new Map();
    this.arrays = new Map();
  }

  column(index) {
    if (!this.decoded.has(index)) this.decoded.set(index, decodedColumn(this.list[index]));
    return this.decoded.get(index);
  }

  async values(index, less) {
    const key = `${index} ${less}`;
    const columns = await Promise.all([index, less].map((i) => i !== undefined && this.column(i)));
    if (!this.arrays.has(key)) this.arrays.set(key, valuesOf(...columns));
    return this.arrays.get(key);
  }
}

function isSorted(values) {
  for (let i = 1; i < values.length; i++)
    if (!(values[i] >= values[i - 1])) return false;
  return true;
}

/** Index of the first of the sorted values that is not below the limit. */
function lowerBound(values, limit) {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Index of the nearest of the sorted values. */
function nearest(values, value) {
  const i = lowerBound(values, value);
  if (i === 0) return 0;
  return i === values.length || value - values[i - 1] <= values[i] - value ? i - 1 : i;
}
