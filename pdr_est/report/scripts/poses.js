/** Keep the poses of one device in columns that grow, and find or interpolate them by time. */
'use strict';

/** Name the columns of poses; all of them have one value for each pose. */
const POSE_COLUMNS = ['time_s', 'from_s', 'x_m', 'y_m', 'cxx_m2', 'cxy_m2', 'cyy_m2', 'heading_deg',
  'sigma_heading_deg', 'mode', 'length_m'];

/** Name what an ellipse of a region has. */
const ELLIPSE_COLUMNS = ['weight', 'x_m', 'y_m', 'cxx_m2', 'cxy_m2', 'cyy_m2'];

/**
 * Create an empty table of poses, with one array for each of POSE_COLUMNS.
 *
 * `append(columns)` adds poses, later ones after earlier ones; a column that is left out is filled with NaN, `from_s`
 * with the time of the pose before. `at(time_s)` interpolates, and returns null for an empty table.
 * `setRegions(columns)` says which poses have several ellipses, with a row for each: the index of its `pose`, and
 * ELLIPSE_COLUMNS. `ellipsesOf(index)` lists the ellipses of a pose.
 */
function createPoses() {
  const table = Object.fromEntries(POSE_COLUMNS.map((name) => [name, []]));

  function append(columns) {
    const count = columns.time_s.length;
    for (const name of POSE_COLUMNS) {
      const values = columns[name];
      for (let i = 0; i < count; i += 1) {
        table[name].push(values ? values[i] : name === 'from_s' ? beforeTime(columns, i) : NaN);
      }
    }
  }

  const regions = new Map();

  function setRegions(columns) {
    regions.clear();
    columns.pose.forEach((pose, row) => {
      if (!regions.has(pose)) regions.set(pose, []);
      regions.get(pose).push(Object.fromEntries(ELLIPSE_COLUMNS.map((name) => [name, columns[name][row]])));
    });
  }

  function ellipsesOf(index) {
    const of = (name) => (name === 'weight' ? 1 : table[name][index]);
    return regions.get(index) || [Object.fromEntries(ELLIPSE_COLUMNS.map((name) => [name, of(name)]))];
  }

  function beforeTime(columns, i) {
    if (i > 0) return columns.time_s[i - 1];
    const known = table.from_s.length;  // poses of earlier calls
    return known ? table.time_s[known - 1] : columns.time_s[0];
  }

  function at(time_s) {
    const count = table.time_s.length;
    if (!count) return null;
    const after = Math.min(firstAfter(table.time_s, time_s), count - 1);
    const before = Math.max(after - 1, 0);
    const begin_s = Math.max(table.from_s[after], table.time_s[before]);
    const share = Math.min(Math.max((time_s - begin_s) / Math.max(table.time_s[after] - begin_s, 1e-9), 0), 1);
    const between = (name) => table[name][before] + (share ? share * (table[name][after] - table[name][before]) : 0);
    const index = share > 0 ? after : before;  // the step that the walker is making or has made last
    const pose = { index, time_s };
    for (const name of ['x_m', 'y_m', 'cxx_m2', 'cxy_m2', 'cyy_m2']) pose[name] = between(name);
    for (const name of ['heading_deg', 'sigma_heading_deg', 'mode', 'length_m']) pose[name] = table[name][index];
    pose.ellipses = regions.get(index) || [{ ...pose, weight: 1 }];
    return pose;
  }

  return { ...table, append, at, setRegions, ellipsesOf, get length() { return table.time_s.length; } };
}

/** Find the index of the first of some ascending numbers that is greater than a value; their count if none is. */
function firstAfter(numbers, value) {
  let low = 0;
  let high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= value) low = middle + 1; else high = middle;
  }
  return low;
}
