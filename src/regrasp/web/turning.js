import { INK, add, node, size } from "./scene.js";

export const dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// From space to pixels without perspective: what is right, up and towards the eye, z upwards.
export class Camera {
  constructor(azimuth, elevation) { this.azimuth = azimuth; this.elevation = elevation; this.middle = [0, 0, 0]; this.frame(100, 100, 1); this.turn(0, 0); }
  frame(width, height, scale) { this.width = width; this.height = height; this.scale = scale; }
  turn(across, upwards) {
    this.azimuth += across; this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation + upwards));
    const [c, s, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    this.towards = [ce * c, ce * s, se]; this.right = [-s, c, 0]; this.up = [-se * c, -se * s, ce];
  }
  flat(v) { return [dot(v, this.right), dot(v, this.up)]; }
  at(p) { const [x, y] = this.flat(add(p, this.middle, -1)); return [this.width / 2 + this.scale * x, this.height / 2 - this.scale * y]; }
  depth(p) { return dot(p, this.towards); }
  // The point of space under a pixel at a depth.
  back(x, y, depth) {
    const flat = [(x - this.width / 2) / this.scale, (this.height / 2 - y) / this.scale], middle = this.flat(this.middle);
    return add(add(add([0, 0, 0], this.right, flat[0] + middle[0]), this.up, flat[1] + middle[1]), this.towards, depth);
  }
}

// Hands and keys turn a camera; on a press something else may be taken instead, and a press without a way is a tap.
export function turnable(svg, camera, redraw, { taken = () => false, tapped = () => {} } = {}) {
  svg.setAttribute("tabindex", 0);
  svg.addEventListener("pointerdown", (event) => {
    if (event.button || taken(event)) return;
    const held = event.pointerId;
    let [x, y] = [event.clientX, event.clientY], way = 0;
    svg.setPointerCapture(held);
    const move = (e) => {
      if (e.pointerId !== held) return;
      const d = [e.clientX - x, e.clientY - y];
      way += size(d);
      if (way > 4) { camera.turn(-0.01 * d[0], 0.01 * d[1]); redraw(); }
      [x, y] = [e.clientX, e.clientY];
    };
    const end = (e) => {
      if (e.pointerId !== held) return;
      svg.removeEventListener("pointermove", move);
      for (const kind of ["pointerup", "pointercancel"]) svg.removeEventListener(kind, end);
      if (e.type === "pointerup" && way <= 4) tapped(e);
    };
    svg.addEventListener("pointermove", move);
    for (const kind of ["pointerup", "pointercancel"]) svg.addEventListener(kind, end);
    event.preventDefault();
    svg.focus({ preventScroll: true });
  });
  svg.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (!turn || event.target !== svg) return;
    camera.turn(...turn); redraw();
    event.preventDefault();
  });
}

// Which way x, y and z point, in a corner.
export function triad(parent, camera, x, y, long = 24) {
  ["x", "y", "z"].forEach((name, i) => {
    const axis = [0, 0, 0].with(i, 1), [dx, dy] = camera.flat(axis);
    node(parent, "line", { x1: x, y1: y, x2: x + long * dx, y2: y - long * dy, stroke: INK, "stroke-width": 1.4 });
    node(parent, "text", { x: x + (long + 8) * dx, y: y - (long + 8) * dy + 4, "text-anchor": "middle", "font-size": 12, fill: INK }, name);
  });
}
