/** Say which charts the report of a walk has. */
'use strict';

const SIGMA_95 = 1.959963984540054;
const MOST_STEP_DOTS = 700;
const STRIP_PX = 7;

/** List the charts of a walk, as createTimeChart wants them; devices have their poses in `table`. */
function walkCharts(signals, devices, fixes, modes, height) {
  const many = signals.length > 1;
  const specs = signals.map((one) => accelerationChart(one, many, modes));
  const ofPoses = (values, more = () => ({})) => devices.map(({ name, colour, table }) => (
    { name, colour, time_s: table.time_s, values: values(table), ...more(table) }));
  const dots = () => ({ dots: true });
  if (!devices.some((one) => one.table.time_s.length > 1)) return specs;
  specs.push({
    title: 'Heading', unit: '°', digits: 0, range: [-180, 180], ticks: [90], height: 150,
    series: ofPoses((t) => t.heading_deg.map(wrapDegrees), (t) => (
      { dots: true, half: t.sigma_heading_deg.map((s) => SIGMA_95 * s), wrap: 360 })),
  });
  specs.push({
    title: 'Standard deviation of the heading', unit: '°', digits: 1, series: ofPoses((t) => t.sigma_heading_deg),
  });
  specs.push({
    title: 'Step length', unit: 'm', digits: 2,
    series: ofPoses((t) => t.length_m.map((v, i) => (i ? v : NaN)), dots),
  });
  specs.push({
    title: 'Cadence', unit: 'steps/min', digits: 0,
    series: signals.map(({ device, colour, steps_s, cadence_per_min }) => (
      { name: device, colour, time_s: steps_s, values: cadence_per_min, dots: true })),
  });
  specs.push({
    title: 'Standard deviation of the position, longer axis', unit: 'm', digits: 2,
    series: ofPoses(longerSigmas, () => ({ width: 1.8 })),
  });
  if (height) specs.push(heightChart(height.columns, height.moves), floorChart(height.columns));
  if (fixes.length) specs.push(residualChart(fixes));
  return specs;
}

/** Show the height with its 95 % interval; what lies in a move is shaded. */
function heightChart({ time_s, height_m, sigma_m }, moves) {
  const half = sigma_m.map((s) => SIGMA_95 * s);
  const series = [{ name: 'height', colour: '--series-1', time_s, values: height_m, half }];
  const title = 'Height above the floor at the start';
  return { title, unit: 'm', digits: 1, series, under: (u) => drawGaps(u, moves) };
}

/** Show the number of the floor. */
function floorChart({ time_s, floor }) {
  const series = [{ name: 'floor', colour: '--series-1', time_s, values: floor, width: 1.8 }];
  return { title: 'Floor', unit: '', digits: 0, series };
}

/** Compute the standard deviations of the positions along the longer axes. */
function longerSigmas(table) {
  return table.x_m.map((_, i) => sigmas(table.cxx_m2[i], table.cxy_m2[i], table.cyy_m2[i])[0]);
}

/** Show how far the track is from the known positions, with the 95 % bound of each as a line from zero. */
function residualChart(fixes) {
  const series = fixes.map(({ kind, columns }) => {
    const order = Array.from(columns.time_s.keys()).sort((a, b) => columns.time_s[a] - columns.time_s[b]);
    const pick = (values) => order.map((i) => values[i]);
    const given = kind === 'given';
    const [time_s, values, bound_m] = [columns.time_s, columns.distance_m, columns.bound_m].map(pick);
    return { name: kind, colour: given ? '--fix' : '--ink', time_s, values, bound_m, dots: true, hollow: !given };
  });
  const reached_m = series.flatMap((one) => [...one.values, middleOf(one.bound_m)]);
  const most = Math.max(0.1, ...reached_m.filter(Number.isFinite));
  return {
    title: 'Distance between known positions and track', unit: 'm', digits: 2, height: 150, series,
    range: [0, 1.1 * most],
    under: (u) => series.forEach((one) => drawBounds(u, one)),
  };
}

/** Find the value in the middle of some numbers. */
function middleOf(values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1];
}

