// Planar grasps drawn in SVG. Positions are in the world, y up; sizes of letters, lines and heads in pixels.

// Okabe and Ito's colours, as in all figures; a seventh finger begins them again.
export const COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
export const INK = "#222222", GREY = "#767676", PALE = "#ececec", MOTION = "#2E7D32";
const SPACE = "http://www.w3.org/2000/svg";

export const colour = (i) => COLOURS[i % COLOURS.length];
export const add = (a, b, k = 1) => a.map((v, i) => v + k * b[i]);
export const size = (a) => Math.hypot(...a);
export const unit = (a) => { const l = size(a) || 1; return a.map((v) => v / l); };
export const turned = (a, angle) => {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * a[0] - s * a[1], s * a[0] + c * a[1]];
};

// A child element with attributes; text is text, whatever it looks like.
export function node(parent, kind, attributes = {}, text = null) {
  const child = document.createElementNS(SPACE, kind);
  for (const [name, value] of Object.entries(attributes)) child.setAttribute(name, value);
  if (text !== null) child.textContent = text;
  parent.append(child);
  return child;
}

// A number in three digits, with a true minus sign.
export function short(value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

// The largest 1, 2 or 5 times a power of ten not above a value.
export function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].map((k) => k * power).find((v) => v <= value * (1 + 1e-9)) || power;
}

// From the world to pixels: one scale for both axes, the box [x0, y0, x1, y1] in the middle.
export class View {
  constructor(width, height, box, margin = 26) {
    const [x0, y0, x1, y1] = box;
    this.width = width; this.height = height;
    this.scale = Math.min((width - 2 * margin) / (x1 - x0 || 1), (height - 2 * margin) / (y1 - y0 || 1));
    this.middle = [(x0 + x1) / 2, (y0 + y1) / 2];
  }
  at(p) {
    return [this.width / 2 + this.scale * (p[0] - this.middle[0]), this.height / 2 - this.scale * (p[1] - this.middle[1])];
  }
  back(x, y) {
    return [this.middle[0] + (x - this.width / 2) / this.scale, this.middle[1] - (y - this.height / 2) / this.scale];
  }
}

export function boxOf(points) {
  const xs = points.map((p) => p[0]), ys = points.map((p) => p[1]);
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

// Corners of the convex hull, counter-clockwise (Andrew's chains).
export function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const chain = (list) => {
    const out = [];
    for (const p of list) {
      while (out.length > 1) {
        const [a, b] = out.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        out.pop();
      }
      out.push(p);
    }
    return out.slice(0, -1);
  };
  return sorted.length < 3 ? sorted : [...chain(sorted), ...chain(sorted.reverse())];
}

const path = (view, rings) => rings.map((ring) => "M" + ring.map((p) => view.at(p).map((v) => v.toFixed(1)).join(" ")).join("L") + "Z").join("");

// The object: its outline with holes, or, where only contacts are known, their hull as a suggestion.
export function body(parent, view, rings, look = {}) {
  return node(parent, "path", { d: path(view, rings), "fill-rule": "evenodd", fill: PALE, stroke: INK, "stroke-width": 1.2, ...look });
}

export function polyline(parent, points, look) {
  return node(parent, "polyline", { points: points.map((p) => p.map((v) => v.toFixed(1)).join(",")).join(" "), fill: "none", ...look });
}

// A friction cone as a sector of a radius in the world.
export function cone(parent, view, at, normal, friction, radius, fill) {
  const half = Math.atan(friction), points = [view.at(at)];
  for (let k = 0; k <= 12; k++) points.push(view.at(add(at, turned(normal, half * (k / 6 - 1)), radius)));
  return node(parent, "polygon", { points: points.map((p) => p.join(",")).join(" "), fill, "fill-opacity": 0.22, stroke: fill, "stroke-width": 0.8 });
}

// An arrow between points of the world; its head never exceeds it.
export function arrow(parent, view, from, to, look = {}) {
  const [a, b] = [view.at(from), view.at(to)], d = [b[0] - a[0], b[1] - a[1]], length = size(d);
  if (length < 1) return null;
  const { stroke = INK, width = 2.4, dash = null, open = false, ...rest } = look;
  const u = unit(d), head = Math.min(5 + 2 * width, 0.5 * length), neck = add(b, u, -head), side = [-u[1], u[0]];
  const group = node(parent, "g", rest);
  node(group, "line", { x1: a[0], y1: a[1], x2: neck[0], y2: neck[1], stroke, "stroke-width": width, ...(dash ? { "stroke-dasharray": dash } : {}) });
  const corners = [b, add(neck, side, 0.42 * head), add(neck, side, -0.42 * head)];
  node(group, "polygon", { points: corners.map((p) => p.join(",")).join(" "), fill: open ? "white" : stroke, stroke, "stroke-width": 1 });
  return group;
}

