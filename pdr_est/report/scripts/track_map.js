/** Draw tracks in local metres on a Leaflet map: devices, ellipses, fixes, truth, variants and a time cursor. */
'use strict';

const MAP_PANES = ['doubts', 'truth', 'ellipses', 'variants', 'bands', 'lines', 'fixes', 'cursor'];
const NEAR_PX = 40;
const MOST_FIX_ELLIPSES = 25;
const MOST_HELD_OUT = 60;
const NEAR_FIX_S = 2;

/**
 * Create a map of tracks in an element.
 *
 * All coordinates are metres of the track's frame, x to the right and y up. Colours are CSS colours or the names of
 * CSS variables, which follow the theme. Times are seconds.
 *
 * @param element  where the map is drawn; its size is set by CSS
 * @param options  north: true if up is north; modes: [{name, colour, dashes}] by the number of a mode;
 *   onPick(time_s, device, index, pressed): called when the pointer is near a pose (pressed: clicked or tapped)
 * @returns setDevices, append, setRegions, setFixes, setTruth, setVariants, setDoubts, setCursor, show, showTimes,
 *   fit, leaflet
 */
function createTrackMap(element, options = {}) {
  const map = L.map(element, {
    crs: L.CRS.Simple, zoomSnap: 0.25, zoomDelta: 1, minZoom: -8, maxZoom: 9, wheelPxPerZoomLevel: 90,
    attributionControl: false, scrollWheelZoom: false, fadeAnimation: false,
  }).setView([0, 0], 3);
  const paneOptions = makePanes(map);
  const groups = {};
  for (const name of ['doubts', 'truth', 'variants', 'fixes', 'cursor']) groups[name] = L.layerGroup().addTo(map);
  const visible = { ellipses: true };
  const hidden = new Set();
  let devices = [];
  const marks = { truth: null, fixes: [], variants: [], doubts: [] };
  let cursor_s = null;
  let frame = 0;

  L.control.scale({ imperial: false, maxWidth: 140 }).addTo(map);
  addMapButton(map, '⤢', 'Show the whole track', () => fit());
  addPointerPlace(map);
  wheelWhenPressed(map);
  map.on('moveend', () => devices.forEach((one) => one.redrawEllipses(map)));
  map.on('mousemove', (event) => pick(event, false));
  map.on('click', (event) => pick(event, true));
  if (window.ResizeObserver) new ResizeObserver(() => map.invalidateSize({ pan: false })).observe(element);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', refreshColours);
  if (options.north) addNorthArrow(map);

  /** Replace the devices: [{name, colour}]; a colour of null draws the line in the colours of the modes. */
  function setDevices(named) {
    devices.forEach((one) => Object.values(one.layers).forEach((layer) => layer.remove()));
    const usual = { colour: null, modes: options.modes || [] };
    devices = named.map((device) => createDeviceLines({ ...usual, ...device }, paneOptions));
    devices.forEach(applyVisibility);
    drawCursor();
  }

  /** Append poses to a device: an object with arrays for POSE_COLUMNS, of which time_s, x_m and y_m are needed. */
  function append(name, columns) {
    devices.find((one) => one.name === name).poses.append(columns);
    if (!frame) frame = requestAnimationFrame(redraw);
  }

  /** Say which poses of a device have several ellipses: columns as for `setRegions` of poses. */
  function setRegions(name, columns) {
    devices.find((one) => one.name === name).poses.setRegions(columns);
  }

  function redraw() {
    frame = 0;
    devices.forEach((one) => one.redraw(map));
    drawCursor();
  }

  /** Draw fixes: [{time_s, x_m, y_m, cxx_m2, cxy_m2, cyy_m2, kind}], kind "given" (filled) or "held out" (hollow). */
  function setFixes(fixes) {
    const heldOut = fixes.filter((fix) => fix.kind !== 'given').length;
    marks.fixes = fixes;
    // Dense truth is shown as a line.
    const drawn = heldOut > MOST_HELD_OUT ? fixes.filter((fix) => fix.kind === 'given') : fixes;
    drawFixes(groups.fixes.clearLayers(), paneOptions.fixes, drawn, devices[devices.length - 1]);
  }

  /** Draw the truth as a dashed line through its points, arrays x_m and y_m; null removes it. */
  function setTruth(truth) {
    marks.truth = truth;
    groups.truth.clearLayers();
    if (!truth) return;
    const points = Array.from(truth.x_m, (x, i) => [truth.y_m[i], x]);
    const colour = cssColour('--ink');
    L.polyline(points, { ...paneOptions.truth, color: colour, weight: 1.5, dashArray: '6 4' }).addTo(groups.truth);
  }

  /** Draw tracks to compare with: [{name, colour, x_m, y_m, dashes, weight}], the last two in pixels. */
  function setVariants(variants) {
    marks.variants = variants;
    groups.variants.clearLayers();
    for (const one of variants) {
      const points = Array.from(one.x_m, (x, i) => [one.y_m[i], x]);
      const dashArray = (one.dashes || [1, 5]).join(' ');
      const style = { ...paneOptions.variants, color: cssColour(one.colour), weight: one.weight || 2, dashArray };
      if (!hidden.has(one.name)) L.polyline(points, style).addTo(groups.variants);
    }
  }

  /** Mark where something does not fit, by a broad band or a ring: [{x_m, y_m}], one point for a ring. */
  function setDoubts(lines) {
    marks.doubts = lines;
    groups.doubts.clearLayers();
    const style = { ...paneOptions.doubts, color: cssColour('--warn-edge') };
    for (const { x_m, y_m } of lines) {
      const points = Array.from(x_m, (x, i) => [y_m[i], x]);
      if (points.length > 1) L.polyline(points, { ...style, weight: 18, opacity: 0.35 }).addTo(groups.doubts);
      else L.circleMarker(points[0], { ...style, radius: 11, weight: 3, fill: false }).addTo(groups.doubts);
    }
  }

  /** Show the place of every device at a time; null removes it. */
  function setCursor(time_s) {
    cursor_s = time_s;
    drawCursor();
  }

  function drawCursor() {
    groups.cursor.clearLayers();
    if (cursor_s === null) return;
    for (const one of devices) {
      const pose = hidden.has(one.name) ? null : one.poses.at(cursor_s);
      if (pose) drawPose(groups.cursor, paneOptions.cursor, pose, visible.ellipses);
    }
    if (marks.fixes.length > MOST_FIX_ELLIPSES && map.hasLayer(groups.fixes)) drawFixAt(cursor_s);
  }

  /** Draw the fix at a time with its ellipse, where those of all fixes would hide the track. */
  function drawFixAt(time_s) {
    const away = (fix) => Math.abs(fix.time_s - time_s);
    const nearest = marks.fixes.reduce((best, fix) => (away(fix) < away(best) ? fix : best));
    if (away(nearest) >= NEAR_FIX_S) return;
    drawFixes(groups.cursor, paneOptions.cursor, [nearest], devices[devices.length - 1]);
  }

  /** Show or hide "ellipses", "fixes", "truth", "variants", "doubts", or one device or variant by its name. */
  function show(what, on) {
    if (groups[what]) { if (on) groups[what].addTo(map); else groups[what].remove(); return; }
    if (what === 'ellipses') visible.ellipses = on;
    else if (on) hidden.delete(what);
    else hidden.add(what);
    devices.forEach(applyVisibility);
    setVariants(marks.variants);
    drawCursor();
  }

  /** Draw the poses of the times that pass a test, and of the others only a pale line; null draws all of them. */
  function showTimes(test) {
    devices.forEach((one) => one.setShown(test, map));
    drawCursor();
  }

  function applyVisibility(one) {
    const shown = !hidden.has(one.name);
    if (shown) one.layers.lines.addTo(map); else one.layers.lines.remove();
    if (shown && visible.ellipses) one.layers.ellipses.addTo(map); else one.layers.ellipses.remove();
  }

  /** Show everything: all poses, variants, fixes and the truth. */
  function fit() {
    const bounds = L.latLngBounds([]);
    const lines = [...devices.map((one) => one.poses), ...marks.variants, ...(marks.truth ? [marks.truth] : [])];
    for (const line of lines) Array.from(line.x_m).forEach((x, i) => bounds.extend([line.y_m[i], x]));
    for (const fix of marks.fixes) bounds.extend([fix.y_m, fix.x_m]);
    extendByEllipses(bounds, devices);
    if (bounds.isValid()) map.fitBounds(bounds.pad(0.04), { maxZoom: 6.5, animate: false });
  }

  /** Find the pose nearest to the pointer, and tell about it if it is near enough. */
  function pick(event, pressed) {
    if (!options.onPick || map.dragging.moving()) return;
    let best = null;
    let least = NEAR_PX / map.options.crs.scale(map.getZoom());
    for (const one of devices) {
      const { name, poses } = one;
      if (hidden.has(name)) continue;
      for (let i = 0; i < poses.length; i += 1) {
        if (!one.isShown(i)) continue;
        const away = Math.hypot(poses.x_m[i] - event.latlng.lng, poses.y_m[i] - event.latlng.lat);
        if (away < least) { least = away; best = [poses.time_s[i], name, i, pressed]; }
      }
    }
    if (best) options.onPick(...best);
  }

  /** Draw everything again in the colours of the present theme. */
  function refreshColours() {
    devices.forEach((one) => one.restyle());
    setTruth(marks.truth);
    setFixes(marks.fixes);
    setVariants(marks.variants);
    setDoubts(marks.doubts);
    drawCursor();
  }

  return {
    setDevices, append, setRegions, setFixes, setTruth, setVariants, setDoubts, setCursor, show, showTimes, fit,
    leaflet: map,
  };
}

