/** Read the data of a comparison page: metrics of every walk, their averages, and the tracks. */
'use strict';

const LINE_SIGNS = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_';
const ROUNDING = 1e-9;  // values that differ by less are equal

/**
 * Read the columns that the page embeds.
 *
 * A row is a track of a walk, by its number; `values[metric][variant][row]` is null where there is none.
 *
 * @returns the data, with value(metric, variant, row), off(metric, row), best(metric, values),
 *   average(metric, variant, rows), mark(metric, variant), lines(row) and nameOf(row)
 */
function readComparison(text) {
  const data = JSON.parse(text);
  const metrics = new Map(data.metrics.map((one) => [one.name, one]));
  const several = new Set(data.tracks).size > 1;

  const columns = (metric) => data.values[metric];
  const distance = (metric, value) => Math.abs(value - (metrics.get(metric).ideal || 0));

  /** Average the distance of a row's values from the ideal value over the variants that have one. */
  function off(metric, row) {
    const known = columns(metric).map((column) => column[row]).filter((value) => value !== null);
    if (!known.length) return null;
    return known.reduce((sum, value) => sum + distance(metric, value), 0) / known.length;
  }

  /** Find the variant whose value is nearest to the ideal one; -1 where they do not differ. */
  function best(metric, values) {
    if (metrics.get(metric).ideal === null) return -1;
    const away = values.map((value) => (value === null ? NaN : distance(metric, value)));
    const known = away.filter((one) => !Number.isNaN(one));
    const least = Math.min(...known);
    return known.length && Math.max(...known) - least >= ROUNDING ? away.indexOf(least) : -1;
  }

  /** Average a variant's values over some rows, weighted where the metric is defined so. */
  function average(metric, variant, rows) {
    const { weights } = metrics.get(metric);
    const values = columns(metric)[variant];
    return averageOf(rows.map((row) => values[row]), weights && rows.map((row) => weights[variant][row]));
  }

  /** Decode the tracks of a row, one for each variant, and its true positions. */
  function lines(row) {
    const step_m = data.lines.step_m[row];
    const decode = (text) => decodeLine(text, step_m);
    return { truth: decode(data.lines.truth[row]), tracks: data.lines.tracks.map((column) => decode(column[row])) };
  }

  /** Return the mark of a value whose track was only aligned with the fixes, which does not compare with others. */
  function mark(metric, variant) {
    return metrics.get(metric).with_fixes && data.variants[variant].aligned ? ' *' : '';
  }

  const value = (metric, variant, row) => columns(metric)[variant][row];
  const nameOf = (row) => (several ? `${data.walks[row]}, ${data.tracks[row]}` : data.walks[row]);
  return { ...data, metric: (name) => metrics.get(name), value, off, best, average, mark, lines, nameOf };
}

/** Decode a line: differences of successive points in steps, 5 bits a character, the sign in the lowest bit. */
function decodeLine(text, step_m) {
  const numbers = [];
  let number = 0;
  let factor = 1;
  for (const sign of text) {
    const bits = LINE_SIGNS.indexOf(sign);
    number += (bits & 31) * factor;
    factor *= 32;
    if (bits & 32) continue;
    numbers.push(number % 2 ? -(number + 1) / 2 : number / 2);
    number = 0;
    factor = 1;
  }
  const line = { x_m: [], y_m: [] };
  let x = 0;
  let y = 0;
  for (let i = 0; i + 1 < numbers.length; i += 2) {
    x += numbers[i];
    y += numbers[i + 1];
    line.x_m.push(x * step_m);
    line.y_m.push(y * step_m);
  }
  return line;
}

/** Compute mean (weighted if weights are given), median, 90th percentile and number of the values that are there. */
function averageOf(values, weights) {
  const known = values.filter((value) => value !== null);
  if (!known.length) return { mean: null, median: null, p90: null, n: 0 };
  let sum = 0;
  let whole = 0;
  values.forEach((value, i) => {
    if (value === null) return;
    const weight = weights ? weights[i] : 1;
    sum += weight * value;
    whole += weight;
  });
  known.sort((a, b) => a - b);
  const mean = whole ? sum / whole : null;
  return { mean, median: quantile(known, 0.5), p90: quantile(known, 0.9), n: known.length };
}

/** Interpolate a quantile linearly between ascending numbers. */
function quantile(ascending, share) {
  const place = share * (ascending.length - 1);
  const below = Math.floor(place);
  const above = Math.min(below + 1, ascending.length - 1);
  return ascending[below] + (place - below) * (ascending[above] - ascending[below]);
}

/** Format a number for reading, as the tables of the page do; null becomes a dash. */
function formatNumber(value, digits = 3) {
  if (value === null) return '–';
  const [whole, part] = Math.abs(value).toFixed(digits).split('.');
  const grouped = whole.replace(/\B(?=(\d{3})+$)/g, '\u202f');
  return `${value < 0 ? '−' : ''}${grouped}${part ? `.${part}` : ''}`;
}