// Words beside points that keep clear of each other: each tries places ever farther from its point.
export class Labels {
  constructor(parent, view) { this.parent = parent; this.view = view; this.taken = []; this.drawn = []; }
  block(at, radius) { const [x, y] = this.view.at(at); this.taken.push([x - radius, y - radius, x + radius, y + radius]); }
  // A line is crossed by words only where there is no other place.
  line(from, to) {
    const [a, b] = [this.view.at(from), this.view.at(to)], count = Math.ceil(size(add(b, a, -1)) / 9);
    for (let k = 0; k <= count; k++) { const [x, y] = add(a, add(b, a, -1), k / (count || 1)); this.drawn.push([x - 3, y - 3, x + 3, y + 3]); }
  }
  add(text, at, towards, look = {}) {
    const [x, y] = this.view.at(at), u = unit([towards[0], -towards[1]]);
    const wide = 7.4 * text.length + 4, high = 16;
    let best = null;
    for (const gap of [16, 24, 34, 46]) {
      for (const angle of [0, 0.6, -0.6, 1.2, -1.2, 2, -2]) {
        const d = turned(u, angle), cx = x + d[0] * (gap + wide / 2 - 6), cy = y + d[1] * gap;
        const box = [cx - wide / 2, cy - high / 2, cx + wide / 2, cy + high / 2];
        const outside = Math.max(0, -box[0], -box[1], box[2] - this.view.width, box[3] - this.view.height);
        const hits = (boxes) => boxes.filter((t) => t[0] < box[2] && box[0] < t[2] && t[1] < box[3] && box[1] < t[3]).length;
        const cost = 100 * hits(this.taken) + 4 * hits(this.drawn) + 10 * outside + gap / 10 + Math.abs(angle);
        if (!best || cost < best.cost) best = { cost, cx, cy, box };
      }
    }
    this.taken.push(best.box);
    return node(this.parent, "text", { x: best.cx, y: best.cy + 4.5, "text-anchor": "middle", "font-size": 13, "paint-order": "stroke", stroke: "white", "stroke-width": 3.5, "stroke-linejoin": "round", fill: INK, ...look }, text);
  }
}

// A finger's tip outside the surface: filled where it pushes, open where it only touches, dashed in the air.
export function tip(parent, view, at, normal, fill, state = "pushes", radius = 7) {
  const [x, y] = view.at(at), n = normal ? [normal[0], -normal[1]] : [0, 0];
  return node(parent, "circle", {
    cx: x - radius * n[0], cy: y - radius * n[1], r: radius, stroke: fill, "stroke-width": 2,
    fill: state === "pushes" ? fill : "white", ...(state === "air" ? { "stroke-dasharray": "3 2.5" } : {}),
  });
}

// The centre of mass: a circled cross.
export function centreOfMass(parent, view, at = [0, 0]) {
  const [x, y] = view.at(at), group = node(parent, "g", { stroke: INK, "stroke-width": 1.3, fill: "white" });
  node(group, "circle", { cx: x, cy: y, r: 5 });
  node(group, "path", { d: `M${x - 5} ${y}h10M${x} ${y - 5}v10` });
}

// Two bars of round numbers, which say the scales of length and force.
export function bars(parent, view, perNewton, units) {
  const y = view.height - 10, room = view.width / 5;
  let x = 10;
  for (const [scale, name, look] of [[view.scale, units.length, { "stroke-width": 1.2 }], [view.scale * perNewton, units.force, { "stroke-width": 3 }]]) {
    if (!(scale > 0) || !Number.isFinite(scale)) continue;
    const value = roundBelow(room / scale), long = value * scale;
    node(parent, "path", { d: `M${x} ${y - 4}v4h${long.toFixed(1)}v-4`, fill: "none", stroke: INK, ...look });
    const words = node(parent, "text", { x: x + 4, y: y - 7, "font-size": 12, fill: INK, "paint-order": "stroke", stroke: "white", "stroke-width": 3 }, `${short(value)} ${name}`);
    x += Math.max(long, 8 * words.textContent.length) + 24;
  }
}

// Why nothing holds: the motion of the object, its centre, and which contacts cannot oppose it.
export function escape(parent, view, found, contacts, rings, length) {
  const speed = Math.max(...found.velocities.map(size), 1e-300), k = length / speed;
  const where = new Map(contacts.map((c) => [c.name, c.position]));
  if (rings.length) {
    const moved = rings.map((ring) => ring.map((p) => displaced(p, found, 0.35 * k)));
    body(parent, view, moved, { fill: "none", stroke: MOTION, "stroke-width": 1.4, "stroke-dasharray": "5 4", class: "ghost" });
  }
  found.names.forEach((name, i) => {
    const at = where.get(name);
    if (!at) return;
    arrow(parent, view, at, add(at, found.velocities[i], 0.55 * k), { stroke: MOTION, width: 2.2, class: "velocity" });
    const [x, y] = view.at(at);
    if (found.helpless[i]) node(parent, "path", { d: `M${x - 7} ${y - 7}l14 14m0 -14l-14 14`, stroke: "#D55E00", "stroke-width": 3.2 });
  });
  if (!found.centre) return;
  const [x, y] = view.at(found.centre);
  if (x < 8 || y < 8 || x > view.width - 8 || y > view.height - 8) return;
  const group = node(parent, "g", { class: "centre" }), r = 15, left = found.twist[2] > 0;
  node(group, "circle", { cx: x, cy: y, r: 5, fill: MOTION });
  node(group, "path", { d: `M${x - r} ${y}A${r} ${r} 0 1 ${left ? 0 : 1} ${x} ${y + (left ? r : -r)}`, fill: "none", stroke: MOTION, "stroke-width": 2 });
  const h = left ? [x, y + r] : [x, y - r];
  node(group, "polygon", { points: `${h[0] + 7},${h[1]} ${h[0] - 3},${h[1] - 5} ${h[0] - 3},${h[1] + 5}`, fill: MOTION, transform: left ? `rotate(180 ${h[0]} ${h[1]})` : "" });
}

// A point after a motion v + omega x r, by the rotation it is the start of.
function displaced(p, found, k) {
  const [vx, vy, omega] = found.twist;
  if (!found.centre || Math.abs(omega) < 1e-12) return [p[0] + k * vx, p[1] + k * vy];
  const angle = Math.max(-0.35, Math.min(0.35, k * omega));
  return add(found.centre, turned([p[0] - found.centre[0], p[1] - found.centre[1]], angle));
}
