// Finds what somebody with weak eyes or without a mouse can't read or reach on a report, and what
// doesn't do as it says, and writes it at the end of the page, a line each.
const findings = new Set();
const dark = matchMedia("(prefers-color-scheme: dark)").matches;
const parse = (color) => {
  const [r, g, b, a = 1] = color.match(/[\d.]+/g).map(Number);
  return {rgb: [r, g, b].map((c) => c / 255), a};
};
// What the page's filter, invert(.9) hue-rotate(180deg), makes of figures (Filter Effects Module).
const filtered = ([r, g, b]) => {
  const [R, G, B] = [r, g, b].map((c) => 0.9 - 0.8 * c);
  return [-0.574 * R + 1.43 * G + 0.144 * B, 0.426 * R + 0.43 * G + 0.144 * B,
          0.426 * R + 1.43 * G - 0.856 * B].map((c) => Math.min(1, Math.max(0, c)));
};
// WCAG 2.1: relative luminance, contrast.
const luminance = (rgb) => {
  const [r, g, b] = rgb.map((c) => (0.03928 >= c ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const contrast = (a, b) => {
  const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
};
const backgroundOf = (element) => {
  for (let at = element; at; at = at.parentElement) {
    const {rgb, a} = parse(getComputedStyle(at).backgroundColor);
    if (a === 1) return rgb;
  }
  return dark ? [0, 0, 0] : [1, 1, 1];
};
const nameOf = (element) => {
  const of = element.closest("[id]");
  return `${element.tagName.toLowerCase()} in ${of ? of.id : "page"}: ${element.textContent.trim().slice(0, 40)}`;
};

document.querySelectorAll("details").forEach((details) => { details.open = true; });
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
let numTexts = 0;
while (walker.nextNode()) {
  const element = walker.currentNode.parentElement;
  if (!walker.currentNode.data.trim() || !element.checkVisibility()) continue;
  if (element.closest("script, title, style")) continue;
  ++numTexts;
  const style = getComputedStyle(element), svg = element.closest("svg");
  const own = parse(svg ? style.fill : style.color).rgb;
  const ratio = contrast(svg && dark ? filtered(own) : own, backgroundOf(svg ? svg.parentElement : element));
  if (ratio < 4.5) findings.add(`contrast ${ratio.toFixed(2)}: ${nameOf(element)}`);
}
if (numTexts < 20) findings.add(`only ${numTexts} texts are to be seen`);

const reachable = "a[href], button, input, summary, [tabindex='0']";
for (const element of document.querySelectorAll("body *")) {
  const scrolls = /auto|scroll/.test(getComputedStyle(element).overflowX) &&
                  element.scrollWidth > element.clientWidth;
  if (scrolls && !element.matches(reachable) && !element.querySelector(reachable))
    findings.add(`can't be scrolled by keys: ${nameOf(element)}`);
}
for (const element of document.querySelectorAll(reachable)) {
  const label = element.closest("label");
  const words = element.getAttribute("aria-label") || element.textContent || (label && label.textContent);
  if (!words || !words.trim()) findings.add(`has no name: ${element.outerHTML.slice(0, 60)}`);
}
if (document.documentElement.scrollWidth > innerWidth)
  findings.add(`the page is wider than its window: ${document.documentElement.scrollWidth} px`);
for (const svg of document.querySelectorAll(".narrow svg, .wide svg")) {
  const {width} = svg.getBoundingClientRect();
  if (width > svg.parentElement.clientWidth) findings.add(`is cut off: ${width} px of a drawing`);
  if (width > 0 && width < 0.85 * svg.viewBox.baseVal.width) findings.add(`has tiny words: a drawing, ${width} px`);
}
// Sorting: numbers by what they are worth, whatever they look like.
const table = [...document.querySelectorAll("table")].find((t) => t.tBodies[0].rows.length > 1);
const [large, small] = [...table.tBodies[0].rows].map((row) => row.cells[1]);
[large.textContent, small.textContent] = ["2000", "[1.07 \u00b1 0.03]e+3"];
table.tHead.rows[0].cells[1].querySelector("button").click();
if (small.parentElement.rowIndex > large.parentElement.rowIndex) findings.add("sorts 2000 before [1.07 \u00b1 0.03]e+3");
const list = document.createElement("pre");
list.id = "findings";
list.textContent = [`theme: ${dark ? "dark" : "light"}`, ...findings].join("\n");
document.body.append(list);
