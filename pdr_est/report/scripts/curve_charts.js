/** Draw curves of several variants with uPlot, in the colours of the page's theme. */
'use strict';

const TALLEST_PX = 330;
const LOWEST_PX = 230;

/**
 * Create a chart with a legend, as wide as its element.
 *
 * @param element  place of the chart
 * @param curve  {x, lines: [{variant, part, colour, dashes, width, y}], x_label, y_label, x_log, y_log, x_percent,
 *   y_percent, y_range}; lines of one variant are shown and hidden together, `part` tells them apart
 */
function createCurveChart(element, curve) {
  const place = makeElement('div', { className: 'chart-area' });
  const readout = makeElement('p', { className: 'about readout' });
  const legend = createCurveLegend(curve, (variant, on) => {
    curve.lines.forEach((line, i) => { if (line.variant === variant) chart.setSeries(i + 1, { show: on }); });
  });
  element.replaceChildren(legend.list, place, readout);
  const size = () => {
    const width = place.clientWidth;
    return { width, height: Math.min(TALLEST_PX, Math.max(LOWEST_PX, 0.7 * width)) };
  };
  const chart = new uPlot({
    ...size(),
    legend: { show: false },
    cursor: { points: { size: 7 }, drag: { x: true, y: false, dist: 6 } },
    scales: {
      x: { time: false, distr: curve.x_log ? 3 : 1, range: (_, low, high) => [low, high] },
      y: { distr: curve.y_log ? 3 : 1, range: curve.y_range },
    },
    axes: [
      { ...axisOf(curve.x_percent, curve.x_log), label: curve.x_label, size: 28, space: 52 },
      { ...axisOf(curve.y_percent, curve.y_log), label: curve.y_label, size: 48, space: 28 },
    ],
    series: [{}, ...curve.lines.map(seriesOf)],
    hooks: { setCursor: [(u) => tell(u.cursor.idx)] },
  }, [curve.x, ...curve.lines.map((line) => line.y)], place);

  /** Write the values at a place of the x axis into the legend; none while the pointer is elsewhere. */
  function tell(index) {
    const there = index !== null && index !== undefined;
    readout.textContent = `${curve.x_label}: ${there ? shownNumber(curve.x[index], curve.x_percent) : '–'}`;
    legend.tell((line) => (there ? shownNumber(line.y[index], curve.y_percent) : ''));
  }

  tell(null);
  new ResizeObserver(() => {
    if (place.clientWidth && place.clientWidth !== chart.width) chart.setSize(size());
  }).observe(place);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => chart.redraw());
  return chart;
}

/** Create the legend of a chart: an entry for each variant, with the values of its lines. */
function createCurveLegend(curve, onToggle) {
  const variants = [...new Set(curve.lines.map((line) => line.variant))];
  const list = makeElement('ul', { className: 'legend toggles' });
  const entries = variants.map((variant) => {
    const lines = curve.lines.filter((line) => line.variant === variant);
    const value = makeElement('span', { className: 'value' });
    const sign = makeLineSign(lines[0].colour, lines[0].dashes);
    list.append(makeToggle(variant, sign, (on) => onToggle(variant, on), value));
    return { lines, value };
  });
  const words = (line, text) => (line.part && text ? `${line.part} ${text}` : text);
  return { list, tell: (textOf) => entries.forEach(({ lines, value }) => {
    value.textContent = lines.map((line) => words(line, textOf(line))).filter(Boolean).join(', ');
  }) };
}

function seriesOf(line) {
  const dash = line.dashes.map((part) => part * line.width);
  return { width: line.width, dash, stroke: () => cssColour(line.colour), points: { show: false } };
}

/** Describe an axis in the page's font and colours. */
function axisOf(percent, logarithmic) {
  const few = (_, ticks) => (logarithmic ? ticks.map((tick) => (isRoundTick(tick) ? tick : null)) : ticks);
  const text = (tick) => (tick === null ? '' : percent ? `${Math.round(100 * tick)} %` : plainNumber(tick));
  return {
    labelSize: 22, font: '12px system-ui, sans-serif', labelFont: '13px system-ui, sans-serif',
    stroke: () => cssColour('--muted'), grid: { stroke: () => cssColour('--grid'), width: 1, filter: few },
    ticks: { show: false }, filter: few, values: (_, ticks) => ticks.map(text),
  };
}

/** Tell whether a number is 1, 2 or 5 times a power of ten. */
function isRoundTick(value) {
  return /^[125]\.?0*e/.test(Number(value.toPrecision(6)).toExponential());
}

/** Write the number at a tick. */
function plainNumber(value) {
  return String(Number(value.toPrecision(6))).replace('-', '−');
}

/** Write a value of a line. */
function shownNumber(value, percent) {
  if (value === null || value === undefined) return '–';
  return percent ? `${formatNumber(100 * value, 1)} %` : formatNumber(value, 2);
}
