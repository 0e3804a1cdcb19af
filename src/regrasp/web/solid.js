import { COLOURS, INK, Labels, MOTION, add, arrow, bars, centreOfMass, colour, hull, node, short, size, tip, unit } from "./scene.js";
import { Camera, cross, dot, triad, turnable } from "./turning.js";
import { UNITS, handle } from "./handles.js";

const LIGHT = unit([0.35, 0.25, 0.9]), CREASE = 0.82;  // the cosine of 35 degrees

// The object and its fingers in space: turned by dragging beside handles; a tap on the surface picks a point.
export function solid_stage(svg, canvas, solid, redraw, picked) {
  const { vertices, faces } = solid || { vertices: [], faces: [] }, camera = new Camera(-0.9, 0.42);
  const normals = faces.map(([a, b, c]) => unit(cross(add(vertices[b], vertices[a], -1), add(vertices[c], vertices[a], -1))));
  const sharp = creases(faces, normals);
  let wide = 1, flat = [], front = [];
  turnable(svg, camera, () => { paint(); redraw(); }, {
    taken: (event) => event.target.closest("[data-handle]") !== null,
    tapped(event) {
      const box = svg.getBoundingClientRect(), at = pick((event.clientX - box.left) * camera.width / box.width, (event.clientY - box.top) * camera.width / box.width);
      if (at) picked(at);
    },
  });
  function frame(contacts) {
    const width = svg.clientWidth || 560, height = Math.round(Math.min(width * 0.95, 560));
    const points = vertices.length ? vertices : contacts.map((c) => c.position), reach = Math.max(...points.map(size), 1e-300);
    wide = 2 * reach;
    camera.frame(width, height, (Math.min(width, height) / 2 - 14) / (1.3 * reach));
    camera.wide = wide;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    canvas.width = 2 * width; canvas.height = 2 * height;
    paint();
    return camera;
  }
  // Faces from far to near, with their sharp edges.
  function paint() {
    flat = vertices.map((p) => camera.at(p));
    const depth = vertices.map((p) => camera.depth(p)), pen = canvas.getContext("2d");
    front = faces.map((f, k) => k).filter((k) => dot(normals[k], camera.towards) > 0);
    const far = new Float64Array(faces.length);
    for (const k of front) far[k] = depth[faces[k][0]] + depth[faces[k][1]] + depth[faces[k][2]];
    front.sort((a, b) => far[a] - far[b]);
    pen.setTransform(2, 0, 0, 2, 0, 0);
    pen.clearRect(0, 0, camera.width, camera.height);
    pen.lineJoin = "round";
    for (const k of front) {
      const [a, b, c] = faces[k].map((v) => flat[v]), grey = Math.round(196 + 48 * Math.max(0, dot(normals[k], LIGHT)));
      pen.fillStyle = pen.strokeStyle = `rgb(${grey},${grey},${grey})`; pen.lineWidth = 0.8;
      pen.beginPath(); pen.moveTo(...a); pen.lineTo(...b); pen.lineTo(...c); pen.closePath(); pen.fill(); pen.stroke();
      pen.strokeStyle = "#555"; pen.lineWidth = 1;
      for (const [p, q] of sharp[k]) { pen.beginPath(); pen.moveTo(...flat[p]); pen.lineTo(...flat[q]); pen.stroke(); }
    }
  }
  // The point of the surface that is seen at a pixel, or null beside the object.
  function pick(x, y) {
    let best = null, nearest = -Infinity;
    for (const k of front) {
      const hit = inside(k, x, y);
      if (hit && camera.depth(hit) > nearest) { best = hit; nearest = camera.depth(hit); }
    }
    return best;
  }
  function inside(k, x, y) {
    const [a, b, c] = faces[k].map((v) => flat[v]), area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (!area) return null;
    const u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area, v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area, w = 1 - u - v;
    if (u < 0 || v < 0 || w < 0) return null;
    const [p, q, r] = faces[k].map((i) => vertices[i]);
    return p.map((value, i) => u * value + v * q[i] + w * r[i]);
  }
  const hidden = (p) => { const seen = pick(...camera.at(p)); return seen !== null && camera.depth(seen) > camera.depth(p) + 0.02 * wide; };
  function draw({ answer, list, now, load, perNewton, chosen, away }) {
    const layer = node(svg, "g"), labels = new Labels(layer, camera), tipOf = (f, c) => add(c.position, f, perNewton);
    list.forEach((c, i) => { cone3(layer, c, 0.14 * wide, colour(i)); labels.block(c.position, 12); });
    centreOfMass(layer, camera, [0, 0, 0]);
    if (now) list.forEach((c, i) => {
      if (now.end) arrow(layer, camera, c.position, tipOf(now.end[i], c), { stroke: colour(i), width: 1.3, dash: "5 4", open: true });
      arrow(layer, camera, c.position, tipOf(now.at[i], c), { stroke: colour(i), width: 3, class: "force", "data-name": c.name });
      labels.line(c.position, tipOf(now.at[i], c));
    });
    if (answer.escape) escape3(layer, answer.escape, list);
    const head = add([0, 0, 0], load, perNewton);
    arrow(layer, camera, [0, 0, 0], head, { stroke: INK, width: 3, class: "load" });
    labels.line([0, 0, 0], head);
    list.forEach((c, i) => {
      const force = now ? size(now.at[i]) : 0, idle = now && force * perNewton < 1e-3 * wide, group = handle(svg, camera, i, c.position, `${c.name}, finger ${i + 1}`, chosen);
      tip(group, camera, c.position, camera.flat(unit(c.normal)), colour(i), idle || hidden(c.position) ? "air" : "pushes");
      const out = camera.flat(c.normal).map((v) => -v);
      labels.add(now ? `${c.name} ${short(force)} N` : c.name, c.position, out, { class: "name", ...(away.has(c.name) ? { "font-style": "italic" } : {}) });
    });
    const [x, y] = camera.at(head);
    node(handle(svg, camera, -1, head, "load", chosen), "circle", { cx: x, cy: y, r: 5, fill: "white", stroke: INK, "stroke-width": 1.6 });
    labels.add(`load ${short(size(load))} N`, head, size(load) ? camera.flat(load) : [1, 0]);
    bars(layer, camera, perNewton, UNITS);
    triad(layer, camera, camera.width - 44, camera.height - 44);
  }
  // A cone's picture is the hull of its tip and its rim.
  function cone3(layer, c, long, fill) {
    const n = unit(c.normal), side = unit(cross(n, Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), other = cross(n, side), rim = [];
    const half = Math.atan(c.friction), [along, across] = [long * Math.cos(half), long * Math.sin(half)];
    for (let k = 0; k < 24; k++) {
      const angle = (k * Math.PI) / 12;
      rim.push(add(add(add(c.position, n, along), side, across * Math.cos(angle)), other, across * Math.sin(angle)));
    }
    const corners = hull([c.position, ...rim].map((p) => camera.at(p)));
    node(layer, "polygon", { points: corners.map((p) => p.map((v) => v.toFixed(1)).join(",")).join(" "), fill, "fill-opacity": 0.22, stroke: fill, "stroke-width": 0.8 });
  }
  function escape3(layer, found, list) {
    const k = (0.22 * wide) / Math.max(...found.velocities.map(size), 1e-300);
    if (found.axis) {
      const [point, way] = found.axis, [a, b] = [-0.7, 0.7].map((s) => camera.at(add(point, way, s * wide)));
      node(layer, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: MOTION, "stroke-width": 1.6, "stroke-dasharray": "9 4 2 4", class: "axis" });
    }
    found.names.forEach((name, i) => {
      const c = list.find((one) => one.name === name);
      if (!c) return;
      arrow(layer, camera, c.position, add(c.position, found.velocities[i], k), { stroke: MOTION, width: 2.2, class: "velocity" });
      const [x, y] = camera.at(c.position);
      if (found.helpless[i]) node(layer, "path", { d: `M${x - 7} ${y - 7}l14 14m0 -14l-14 14`, stroke: COLOURS[1], "stroke-width": 3.2 });
    });
  }
  return {
    frame, draw,
    // A finger follows the surface under the pointer; the load's head keeps its depth.
    moved: (i, x, y, from) => (i < 0 || !faces.length ? camera.back(x, y, camera.depth(from)) : pick(x, y)),
    along: (i, from, way, far) => add(add(from, camera.right, far * way[0]), camera.up, far * way[1]),
    spun: faces.length ? null : (normal, angle) => { const [c, s] = [Math.cos(angle), Math.sin(angle)], w = cross(camera.towards, normal); return normal.map((v, i) => c * v + s * w[i] + (1 - c) * dot(camera.towards, normal) * camera.towards[i]); },
    free: vertices.length ? vertices[Math.floor(vertices.length * 0.37)] : null,
    under: canvas,
  };
}

// Of each face its edges at which the surface turns.
function creases(faces, normals) {
  const seen = new Map(), found = faces.map(() => []);
  faces.forEach((f, k) => f.forEach((p, i) => {
    const q = f[(i + 1) % 3], name = p < q ? `${p} ${q}` : `${q} ${p}`, other = seen.get(name);
    if (other === undefined) seen.set(name, k);
    else if (dot(normals[k], normals[other]) < CREASE) { found[k].push([p, q]); found[other].push([p, q]); }
  }));
  return found;
}
