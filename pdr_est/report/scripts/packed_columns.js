/** Read the columns of numbers that `packed_columns.py` packed. */
'use strict';

/** Name the array of each type, and the integer that stands for a missing number. */
const PACKED_TYPES = {
  i1: [Int8Array, -128], i2: [Int16Array, -32768], i4: [Int32Array, -2147483648],
  f4: [Float32Array, NaN], f8: [Float64Array, NaN],
};

/** Unpack a column into an array of numbers, NaN where one is missing. */
function unpackColumn(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  const [Type, missing] = PACKED_TYPES[packed.type];
  const raw = new Type(bytes.buffer);
  const values = new Float64Array(raw.length);
  let sum = 0;
  for (let i = 0; i < raw.length; i += 1) {
    sum = packed.differences ? sum + raw[i] : raw[i];
    values[i] = raw[i] === missing && !packed.differences ? NaN : sum * packed.step;
  }
  return values;
}

/** Unpack every column of an object. */
function unpackColumns(columns) {
  return Object.fromEntries(Object.entries(columns).map(([name, packed]) => [name, unpackColumn(packed)]));
}