/** Make one canvas for each kind of marks, so that their order never changes; returns Leaflet's options by kind. */
function makePanes(map) {
  return Object.fromEntries(MAP_PANES.map((name, i) => {
    map.createPane(name).style.zIndex = 410 + i;
    map.getPane(name).style.pointerEvents = 'none';
    const padding = name === 'cursor' ? 0.1 : 0.4;
    const smoothFactor = ['bands', 'lines'].includes(name) ? 0.4 : 0.1;  // of an ellipse every corner counts
    return [name, { pane: name, renderer: L.canvas({ pane: name, padding }), interactive: false, smoothFactor }];
  }));
}

/** Extend bounds by the 95 % regions of all poses, by a quarter of their size at most: the track stays readable. */
function extendByEllipses(bounds, devices) {
  if (!bounds.isValid()) return;
  const [south, west, north, east] = [bounds.getSouth(), bounds.getWest(), bounds.getNorth(), bounds.getEast()];
  const room = 0.25 * Math.max(north - south, east - west);
  const within = (value, low, high) => Math.min(Math.max(value, low), high);
  for (const { poses } of devices) {
    for (const one of Array.from(poses.x_m, (_, i) => poses.ellipsesOf(i)).flat()) {
      const [across, up] = [one.cxx_m2, one.cyy_m2].map((variance) => Math.sqrt(CHI2_95 * variance));
      if (!Number.isFinite(across + up)) continue;
      for (const sign of [-1, 1]) {
        bounds.extend([within(one.y_m + sign * up, south - room, north + room),
          within(one.x_m + sign * across, west - room, east + room)]);
      }
    }
  }
}

