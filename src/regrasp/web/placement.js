import { GREY, INK, node, short } from "./scene.js";

// Stops of viridis, which grey and every kind of colour-blindness keep in order.
const STOPS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
const none = (i, j) => ((i + j) % 3 ? [255, 255, 255] : [180, 180, 180]);  // hatched, so that grey print tells it from the best
const AROUND = { left: 46, right: 8, top: 44, bottom: 34 };

function shade(share) {
  const x = Math.max(0, Math.min(1, share)) * (STOPS.length - 1), k = Math.min(Math.floor(x), STOPS.length - 2);
  return STOPS[k].map((v, i) => Math.round(v + (x - k) * (STOPS[k + 1][i] - v)));
}

// The map of two fingers over both arc lengths; a tap or arrow keys put both there.
export function map_look(svg, put) {
  let map = null, inner = null, marker = null, cell = [0, 0];
  svg.setAttribute("tabindex", 0);
  function draw(found, width) {
    map = found;
    svg.replaceChildren();
    const side = Math.min(width - AROUND.left - AROUND.right, 380), height = side + AROUND.top + AROUND.bottom, count = map.values.length;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    inner = [AROUND.left, AROUND.top, side];
    const held = map.values.flat().filter((v) => v !== null).sort((a, b) => a - b);
    const low = map.more ? 0 : held[0] || 0, high = (map.more ? held.at(-1) : held[Math.floor(0.9 * held.length)]) || 1;
    const share = (v) => { const s = (v - low) / (high - low || 1); return map.more ? s : 1 - s; };  // bright is better
    const canvas = Object.assign(document.createElement("canvas"), { width: count, height: count }), pen = canvas.getContext("2d"), pixels = pen.createImageData(count, count);
    map.values.forEach((row, j) => row.forEach((v, i) => pixels.data.set([...(v === null ? none(i, j) : shade(share(v))), 255], 4 * ((count - 1 - j) * count + i))));
    pen.putImageData(pixels, 0, 0);
    node(svg, "image", { x: inner[0], y: inner[1], width: side, height: side, href: canvas.toDataURL("image/png"), class: "pixels" });
    node(svg, "rect", { x: inner[0], y: inner[1], width: side, height: side, fill: "none", stroke: INK });
    const words = { "font-size": 12, fill: INK };
    for (let k = 0; k <= 2; k++) {
      const v = short((k * map.length) / 2, 2);
      node(svg, "text", { x: inner[0] + (k * side) / 2, y: inner[1] + side + 14, "text-anchor": k === 2 ? "end" : k ? "middle" : "start", ...words }, v);
      node(svg, "text", { x: inner[0] - 4, y: inner[1] + side - (k * side) / 2 + (k === 2 ? 10 : 4), "text-anchor": "end", ...words }, v);
    }
    node(svg, "text", { x: inner[0] + side / 2, y: height - 4, "text-anchor": "middle", ...words }, `${map.names[0]} at arc length [m]`);
    node(svg, "text", { x: 12, y: inner[1] + side / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${inner[1] + side / 2})`, ...words }, `${map.names[1]} at [m]`);
    for (let k = 0; k < 40; k++) node(svg, "rect", { x: inner[0] + 2 * k, y: 22, width: 2.4, height: 10, fill: `rgb(${shade(map.more ? k / 39 : 1 - k / 39)})` });
    node(svg, "text", { x: 4, y: 13, ...words }, `${map.title}${map.unit === "-" ? "" : ` [${map.unit}]`}, hatched: does not hold`);
    node(svg, "text", { x: inner[0] - 4, y: 31, "text-anchor": "end", ...words }, short(low, 2));
    node(svg, "text", { x: inner[0] + 86, y: 31, ...words }, `${short(high, 2)}${map.more ? "" : " and more"}`);
    marker = node(svg, "g", { class: "marker" });
    node(marker, "circle", { r: 7, fill: "none", stroke: "white", "stroke-width": 4 });
    node(marker, "circle", { r: 7, fill: "none", stroke: "#D55E00", "stroke-width": 2.2 });
  }
  // Where the two fingers are.
  function show(list) {
    if (!map) return;
    const count = map.places.length;
    cell = map.names.map((name) => {
      const c = list.find((one) => one.name === name);
      if (!c) return 0;
      const far = map.places.map((p) => Math.hypot(p[0] - c.position[0], p[1] - c.position[1]));
      return far.indexOf(Math.min(...far));
    });
    marker.setAttribute("transform", `translate(${inner[0] + ((cell[0] + 0.5) / count) * inner[2]} ${inner[1] + (1 - (cell[1] + 0.5) / count) * inner[2]})`);
  }
  const go = (i, j) => { const n = map.places.length, k = (v) => ((v % n) + n) % n; put(map.names, [map.places[k(i)], map.places[k(j)]]); };
  const at = (event) => {
    const box = svg.getBoundingClientRect(), zoom = svg.viewBox.baseVal.width / box.width, n = map.places.length;
    const x = ((event.clientX - box.left) * zoom - inner[0]) / inner[2], y = 1 - ((event.clientY - box.top) * zoom - inner[1]) / inner[2];
    if (x >= 0 && x < 1 && y >= 0 && y < 1) go(Math.floor(x * n), Math.floor(y * n));
  };
  svg.addEventListener("pointerdown", (event) => { if (map && !event.button) { svg.setPointerCapture(event.pointerId); at(event); event.preventDefault(); svg.focus({ preventScroll: true }); } });
  svg.addEventListener("pointermove", (event) => { if (map && svg.hasPointerCapture(event.pointerId)) at(event); });
  svg.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!map || !way) return;
    go(cell[0] + way[0], cell[1] + way[1]);
    event.preventDefault();
  });
  return { draw, show, clear(words) { map = null; svg.replaceChildren(); svg.setAttribute("viewBox", "0 0 360 30"); node(svg, "text", { x: 4, y: 18, "font-size": 13, fill: GREY }, words); } };
}
