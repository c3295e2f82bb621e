/// The style sheet of report.html.
#pragma once

namespace npdr::analysis {

inline constexpr const char* kReportStyle = R"(
:root {
  color-scheme: light dark;
  --paper: #ffffff; --shadow: rgba(0, 0, 0, .22); --text: #1c2127; --muted: #5b6570; --page: #ffffff; --card: #f5f7f9;
  --rule: #d8dee4; --accent: #0072b2;
  --good: #1b7837; --good-card: #eef7f0; --bad: #b2182b; --bad-card: #fbeff0;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #1a1a1a; --shadow: rgba(255, 255, 255, .25); --text: #e3e7eb; --muted: #9aa5b1; --page: #14181c; --card: #1d2329;
    --rule: #343c45; --accent: #6cb8e6;
    --good: #5aae61; --good-card: #18271d; --bad: #e8707d; --bad-card: #2e1b1e;
  }
  /* Figures are drawn dark on white; hues stay. */
  .paper svg, .dot { filter: invert(.9) hue-rotate(180deg); }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 2.5rem 1.25rem 4rem; max-width: 74rem;
  background: var(--page); color: var(--text);
  font: 1rem/1.6 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif;
}
h1 { font-size: 1.9rem; line-height: 1.25; margin: 0 0 .75rem; letter-spacing: -.01em; }
h2 {
  font-size: 1.3rem; line-height: 1.3; margin: 2.75rem 0 .75rem; padding-top: .9rem;
  border-top: 1px solid var(--rule);
}
p { max-width: 44rem; margin: 0 0 .9rem; }
a { color: var(--accent); text-decoration: none; }
a:hover { text-decoration: underline; }
nav { margin: 1.5rem 0 0; padding: .8rem 1.1rem; background: var(--card); border-radius: .5rem; }
nav ol { margin: 0; padding-left: 1.4rem; columns: 18rem; }
figure { margin: 1.5rem 0 2rem; }
figcaption { color: var(--muted); font-size: .93rem; max-width: 50rem; }
.table figcaption, .table summary { margin-bottom: .5rem; }
.table summary { color: var(--muted); font-size: .93rem; max-width: 50rem; }
.plot figcaption { margin-top: .6rem; }
.paper {
  border: 1px solid var(--rule); border-radius: .5rem; padding: .5rem;
  text-align: center;
}
.paper svg { max-width: 100%; height: auto; display: block; margin: 0 auto; }
/* Where the page is narrow, what is drawn for that is seen; what isn't keeps the size of its words. */
.narrow { display: none; }
@media (max-width: 40rem) {
  .paper svg { max-width: none; }
  .narrow .paper svg { max-width: 100%; }
  .wide { display: none; }
  .narrow { display: block; }
}
.paper svg .entry { display: none; }
/* A shadow at the side where there is more to see. */
.scroll { --under: var(--page); }
.paper { --under: var(--paper); }
.scroll, .paper {
  overflow-x: auto;
  background:
    linear-gradient(to right, var(--under) 30%, transparent) left / 3rem 100% no-repeat local,
    linear-gradient(to left, var(--under) 30%, transparent) right / 3rem 100% no-repeat local,
    linear-gradient(to right, var(--shadow), transparent) left / .8rem 100% no-repeat scroll,
    linear-gradient(to left, var(--shadow), transparent) right / .8rem 100% no-repeat scroll,
    var(--under);
}
table { border-collapse: collapse; font-size: .95rem; font-variant-numeric: tabular-nums; }
thead th { border-top: 2px solid var(--text); border-bottom: 1px solid var(--text); }
tbody tr:last-child > * { border-bottom: 2px solid var(--text); }
tbody tr:hover > * { background: var(--card); }
th, td { padding: .38rem .65rem; text-align: left; white-space: nowrap; font-weight: 400; }
thead th { font-weight: 600; white-space: normal; vertical-align: bottom; }
sup { line-height: 0; }
th.number, td.number { text-align: right; }
.words { white-space: normal; min-width: 9rem; vertical-align: top; }
.note { color: var(--muted); font-size: .88rem; margin: .35rem 0 0; }
pre {
  background: var(--card); border-radius: .5rem; padding: .75rem 1rem; overflow-x: auto;
  font: .86rem/1.5 ui-monospace, "SFMono-Regular", Menlo, Consolas, monospace;
}
.verdicts { list-style: none; margin: 0 0 1rem; padding: 0; max-width: 60rem; }
.verdicts li { margin: .35rem 0; padding: .45rem .9rem; border-left: .35rem solid; border-radius: .3rem; }
.verdicts p { margin: .2rem 0 0; font-size: .9rem; color: var(--muted); max-width: none; }
.verdicts .holds { border-color: var(--good); background: var(--good-card); }
.verdicts .fails { border-color: var(--bad); background: var(--bad-card); }
.tools { display: flex; flex-wrap: wrap; gap: .3rem .9rem; align-items: center; margin: 0 0 .5rem; font-size: .88rem; }
.tools button, summary { cursor: pointer; }
.tools button {
  font: inherit; min-width: 2rem; padding: .1rem .55rem; color: var(--text);
  background: var(--card); border: 1px solid var(--rule); border-radius: .3rem;
}
.tools label { display: inline-flex; align-items: center; gap: .35rem; }
.dot { width: .7rem; height: .7rem; border-radius: 50%; border: 1px solid var(--rule); }
output { display: block; min-height: 1.5em; font-size: .88rem; color: var(--muted); font-variant-numeric: tabular-nums; }
summary h2 { display: inline; border: 0; padding: 0; margin: 0; }
section > details { margin: 2.75rem 0 .75rem; padding-top: .9rem; border-top: 1px solid var(--rule); }
th button {
  font: inherit; color: inherit; background: none; border: 0; padding: 0; cursor: pointer;
  text-align: inherit; white-space: inherit;
}
th button:hover { text-decoration: underline; }
th[aria-sort="ascending"] button::after { content: " \2191"; }
th[aria-sort="descending"] button::after { content: " \2193"; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
code { font: inherit; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .3rem 1.5rem; font-size: .93rem; }
dt { color: var(--muted); }
dd { margin: 0; overflow-wrap: anywhere; }
@media print {
  body { max-width: none; padding: 0; font-size: .8rem; }
  nav, .tools, output { display: none; }
  .wide { display: block; }
  .narrow { display: none; }
  .scroll, .paper { overflow: visible; background: none; }
  table { font-size: .72rem; }
  th, td { white-space: normal; padding: .2rem .35rem; }
  .paper svg { max-width: 100%; }
  figure, table { break-inside: avoid; }
  h2, summary { break-after: avoid; }
  pre { white-space: pre-wrap; overflow-wrap: anywhere; }
}
)";

}  // namespace npdr::analysis
