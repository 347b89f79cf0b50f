/** Draw one quantity over time with uPlot, linked with the other charts by the time cursor. */
'use strict';

const CHART_TICKS_S = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200];

/**
 * Create a chart.
 *
 * @param element  where it is drawn, as wide as this
 * @param spec     title, unit, digits, height; range: [low, high] of the y axis, null where the data decide;
 *   series: [{name, colour, time_s, values, dots, hollow, half}], dots: drawn as dots and not as a line, half: half
 *   lengths of intervals about the values; under(u) and over(u): draw on the canvas below and above the data
 * @param cursor   result of createTimeCursor
 */
function createTimeChart(element, spec, cursor) {
  const readout = makeElement('span', { className: 'readout' });
  const area = makeElement('div', { className: 'chart-area' });
  const head = makeElement('h3', {}, `${spec.title} (${spec.unit})`, readout);
  element.append(makeElement('div', { className: 'chart' }, head, area));
  const tables = spec.series.map(({ time_s, values }) => (
    [time_s, Array.from(values, (value) => (Number.isFinite(value) ? value : null))]));
  const data = tables.length === 1 ? tables[0] : uPlot.join(tables);
  const height = spec.height || 130;
  const line = makeElement('div', { className: 'time-line' });
  const chart = new uPlot({
    width: Math.max(area.clientWidth, 200), height, padding: [spec.top || 6, 22, 0, 0],
    legend: { show: false },
    cursor: { x: false, y: false, points: { show: false }, drag: { x: true, y: false, dist: 6 } },
    scales: {
      x: { time: false, range: (u, low, high) => windowOf(low, high) },
      y: { range: spec.range ? () => spec.range : softRange },
    },
    axes: [timeAxis(cursor), valueAxis(spec.ticks)],
    series: [{}, ...spec.series.map(seriesOptions)],
    hooks: {
      setScale: [(u, key) => { if (key === 'x') cursor.setWindow(u.scales.x.min, u.scales.x.max); }],
      drawClear: [(u) => { spec.series.forEach((one) => drawIntervals(u, one)); if (spec.under) spec.under(u); }],
      draw: [(u) => { if (spec.over) spec.over(u); placeLine(u); }],
    },
  }, data, area);
  chart.over.append(line);
  followPointer(chart, cursor);

  function windowOf(low, high) {
    return low === null || low === high ? [cursor.begin_s, cursor.end_s] : [low, high];
  }

  function placeLine(u = chart) {
    const x = u.valToPos(cursor.time_s, 'x');
    line.style.transform = `translateX(${x}px)`;
    line.hidden = x < 0 || x > u.over.clientWidth;
  }

  function follow() {
    placeLine();
    readout.textContent = spec.series.map((one) => readoutOf(one, cursor.time_s, spec)).filter(Boolean).join(' · ');
  }

  cursor.onTime(follow);
  cursor.onWindow(() => chart.setScale('x', { min: cursor.window[0], max: cursor.window[1] }));
  chart.setScale('x', { min: cursor.window[0], max: cursor.window[1] });
  new ResizeObserver(() => {
    if (area.clientWidth && area.clientWidth !== chart.width) chart.setSize({ width: area.clientWidth, height });
  }).observe(area);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => chart.redraw());
  return chart;
}

/** Let the pointer choose the time: a mouse by hovering, a finger by touching and dragging. */
function followPointer(chart, cursor) {
  const choose = (event) => {
    if (cursor.playing && event.type === 'pointermove') return;
    cursor.setTime(chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, 'x'));
  };
  chart.over.addEventListener('pointermove', choose);
  chart.over.addEventListener('pointerdown', choose);
}

function timeAxis(cursor) {
  return {
    ...axisColours(), size: 26, space: 64, incrs: CHART_TICKS_S,
    values: (u, ticks) => {
      const digits = u.scales.x.max - u.scales.x.min < 4 ? 1 : 0;
      return ticks.map((t) => timeText(t - cursor.begin_s, digits, cursor.end_s - cursor.begin_s > 100));
    },
  };
}

function valueAxis(ticks) {
  const values = (u, places) => places.map((place) => String(place).replace('-', '−'));
  return { ...axisColours(), ...(ticks ? { incrs: ticks } : {}), size: 46, space: 28, values };
}

function axisColours() {
  const grid = { stroke: () => cssColour('--grid'), width: 1 };
  return { stroke: () => cssColour('--muted'), grid, ticks: { show: false }, font: '12px system-ui, sans-serif' };
}

function seriesOptions(one) {
  const colour = () => cssColour(one.colour);
  if (!one.dots) return { stroke: colour, width: one.width || 1.2, points: { show: false } };
  const fill = () => cssColour(one.hollow ? '--paper' : one.colour);
  const size = one.values.length < 400 ? 6 : 3.5;
  return { stroke: colour, paths: () => null, points: { show: true, size, width: 1, stroke: colour, fill } };
}

/** Let the y axis begin at zero where no value is negative. */
function softRange(u, low, high) {
  if (low === null) return [0, 1];
  const room = 0.06 * Math.max(high - Math.min(low, 0), 1e-3);
  return [low < 0 ? low - room : 0, high + room];
}

/** Draw the interval about each value as a vertical line; `wrap` is the period of an angle. */
function drawIntervals(u, one) {
  if (!one.half) return;
  const { ctx, bbox } = u;
  const from = firstAfter(one.time_s, u.scales.x.min);
  const to = firstAfter(one.time_s, u.scales.x.max);
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.beginPath();
  for (let i = from; i < to; i += 1) {
    if (!Number.isFinite(one.values[i]) || !Number.isFinite(one.half[i])) continue;
    const x = u.valToPos(one.time_s[i], 'x', true);
    for (const turn of one.wrap ? [-one.wrap, 0, one.wrap] : [0]) {
      ctx.moveTo(x, u.valToPos(one.values[i] + turn - one.half[i], 'y', true));
      ctx.lineTo(x, u.valToPos(one.values[i] + turn + one.half[i], 'y', true));
    }
  }
  ctx.strokeStyle = cssColour(one.colour);
  ctx.globalAlpha = 0.2;
  ctx.lineWidth = Math.max(1, Math.min(6, (0.6 * bbox.width) / Math.max(to - from, 1)));
  ctx.stroke();
  ctx.restore();
}

/** Write the value of a series at a time: the last one before it, within ten seconds. */
function readoutOf(one, time_s, spec) {
  const i = firstAfter(one.time_s, time_s + 1e-3) - 1;
  if (i < 0 || time_s - one.time_s[i] > 10 || !Number.isFinite(one.values[i])) return '';
  const name = spec.series.length > 1 ? `${one.name} ` : '';
  return `${name}${numberText(one.values[i], spec.digits)}`;
}