/** Let the wheel zoom the map only after it was pressed, so that the page can be scrolled past it. */
function wheelWhenPressed(map) {
  map.on('mousedown', () => map.scrollWheelZoom.enable());
  map.on('mouseout', () => map.scrollWheelZoom.disable());
}

/** Draw where a device is: a dot, its heading, the ellipses of its 95 % region. */
function drawPose(group, pane, pose, withRegion) {
  const ink = cssColour('--ink');
  if (withRegion) {
    const outlines = pose.ellipses.map(outlineOf).filter((outline) => outline.length);
    const style = { ...pane, color: ink, weight: 1.5, fillOpacity: 0.1, fillRule: 'nonzero' };
    if (outlines.length) L.polygon(outlines.map((outline) => [outline]), style).addTo(group);
  }
  if (Number.isFinite(pose.heading_deg)) {
    const pixels = group._map ? 26 / group._map.options.crs.scale(group._map.getZoom()) : 0;
    const angle = (pose.heading_deg * Math.PI) / 180;
    const tip = [pose.y_m + pixels * Math.sin(angle), pose.x_m + pixels * Math.cos(angle)];
    L.polyline([[pose.y_m, pose.x_m], tip], { ...pane, color: ink, weight: 3 }).addTo(group);
  }
  const style = { ...pane, radius: 6, color: cssColour('--paper'), weight: 2, fillColor: ink, fillOpacity: 1 };
  L.circleMarker([pose.y_m, pose.x_m], style).addTo(group);
}

/** Draw fixes, with their ellipses if they are few, and a line from each to where the track was at its time. */
function drawFixes(group, pane, fixes, device) {
  for (const fix of fixes) {
    const given = fix.kind === 'given';
    const colour = cssColour(given ? '--fix' : '--ink');
    if (fixes.length <= MOST_FIX_ELLIPSES) drawFixEllipse(group, pane, fix);
    const pose = device ? device.poses.at(fix.time_s) : null;
    if (pose) {
      L.polyline([[fix.y_m, fix.x_m], [pose.y_m, pose.x_m]], { ...pane, color: colour, weight: 1.5 }).addTo(group);
    }
    const fill = given ? colour : cssColour('--paper');
    const radius = fixes.length <= MOST_FIX_ELLIPSES ? 5 : 3.5;
    const style = { ...pane, radius, color: given ? cssColour('--paper') : colour, weight: 1.5, fillColor: fill };
    L.circleMarker([fix.y_m, fix.x_m], { ...style, fillOpacity: 1 }).addTo(group);
  }
}

/** Draw the 95 % region of a fix. */
function drawFixEllipse(group, pane, fix) {
  const outline = outlineOf(fix);
  const colour = cssColour(fix.kind === 'given' ? '--fix' : '--ink');
  const style = { ...pane, color: colour, weight: 1, opacity: 0.7, fillOpacity: 0.05 };
  if (outline.length) L.polygon(outline, style).addTo(group);
}
