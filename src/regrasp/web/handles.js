import { node } from "./scene.js";

export const UNITS = { length: "m", force: "N" };

// What hands take: a finger by its number, or the load, -1.
export function handle(svg, view, i, at, name, chosen) {
  const group = node(svg, "g", { class: `handle${i === chosen ? " chosen" : ""}`, tabindex: 0, role: "button", "aria-label": `${name}: arrow keys move it`, "data-handle": i });
  const [x, y] = view.at(at);
  node(group, "circle", { cx: x, cy: y, r: 20, class: "ring" });
  return group;
}

// One pointer drags one handle; moved hears its number and where the pointer is, in pixels of the picture.
export function dragged(svg, view, { taken, moved, settled }) {
  svg.addEventListener("pointerdown", (event) => {
    const target = event.target.closest("[data-handle]");
    if (!target || event.button) return;
    const i = Number(target.dataset.handle), box = svg.getBoundingClientRect(), held = event.pointerId;
    taken(i);
    target.focus({ preventScroll: true });
    svg.setPointerCapture(held);
    const onMove = (e) => {
      if (e.pointerId !== held) return;
      const zoom = view().width / box.width;
      moved(i, (e.clientX - box.left) * zoom, (e.clientY - box.top) * zoom);
    };
    const onEnd = (e) => {
      if (e.pointerId !== held) return;
      for (const kind of ["pointerup", "pointercancel"]) svg.removeEventListener(kind, onEnd);
      svg.removeEventListener("pointermove", onMove);
      settled();
    };
    svg.addEventListener("pointermove", onMove);
    for (const kind of ["pointerup", "pointercancel"]) svg.addEventListener(kind, onEnd);
    event.preventDefault();
  });
}

// An SVG picture, over a canvas if there is one, as a PNG to be saved.
export function saved(svg, width, height, under = null) {
  const picture = svg.cloneNode(true), zoom = 2;
  picture.querySelectorAll(".ring").forEach((r) => r.remove());
  picture.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  picture.setAttribute("width", width); picture.setAttribute("height", height);
  picture.setAttribute("font-family", "sans-serif");
  const image = new Image(), canvas = Object.assign(document.createElement("canvas"), { width: zoom * width, height: zoom * height });
  image.onload = () => {
    const pen = canvas.getContext("2d");
    pen.fillStyle = "white"; pen.fillRect(0, 0, canvas.width, canvas.height);
    if (under) pen.drawImage(under, 0, 0, canvas.width, canvas.height);
    pen.drawImage(image, 0, 0, canvas.width, canvas.height);
    Object.assign(document.createElement("a"), { href: canvas.toDataURL("image/png"), download: "regrasp.png" }).click();
  };
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(picture))}`;
}
