import { INK, Labels, View, add, arrow, bars, body, boxOf, centreOfMass, colour, cone, escape, hull, node, polyline, short, size, tip, turned, unit } from "./scene.js";
import { UNITS, handle } from "./handles.js";

// The object and its fingers in the plane.
export function plane_stage(svg, rings) {
  let view = null;
  const known = rings.length > 0;
  function frame(contacts) {
    const width = svg.clientWidth || 560, height = Math.round(Math.min(width * 0.95, 560));
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const points = known ? rings.flat() : contacts.map((c) => c.position).concat([[0, 0]]);
    const box = boxOf(points), wide = Math.max(box[2] - box[0], box[3] - box[1]) || 1, pad = 0.17 * wide;
    view = new View(width, height, [box[0] - pad, box[1] - pad, box[2] + pad, box[3] + pad], 14);
    view.wide = wide;
    return view;
  }
  function draw({ answer, list, now, load, perNewton, chosen, away, places }) {
    const layer = node(svg, "g"), shape = known ? rings : [hull(list.map((c) => c.position))];
    body(layer, view, shape, known ? {} : { stroke: "none" });
    const labels = new Labels(layer, view);
    if (places) regions(layer, list, places);
    list.forEach((c, i) => {
      const n = unit(c.normal), t = [-n[1], n[0]], half = 0.06 * view.wide;
      if (!known) { const [a, b] = [view.at(add(c.position, t, half)), view.at(add(c.position, t, -half))]; node(layer, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: INK, "stroke-width": 1.4 }); }
      cone(layer, view, c.position, n, c.friction, 0.2 * view.wide, colour(i));
      labels.block(c.position, 12);
    });
    centreOfMass(layer, view);
    const tipOf = (f, c) => add(c.position, f, perNewton);
    if (now) list.forEach((c, i) => {
      if (now.end) {
        const [a, b] = [view.at(tipOf(now.start[i], c)), view.at(tipOf(now.end[i], c))];
        node(layer, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colour(i), "stroke-width": 1.2, "stroke-dasharray": "2 3" });
        arrow(layer, view, c.position, tipOf(now.end[i], c), { stroke: colour(i), width: 1.3, dash: "5 4", open: true });
      }
      arrow(layer, view, c.position, tipOf(now.at[i], c), { stroke: colour(i), width: 3, class: "force", "data-name": c.name });
      labels.line(c.position, tipOf(now.at[i], c));
    });
    if (answer.locus && now) answer.locus.names.forEach((name, k) => {  // LS_B where it acts: every place the two heads can be
      const i = list.findIndex((c) => c.name === name);
      const [a, b] = answer.locus.ends.map((f) => view.at(tipOf(f[k], list[i])));
      node(layer, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colour(i), "stroke-width": 7, "stroke-opacity": 0.22, "stroke-linecap": "round", class: "locus" });
    });
    if (answer.escape) escape(layer, view, answer.escape, list, shape, 0.35 * view.wide);
    const head = add([0, 0], load, perNewton);
    arrow(layer, view, [0, 0], head, { stroke: INK, width: 3, class: "load" });
    labels.line([0, 0], head);
    list.forEach((c, i) => {
      const force = now ? size(now.at[i]) : 0, idle = now && force * perNewton < 1e-3 * view.wide;
      tip(handle(svg, view, i, c.position, `${c.name}, finger ${i + 1}`, chosen), view, c.position, unit(c.normal), colour(i), idle ? "idle" : "pushes");
      labels.add(now ? `${c.name} ${short(force)} N` : c.name, c.position, [-c.normal[0], -c.normal[1]], { class: "name", ...(away.has(c.name) ? { "font-style": "italic" } : {}) });
    });
    const [x, y] = view.at(head);
    node(handle(svg, view, -1, head, "load", chosen), "circle", { cx: x, cy: y, r: 5, fill: "white", stroke: INK, "stroke-width": 1.6 });
    labels.add(`load ${short(size(load))} N`, head, size(load) ? load : [1, 0]);
    bars(layer, view, perNewton, UNITS);
  }
  // Where each finger may be: alone a thin line beside the surface, all at once, proven, a broad band on it.
  function regions(layer, list, places) {
    for (const [kind, look] of [["together", { "stroke-width": 9, "stroke-opacity": 0.45 }], ["alone", { "stroke-width": 2.4 }]]) {
      for (const found of places[kind]) {
        const i = list.findIndex((c) => c.name === found.name);
        if (i < 0) continue;
        const line = found.points.map((p) => view.at(p)), off = kind === "alone" ? 6 + 4 * i : 0;
        const moved = line.map((p, k) => { const a = line[Math.max(k - 1, 0)], b = line[Math.min(k + 1, line.length - 1)], u = unit([b[0] - a[0], b[1] - a[1]]); return [p[0] - off * u[1], p[1] + off * u[0]]; });
        polyline(layer, moved, { stroke: colour(i), class: `region ${kind}`, ...look });
      }
    }
  }
  return {
    frame, draw,
    moved: (i, x, y) => view.back(x, y),
    // On an outline the surface leads: a key moves along it, in the direction that is nearest to the key's.
    along(i, from, way, far, contact) {
      if (i < 0 || !known) return add(from, way, far);
      const n = unit(contact.normal), t = [-n[1], n[0]], dot = t[0] * way[0] + t[1] * way[1];
      return Math.abs(dot) < 1e-3 ? add(from, t, far * (way[0] + way[1])) : add(from, t, Math.sign(dot) * far);
    },
    spun: known ? null : (normal, angle) => turned(normal, angle),
    free: known ? rings[0][Math.floor(rings[0].length * 0.37)] : null,
    under: null,
  };
}
