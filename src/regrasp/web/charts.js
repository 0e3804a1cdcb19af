import { GREY, INK, node, polyline, short } from "./scene.js";

const FRAME = { left: 44, right: 40, top: 20, bottom: 22 };

// Round numbers from low to high.
function ticks(low, high, most = 4) {
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw || 1));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw) || power, found = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) found.push(Math.abs(v) < 1e-9 * step ? 0 : v);
  return found;
}

// Lines over one axis. lines: [{values, colour, name, dash, width}], null where there is none; rules: dashed levels.
export function chart(svg, { width, height, xs, lines, title, unit = "", least = 0, rules = [], marks = [], xunit = "", shade = null }) {
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const all = lines.flatMap((l) => l.values.filter((v) => v !== null)).concat(rules.map((r) => r.value));
  let low = Math.min(least, ...all), high = Math.max(...all, least);
  if (!(high - low > 1e-9 * Math.max(Math.abs(high), Math.abs(low)))) high = low + (Math.abs(low) || 1);  // a constant is not magnified
  high += 0.06 * (high - low);
  const inner = [FRAME.left, width - FRAME.right, height - FRAME.bottom, FRAME.top];
  const X = (v) => inner[0] + ((v - xs[0]) / (xs.at(-1) - xs[0] || 1)) * (inner[1] - inner[0]);
  const Y = (v) => inner[2] - ((v - low) / (high - low)) * (inner[2] - inner[3]);
  const words = { "font-size": 12, fill: INK };
  node(svg, "text", { x: 4, y: 12, ...words }, unit ? `${title} [${unit}]` : title);
  if (shade) node(svg, "rect", { x: X(shade[0]), width: Math.max(0, X(shade[1]) - X(shade[0])), y: inner[3], height: inner[2] - inner[3], fill: "#ececec" });
  for (const v of ticks(low, high)) {
    node(svg, "line", { x1: inner[0], x2: inner[1], y1: Y(v), y2: Y(v), stroke: "#e2e2e2" });
    node(svg, "text", { x: inner[0] - 5, y: Y(v) + 4, "text-anchor": "end", ...words }, short(v));
  }
  for (const v of ticks(xs[0], xs.at(-1))) node(svg, "text", { x: X(v), y: height - 6, "text-anchor": "middle", ...words }, short(v));
  node(svg, "text", { x: width - 4, y: height - 6, "text-anchor": "end", ...words }, xunit);
  node(svg, "path", { d: `M${inner[0]} ${inner[3]}V${inner[2]}H${inner[1]}`, fill: "none", stroke: INK });
  for (const r of rules) node(svg, "line", { x1: inner[0], x2: inner[1], y1: Y(r.value), y2: Y(r.value), stroke: r.colour || GREY, "stroke-dasharray": "5 4" });
  const ends = [];
  lines.forEach((line) => {
    let run = [];
    const flush = () => { if (run.length) polyline(svg, run, { stroke: line.colour, "stroke-width": line.width || 2.2, ...(line.dash ? { "stroke-dasharray": line.dash } : {}) }); run = []; };
    line.values.forEach((v, k) => { if (v === null) flush(); else run.push([X(xs[k]), Y(v)]); });
    flush();
    const last = line.values.findLastIndex((v) => v !== null);
    if (line.name && last >= 0) ends.push({ name: line.name, colour: line.colour, x: X(xs[last]), y: Y(line.values[last]) });
  });
  ends.sort((a, b) => a.y - b.y);
  ends.forEach((e, k) => { if (k) e.y = Math.max(e.y, ends[k - 1].y + 13); });
  for (const e of ends) node(svg, "text", { x: Math.min(e.x + 5, width - 36), y: Math.min(e.y, inner[2] - 2) + 4, "font-size": 12, fill: INK, stroke: "white", "stroke-width": 3, "paint-order": "stroke" }, e.name.slice(0, 5));
  for (const m of marks) node(svg, "circle", { cx: X(m.x), cy: Y(m.y), r: 5, fill: m.fill || INK, stroke: INK, "stroke-width": 1.5 });
  const playhead = node(svg, "line", { x1: X(xs[0]), x2: X(xs[0]), y1: inner[3], y2: inner[2], stroke: INK, "stroke-width": 1, visibility: "hidden" });
  return {
    show(x) { playhead.setAttribute("visibility", "visible"); playhead.setAttribute("x1", X(x)); playhead.setAttribute("x2", X(x)); },
    back(px) { return xs[0] + ((px - inner[0]) / (inner[1] - inner[0])) * (xs.at(-1) - xs[0]); },
  };
}