/** Draw a vertical line from zero to the 95 % bound of each known position. */
function drawBounds(u, one) {
  u.ctx.save();
  u.ctx.strokeStyle = cssColour(one.colour);
  u.ctx.globalAlpha = 0.25;
  u.ctx.lineWidth = 5 * devicePixelRatio;
  u.ctx.beginPath();
  one.time_s.forEach((time_s, i) => {
    if (time_s < u.scales.x.min || time_s > u.scales.x.max) return;
    const x = u.valToPos(time_s, 'x', true);
    const top = Math.max(u.valToPos(one.bound_m[i], 'y', true), u.bbox.top);
    u.ctx.moveTo(x, u.valToPos(0, 'y', true));
    u.ctx.lineTo(x, top);
  });
  u.ctx.stroke();
  u.ctx.restore();
}

function accelerationChart(signal, many, modes) {
  const { time_s, values } = joinedSegments(signal.segments);
  return {
    title: `Vertical acceleration${many ? `: ${signal.device}` : ''}`, unit: 'm/s²', digits: 2, height: 150,
    top: STRIP_PX + 10, series: [{ name: signal.device, colour: '--muted', time_s, values, width: 1 }],
    under: (u) => drawGaps(u, signal.gaps),
    over: (u) => { drawModes(u, signal.runs, modes); drawSteps(u, signal, time_s, values); },
  };
}

/** Put the segments of a signal one after the other, with a missing value between them. */
function joinedSegments(segments) {
  const time_s = [];
  const values = [];
  for (const { begin_s, end_s, values: own } of segments) {
    if (time_s.length) { time_s.push((time_s[time_s.length - 1] + begin_s) / 2); values.push(NaN); }
    const step_s = own.length > 1 ? (end_s - begin_s) / (own.length - 1) : 0;
    own.forEach((value, i) => { time_s.push(begin_s + i * step_s); values.push(value); });
  }
  return { time_s, values };
}

function drawGaps(u, gaps) {
  u.ctx.save();
  u.ctx.fillStyle = cssColour('--muted');
  u.ctx.globalAlpha = 0.18;
  gaps.begin_s.forEach((begin_s, i) => fillSpan(u, begin_s, gaps.end_s[i], u.bbox.top, u.bbox.height));
  u.ctx.restore();
}

/** Draw the carrying modes as a strip above the plot. */
function drawModes(u, runs, modes) {
  const height = STRIP_PX * devicePixelRatio;
  u.ctx.save();
  runs.begin_s.forEach((begin_s, i) => {
    u.ctx.fillStyle = cssColour(modes[runs.mode[i]].colour);
    u.ctx.globalAlpha = modes[runs.mode[i]].name === 'UNKNOWN' ? 0.35 : 1;
    fillSpan(u, begin_s, runs.end_s[i], u.bbox.top - height - 3 * devicePixelRatio, height);
  });
  u.ctx.restore();
}

function fillSpan(u, begin_s, end_s, top, height) {
  const { min, max } = u.scales.x;
  if (end_s < min || begin_s > max) return;
  const left = u.valToPos(Math.max(begin_s, min), 'x', true);
  u.ctx.fillRect(left, top, Math.max(u.valToPos(Math.min(end_s, max), 'x', true) - left, 1), height);
}

/** Mark the detected steps on the acceleration, where they are few enough to be told apart. */
function drawSteps(u, signal, time_s, values) {
  const from = firstAfter(signal.steps_s, u.scales.x.min);
  const to = firstAfter(signal.steps_s, u.scales.x.max);
  if (to - from > MOST_STEP_DOTS) return;
  const radius = (to - from < 80 ? 3.5 : 2) * devicePixelRatio;
  u.ctx.save();
  u.ctx.fillStyle = cssColour(signal.colour);
  for (let i = from; i < to; i += 1) {
    const sample = Math.max(firstAfter(time_s, signal.steps_s[i] + 1e-3) - 1, 0);
    if (!Number.isFinite(values[sample])) continue;
    u.ctx.beginPath();
    const [x, y] = [u.valToPos(signal.steps_s[i], 'x', true), u.valToPos(values[sample], 'y', true)];
    u.ctx.arc(x, y, radius, 0, 7);
    u.ctx.fill();
  }
  u.ctx.restore();
}
