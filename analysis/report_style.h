/// The style sheet of report.html.
#pragma once

namespace npdr::analysis {

inline constexpr const char* kReportStyle = R"(
:root {
  color-scheme: light dark;
  --text: #1c2127; --muted: #5b6570; --page: #ffffff; --card: #f5f7f9;
  --rule: #d8dee4; --accent: #0072b2;
}
@media (prefers-color-scheme: dark) {
  :root {
    --text: #e3e7eb; --muted: #9aa5b1; --page: #14181c; --card: #1d2329;
    --rule: #343c45; --accent: #6cb8e6;
  }
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
.table figcaption { margin-bottom: .5rem; }
.plot figcaption { margin-top: .6rem; }
.paper {
  background: #ffffff; border: 1px solid var(--rule); border-radius: .5rem; padding: .5rem;
  overflow-x: auto; text-align: center;
}
.paper svg { max-width: 100%; height: auto; display: block; margin: 0 auto; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .95rem; font-variant-numeric: tabular-nums; }
thead th { border-top: 2px solid var(--text); border-bottom: 1px solid var(--text); }
tbody tr:last-child > * { border-bottom: 2px solid var(--text); }
tbody tr:hover > * { background: var(--card); }
th, td { padding: .38rem .65rem; text-align: left; white-space: nowrap; font-weight: 400; }
thead th { font-weight: 600; white-space: normal; vertical-align: bottom; }
sup { line-height: 0; }
th.number, td.number { text-align: right; }
.note { color: var(--muted); font-size: .88rem; margin: .35rem 0 0; }
pre {
  background: var(--card); border-radius: .5rem; padding: .75rem 1rem; overflow-x: auto;
  font: .86rem/1.5 ui-monospace, "SFMono-Regular", Menlo, Consolas, monospace;
}
pre.command { display: inline-block; margin: .8rem 0 0; padding: .35rem .8rem; max-width: 100%; }
code { font: inherit; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .3rem 1.5rem; font-size: .93rem; }
dt { color: var(--muted); }
dd { margin: 0; overflow-wrap: anywhere; }
@media print {
  body { max-width: none; padding: 0; }
  figure, table { break-inside: avoid; }
}
)";

}  // namespace npdr::analysis
