/// The script of report.html: sorts tables, zooms figures. Without it the page shows the same.
#pragma once

namespace npdr::analysis {

/// Builds no markup from text, and loads nothing. Has no '<', so that the page stays well-formed.
inline constexpr const char* kReportScript = R"js(
"use strict";
const make = (name, text, attributes = {}) => {
  const element = document.createElement(name);
  element.textContent = text;
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
};

// Tables: a click on a title sorts by its column, another one the other way round.
const magnitude = (text) => parseFloat(text.replace(/^\[(\S+).*?\]/, "$1"));  // [1.07 ± 0.03]e+3
const compare = (a, b) => {
  const x = magnitude(a), y = magnitude(b);
  if (isNaN(x) || isNaN(y)) return (isNaN(x) - isNaN(y)) || a.localeCompare(b);
  return x - y;
};
const sort = (table, column, title) => {
  const down = title.getAttribute("aria-sort") === "ascending";
  for (const other of title.parentNode.children) other.removeAttribute("aria-sort");
  title.setAttribute("aria-sort", down ? "descending" : "ascending");
  const rows = [...table.tBodies[0].rows];
  const key = (row) => row.cells[column].textContent.trim();
  rows.sort((a, b) => (down ? -1 : 1) * compare(key(a), key(b)));
  table.tBodies[0].append(...rows);
};
for (const table of document.querySelectorAll("table")) {
  if (2 > table.tBodies[0].rows.length) continue;
  [...table.tHead.rows[0].cells].forEach((title, column) => {
    const button = make("button", title.textContent, {type: "button", title: "Sort"});
    button.addEventListener("click", () => sort(table, column, title));
    title.replaceChildren(button);
  });
}

// Figures: zoom, pan, values at the pointer, entries of the legend on and off.
const hex = (color) => {
  const parts = (color || "").match(/\d+/g);
  if (!/^rgb/.test(color || "") || !parts) return (color || "").toLowerCase();
  return "#" + parts.map((n) => (+n).toString(16).padStart(2, "0")).join("");
};
const colorOf = (shape) => {
  for (const element of [shape, shape.parentNode]) {
    for (const name of ["stroke", "fill", "color"]) {
      const color = hex(element.getAttribute(name));
      if (color.startsWith("#")) return color;
    }
  }
  return "";
};
const number = (value, range) =>
  value.toFixed(Math.min(12, Math.max(0, 3 - Math.floor(Math.log10(Math.abs(range))))));

const equip = (drawing) => {
  const svg = drawing.querySelector("svg"), overlay = drawing.querySelector(".overlay");
  if (!svg || !overlay || !svg.viewBox.baseVal) return;
  const box = svg.viewBox.baseVal;
  const home = [box.x, box.y, box.width, box.height];
  const show = (x, y, w, h) => svg.setAttribute("viewBox", [x, y, w, h].join(" "));
  const zoom = (factor, x = box.x + box.width / 2, y = box.y + box.height / 2) => {
    const scale = Math.min(1, Math.max(1 / 40, (box.width * factor) / home[2]));
    const w = home[2] * scale, h = home[3] * scale;
    if (scale === 1) return show(...home);
    show(x - ((x - box.x) * w) / box.width, y - ((y - box.y) * h) / box.height, w, h);
  };
  const pan = (x, y) => {
    const within = (low, value, high) => Math.max(low, Math.min(value, high));
    show(within(home[0], box.x + x, home[0] + home[2] - box.width),
         within(home[1], box.y + y, home[1] + home[3] - box.height), box.width, box.height);
  };
  const place = (event) =>
    new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());

  const tools = make("div", "", {class: "tools"});
  const output = make("output", "");
  const button = (text, title, action) => {
    const made = make("button", text, {type: "button", title, "aria-label": title});
    made.addEventListener("click", action);
    tools.append(made);
  };
  button("+", "Zoom in", () => zoom(1 / 1.5));
  button("\u2212", "Zoom out", () => zoom(1.5));
  button("Reset", "Reset: show the whole figure", () => show(...home));
  const shapes = [...svg.querySelectorAll("path, polygon, circle, use")];
  for (const entry of overlay.querySelectorAll(".entry")) {
    const label = make("label", "");
    const box = make("input", "", {type: "checkbox", checked: ""});
    box.addEventListener("change", () => {
      for (const shape of shapes) {
        if (colorOf(shape) === entry.dataset.color) shape.style.display = box.checked ? "" : "none";
      }
    });
    const dot = make("span", "", {class: "dot"});
    dot.style.background = entry.dataset.color;
    label.append(box, dot, document.createTextNode(entry.dataset.name));
    tools.append(label);
  }
  drawing.querySelector(".paper").before(tools);
  drawing.querySelector(".paper").after(output);

  const panels = [...overlay.querySelectorAll(".panel")];
  const value = (data, axis, share) => {
    const low = +data[axis + "Lower"], high = +data[axis + "Upper"];
    return `${data[axis + "Title"]}: ${number(low + share * (high - low), high - low)}`;
  };
  const read = (point) => {
    for (const panel of panels) {
      const x = (point.x - panel.x.baseVal.value) / panel.width.baseVal.value;
      const y = 1 - (point.y - panel.y.baseVal.value) / panel.height.baseVal.value;
      if (0 > x || x > 1 || 0 > y || y > 1) continue;
      const words = [];
      if (panel.dataset.xTitle) words.push(value(panel.dataset, "x", x));
      if (panel.dataset.yTitle && panel.dataset.yTitle !== panel.dataset.xTitle) {
        words.push(value(panel.dataset, "y", y));
      }
      return words.join(", ");
    }
    return "";
  };
  let from = null;
  svg.addEventListener("pointerdown", (event) => {
    if (box.width === home[2]) return;
    from = place(event);
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    const point = place(event);
    if (from) pan(from.x - point.x, from.y - point.y);
    output.textContent = read(point);
  });
  svg.addEventListener("pointerup", () => { from = null; });
  svg.addEventListener("pointerleave", () => { output.textContent = ""; });
  svg.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    const point = place(event);
    zoom(event.deltaY > 0 ? 1.2 : 1 / 1.2, point.x, point.y);
  }, {passive: false});
  svg.setAttribute("tabindex", "0");
  svg.addEventListener("keydown", (event) => {
    const step = box.width / 10;
    const act = {
      "+": () => zoom(1 / 1.5), "-": () => zoom(1.5), "0": () => show(...home),
      ArrowLeft: () => pan(-step, 0), ArrowRight: () => pan(step, 0),
      ArrowUp: () => pan(0, -step), ArrowDown: () => pan(0, step)}[event.key];
    if (!act || (event.key.startsWith("Arrow") && box.width === home[2])) return;
    event.preventDefault();
    act();
  });
};
document.querySelectorAll(".drawing").forEach(equip);

// What is folded belongs on paper, too.
addEventListener("beforeprint", () => {
  for (const details of document.querySelectorAll("details")) details.open = true;
});
)js";

/// SHA-256 of the script, which the page's content security policy allows alone.
inline constexpr const char* kReportScriptHash =
    "sha256-k0szTtsyELNSSi8mks2jkbV5uz3nn8qqe/4nakI6d/0=";

}  // namespace npdr::analysis
