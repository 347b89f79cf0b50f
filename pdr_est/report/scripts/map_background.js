/** Put a background below the tracks of a Leaflet map: a picture, lines of a plan, or map tiles. */
'use strict';

const MOST_TILES_SHOWN = 80;
const TILE_PX = 256;

/** Add the background that `kinds.py` describes; returns a layer that can be removed and added again. */
function addMapBackground(map, background) {
  const group = L.layerGroup().addTo(map);
  if (background.kind === 'picture') addPicture(group, background);
  if (background.kind === 'lines') addPlanLines(map, group, unpackColumns(background.points), background.rings);
  if (background.kind === 'tiles') addTiles(map, group, background);
  if (background.credit) {
    addMapControl(map, 'bottomright', makeElement('div', { className: 'map-credit' }, background.credit));
  }
  return group;
}

/** Add a picture, whose size in pixels is known when it has been loaded. */
function addPicture(group, { url, corner_m: [x, y], pixel_m: [across, down] }) {
  const picture = new Image();
  picture.onload = () => {
    const far = [y + down * picture.naturalHeight, x + across * picture.naturalWidth];
    L.imageOverlay(url, [[y, x], far]).addTo(group);
  };
  picture.src = url;
}

/** Draw lines with a missing point between two of them; the first ones bound walkable floor, which is shaded. */
function addPlanLines(map, group, points, rings) {
  const lines = [[]];
  points.x_m.forEach((x, i) => {
    if (Number.isFinite(x)) lines[lines.length - 1].push([points.y_m[i], x]); else lines.push([]);
  });
  const below = map.getPane('plan') || map.createPane('plan');
  Object.assign(below.style, { zIndex: 405, pointerEvents: 'none' });  // a canvas would keep events
  const pane = { pane: 'plan', renderer: L.canvas({ pane: 'plan', padding: 0.4 }), interactive: false };
  const floor = L.polygon(lines.slice(0, rings), { ...pane, stroke: false, fillOpacity: 0.15 });
  const borders = L.polyline(lines.filter((line) => line.length), { ...pane, weight: 1 });
  const drawn = L.featureGroup([...(rings ? [floor] : []), borders]).addTo(group);
  const colour = () => drawn.setStyle({ color: cssColour('--muted') });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', colour);
  colour();
}

/** Show the Web Mercator tiles that are in sight, each as a picture at its place in metres. */
function addTiles(map, group, background) {
  const { origin_deg: origin, metres_per_degree: size_m, shift_m: shift, zooms } = background;
  const shown = new Map();
  const longitudeOf = (x) => (x + shift[0]) / size_m[0] + origin[0];
  const latitudeOf = (y) => (y + shift[1]) / size_m[1] + origin[1];
  const placeOf = (column, row, zoom) => {
    const latitude = Math.atan(Math.sinh(Math.PI * (1 - (2 * row) / 2 ** zoom))) * (180 / Math.PI);
    const longitude = (360 * column) / 2 ** zoom - 180;
    return [(latitude - origin[1]) * size_m[1] - shift[1], (longitude - origin[0]) * size_m[0] - shift[0]];
  };
  const columnOf = (x, zoom) => Math.floor(((longitudeOf(x) + 180) / 360) * 2 ** zoom);
  const rowOf = (y, zoom) => {
    const latitude = (latitudeOf(y) * Math.PI) / 180;
    return Math.floor((0.5 - Math.asinh(Math.tan(latitude)) / (2 * Math.PI)) * 2 ** zoom);
  };
  const zoomNow = () => {
    const tileAtZero_m = 360 * size_m[0];
    const wanted = Math.log2((tileAtZero_m / TILE_PX) * map.options.crs.scale(map.getZoom()));
    return Math.min(Math.max(Math.round(wanted), zooms[0]), zooms[1]);
  };

  function update() {
    const sight = map.getBounds().pad(0.1);
    const zoom = zoomNow();
    const wanted = new Map();
    const [left, right] = [columnOf(sight.getWest(), zoom), columnOf(sight.getEast(), zoom)];
    const [high, low] = [rowOf(sight.getNorth(), zoom), rowOf(sight.getSouth(), zoom)];
    if ((right - left + 1) * (low - high + 1) <= MOST_TILES_SHOWN) {
      for (let x = left; x <= right; x += 1) {
        for (let y = high; y <= low; y += 1) wanted.set(`${zoom}/${x}/${y}`, [x, y]);
      }
    } else if (background.tiles) {
      Object.keys(background.tiles).forEach((name) => wanted.set(name, name.split('/').slice(1).map(Number)));
    }
    for (const [name, layer] of shown) if (!wanted.has(name)) { layer.remove(); shown.delete(name); }
    for (const [name, [x, y]] of wanted) {
      const url = background.tiles ? background.tiles[name]
        : background.url.replace('{z}', zoom).replace('{x}', x).replace('{y}', y);
      if (shown.has(name) || !url) continue;
      shown.set(name, L.imageOverlay(url, [placeOf(x, y, zoom), placeOf(x + 1, y + 1, zoom)]).addTo(group));
    }
  }

  map.on('moveend', update);
  if (map._loaded) update();
}
