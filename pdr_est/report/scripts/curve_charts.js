/** Draw curves of several variants with uPlot, in the colours of the page's theme. */
'use strict';

const CHART_HEIGHT_PX = 320;

/**
 * Create a chart in an element and keep it as wide as the element.
 *
 * @param element  place of the chart
 * @param curve  {x, lines: [{name, colour, dashes, width, y}], x_label, y_label, x_log, y_log, x_percent, y_percent,
 *   y_range}
 */
function createCurveChart(element, curve) {
  const size = () => ({ width: element.clientWidth, height: Math.min(CHART_HEIGHT_PX, Math.max(240, element.clientWidth * 0.7)) });
  const options = {
    ...size(),
    legend: { live: true },
    scales: { x: { time: false, distr: curve.x_log ? 3 : 1 }, y: { distr: curve.y_log ? 3 : 1, range: curve.y_range } },
    axes: [axisOf(curve.x_label, curve.x_percent, curve.x_log), axisOf(curve.y_label, curve.y_percent, curve.y_log)],
    series: [{ label: curve.x_label, value: (_, x) => shownNumber(x, curve.x_percent) }, ...curve.lines.map(seriesOf)],
  };
  const chart = new uPlot(options, [curve.x, ...curve.lines.map((line) => line.y)], element);
  new ResizeObserver(() => { if (element.clientWidth && element.clientWidth !== chart.width) chart.setSize(size()); }).observe(element);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => chart.redraw(false));

  function seriesOf(line) {
    const width = line.width || 2;
    return {
      label: line.name, width, dash: line.dashes.map((part) => part * width), points: { show: false },
      stroke: () => cssColour(line.colour), value: (_, y) => shownNumber(y, curve.y_percent), spanGaps: false,
    };
  }
  return chart;
}

/** Describe an axis in the page's font and colours. */
function axisOf(label, percent, logarithmic) {
  return {
    label, labelSize: 22, size: percent ? 52 : 46, font: '12px system-ui, sans-serif', labelFont: '13px system-ui, sans-serif',
    stroke: () => cssColour('--muted'), grid: { stroke: () => cssColour('--grid'), width: 1 }, ticks: { show: false },
    values: (_, ticks) => ticks.map((tick) => (tick === null ? '' : percent ? `${Math.round(100 * tick)} %` : plainNumber(tick, logarithmic))),
  };
}

/** Write a number at a tick; on a logarithmic axis only at 1, 2 and 5 times the powers of ten. */
function plainNumber(value, logarithmic) {
  const text = String(Number(value.toPrecision(6)));
  return logarithmic && !/^[0.]*[125]0*$/.test(text) ? '' : text.replace('-', '−');
}

/** Write a number of the legend. */
function shownNumber(value, percent) {
  if (value === null || value === undefined) return '–';
  return percent ? `${formatNumber(100 * value, 1)} %` : formatNumber(value, 2);
}
