/** Draw the line of one device on a Leaflet map, coloured by carrying modes, with its ellipses. */
'use strict';

const ELLIPSE_APART_PX = 90;
const MOST_ELLIPSES = 40;

/**
 * Create the layers of one device.
 *
 * @param device {name, colour, modes}: colour of the line, or null for a line in the colours of the modes; modes is
 *   an array of {name, colour, dashes} by the number of the mode
 * @param panes {bands, lines, ellipses}: options of Leaflet (pane, renderer) for each kind
 * @returns poses, layers {lines, ellipses}, redraw(map), which draws what was appended, setShown(test, map), which
 *   draws the poses of some times, those of others palely, and isShown(index)
 */
function createDeviceLines(device, panes) {
  const poses = createPoses();
  const lines = L.layerGroup();
  const ellipses = L.layerGroup();
  const byMode = new Map();
  const points = [];
  const whole = device.colour === null ? null : L.polyline([], { ...panes.lines, weight: 2.5 }).addTo(lines);
  const rest = L.polyline([], { ...panes.bands, weight: 1.5, opacity: 0.45, dashArray: '2 5' }).addTo(lines);
  const restLeg = { line: rest, parts: [], last: -1 };
  const wholeLeg = { line: whole, parts: [], last: -1 };
  let isTimeShown = null;
  const end = L.circleMarker([0, 0], { ...panes.lines, radius: 4, weight: 1.5, fillOpacity: 1 });
  const start = L.circleMarker([0, 0], { ...panes.lines, radius: 6.5, weight: 2.5, fillOpacity: 1 });
  const regions = L.polygon([], { ...panes.ellipses, weight: 1, fillRule: 'nonzero' }).addTo(ellipses);

  function legOf(mode) {
    if (!byMode.has(mode)) {
      const style = whole ? { ...panes.bands, weight: 9, lineCap: 'butt' } : { ...panes.lines, weight: 3 };
      const line = L.polyline([], style);
      byMode.set(mode, { line: line.addTo(lines), parts: [], last: -1 });
    }
    return byMode.get(mode);
  }

  function addPoints() {
    for (let i = points.length; i < poses.length; i += 1) {
      points.push(L.latLng(poses.y_m[i], poses.x_m[i]));
      if (i === 0) continue;
      const drawn = isShown(i) && isShown(i - 1);
      extend(drawn ? legOf(poses.mode[i]) : restLeg, i);
      if (drawn) extend(wholeLeg, i);
    }
  }

  function extend(leg, i) {
    if (leg.last !== i - 1) leg.parts.push([points[i - 1]]);
    leg.parts[leg.parts.length - 1].push(points[i]);
    leg.last = i;
  }

  function isShown(index) {
    return !isTimeShown || isTimeShown(poses.time_s[index]);
  }

  /** Draw only the poses of the times that pass a test, and the way of the others as a pale line; null for all. */
  function setShown(test, map) {
    isTimeShown = test;
    points.length = 0;
    for (const { line } of byMode.values()) line.remove();
    byMode.clear();
    for (const leg of [restLeg, wholeLeg]) { leg.parts = []; leg.last = -1; }
    start.remove();
    end.remove();
    redraw(map);
  }

  function redraw(map) {
    const before = points.length;
    addPoints();
    if (points.length === before) return;
    for (const [mode, leg] of byMode) {
      if (leg.last >= before - 1) leg.line.setLatLngs(leg.parts);
      styleLeg(mode, leg.line);
    }
    if (whole) whole.setLatLngs(wholeLeg.parts);
    rest.setLatLngs(restLeg.parts);
    if (isShown(0)) start.setLatLng(points[0]).addTo(lines);
    if (points.length > 1 && isShown(points.length - 1)) end.setLatLng(points[points.length - 1]).addTo(lines);
    restyle();
    redrawEllipses(map);
  }

  function styleLeg(mode, line) {
    const style = device.modes[mode] || { colour: '--muted' };
    const broken = !whole && style.dashes && style.dashes.length;
    const dash = broken ? style.dashes.map((part) => 3 * part).join(' ') : null;
    line.setStyle({ color: cssColour(style.colour), opacity: whole ? 0.45 : 1, dashArray: dash });
  }

  function restyle() {
    const own = cssColour(device.colour || '--ink');
    for (const [mode, leg] of byMode) styleLeg(mode, leg.line);
    if (whole) whole.setStyle({ color: own });
    rest.setStyle({ color: cssColour('--muted') });
    start.setStyle({ color: own, fillColor: cssColour('--paper') });
    end.setStyle({ color: cssColour('--paper'), fillColor: own });
    const pale = cssColour(device.colour || '--muted');
    regions.setStyle({ color: pale, opacity: 0.5, fillColor: pale, fillOpacity: 0.08 });
  }

  /** Choose poses in sight that are some pixels apart along the track, wider where the regions are large. */
  function redrawEllipses(map) {
    if (!points.length) return;
    const scale = map.options.crs.scale(map.getZoom());
    const sight = map.getBounds().pad(0.2);
    const outlines = [];
    let way = Infinity;
    let needed = 0;
    for (let i = points.length - 1; i >= 0 && outlines.length < MOST_ELLIPSES; i -= 1) {
      if (i + 1 < points.length) way += Math.hypot(poses.x_m[i + 1] - poses.x_m[i], poses.y_m[i + 1] - poses.y_m[i]);
      if (way < needed || !sight.contains(points[i]) || !isShown(i)) continue;
      const shapes = poses.ellipsesOf(i).map(outlineOf).filter((outline) => outline.length);
      if (!shapes.length) continue;
      outlines.push(...shapes.map((outline) => [outline]));
      way = 0;
      needed = Math.max(ELLIPSE_APART_PX / scale, 2 * Math.sqrt(poses.cxx_m2[i] + poses.cyy_m2[i]));
    }
    regions.setLatLngs(outlines);
  }

  const layers = { lines, ellipses };
  return { name: device.name, poses, layers, redraw, restyle, redrawEllipses, setShown, isShown };
}

/** Colours of the present theme by the names of CSS variables: looking one up makes the browser compute styles. */
const knownColours = new Map();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => knownColours.clear());

/** Look up the colour of a CSS variable in the present theme; any other colour is returned as it is. */
function cssColour(name) {
  if (!name.startsWith('--')) return name;
  if (!knownColours.has(name)) {
    knownColours.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  }
  return knownColours.get(name);
}
