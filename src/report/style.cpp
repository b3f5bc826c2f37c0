#include "style.h"

namespace palpate::report {

// The root has the class "on-paper" while the script draws charts for print, which has no dark mode.
const char* const kStyleSheet = R"css(
:root { color-scheme: light dark; --page: #ffffff; --ink: #1c2126; --quiet: #5c6670; --line: #d9dee3;
  --faint: #b4bcc4; --tint: #f4f6f8; --accent: #1f6fae;
  --good: #1e7a46; --bad: #b3261e; --good-tint: #e9f5ee; --bad-tint: #fbeae9; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; border-radius: 2px; }
@media screen and (prefers-color-scheme: dark) { :root:not(.on-paper) {
  --page: #15191d; --ink: #e3e7eb; --quiet: #9aa5b0;
  --line: #353c44; --faint: #56606a; --tint: #1d2329; --accent: #6fb1e6;
  --good: #6fcf97; --bad: #f28b82; --good-tint: #1a2b22; --bad-tint: #331f1f; } }
* { box-sizing: border-box; }
html { background: var(--page); color: var(--ink);
  font: 16px/1.55 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
body { max-width: 64rem; margin: 0 auto; padding: 2.5rem 1.5rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .5rem; letter-spacing: -.01em; }
h1, h2, h3, h4, p, li, figcaption { overflow-wrap: anywhere; }
h4 { font-size: .9rem; margin: 1.25rem 0 .4rem; }
.part { border-top: 3px solid var(--accent); margin-top: 3rem; }
.part > h2 { border: 0; margin-top: .75rem; font-size: 1.5rem; }
.part h3 { font-size: 1.15rem; margin-top: 2.25rem; }
a { color: var(--accent); }
nav ol { padding-left: 1.4rem; }
nav li { margin: .6rem 0; }
nav span { display: block; color: var(--ink); max-width: 46rem; }
.answer { background: var(--tint); border-left: 4px solid var(--accent); border-radius: 0 4px 4px 0;
  padding: .4rem 1.1rem; margin: 1rem 0 1.5rem; }
.answer p { font-weight: 600; margin: .5rem 0 .2rem; max-width: none; }
.answer ul { margin: .1rem 0 .7rem; padding-left: 1.2rem; }
.answer li { margin: .2rem 0; }
h2 { font-size: 1.25rem; margin: 2.75rem 0 .75rem; padding-bottom: .3rem;
  border-bottom: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.75rem 0 .5rem; }
p { margin: .5rem 0 .9rem; max-width: 46rem; }
figure { margin: 1.25rem 0; }
figure img { display: block; width: 100%; height: auto; }
figure img { border: 1px solid var(--line); border-radius: 4px; }
figcaption, caption { color: var(--quiet); font-size: .875rem; text-align: left; padding: .4rem 0;
  max-width: 46rem; }
caption { caption-side: top; }
caption span { display: block; position: sticky; left: 0; max-width: min(46rem, calc(100vw - 2rem)); }
.scroll { overflow-x: auto; margin: .75rem 0 1.25rem; }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums; }
th, td { padding: .32rem .8rem .32rem 0; text-align: left; vertical-align: baseline;
  border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--quiet); vertical-align: bottom; line-height: 1.3; }
th:last-child, td:last-child { padding-right: .4rem; }
th:first-child, td:first-child { padding-left: .4rem; }
th.n { padding-left: .6rem; }
.n { text-align: right; }
td { white-space: nowrap; }
td.w { white-space: normal; min-width: 16rem; overflow-wrap: anywhere; }
tr.good td:last-child { color: var(--good); }
tr.bad td { background: var(--bad-tint); }
tr.bad td:last-child { color: var(--bad); font-weight: 700; }
tr.faint td { color: var(--quiet); }
.groups section { max-width: 100%; overflow-x: auto; }
.groups { display: flex; flex-wrap: wrap; gap: 0 3rem; align-items: flex-start; }
.lead { display: grid; gap: 0 1.5rem; align-items: start;
  grid-template-columns: repeat(auto-fit, minmax(min(24rem, 100%), 1fr)); }
.lead > * { min-width: 0; }
.lead figure { margin: 1rem 0 0; }
.multiples { display: grid; gap: 0 1.5rem;
  grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); }
.multiples figure { margin: .5rem 0; min-width: 0; }
details { margin: 1rem 0; }
summary { cursor: pointer; color: var(--accent); }
table.facts th { font-weight: 400; padding-right: 2rem; white-space: nowrap; vertical-align: baseline; }
pre { background: var(--tint); border: 1px solid var(--line); border-radius: 4px; padding: .9rem 1.1rem;
  overflow-x: auto; font: .8125rem/1.5 ui-monospace, "DejaVu Sans Mono", monospace; }
table.heat { font-size: .75rem; border-collapse: separate; border-spacing: 1px; }
table.heat th, table.heat td { border: 0; padding: .1rem .25rem; vertical-align: middle; }
table.heat th { font-weight: 400; color: var(--ink); text-align: left; white-space: nowrap; }
table.heat tbody tr:not(.group) th { position: sticky; left: 0; background: var(--page);
  padding-left: .8rem; padding-right: .6rem; }
table.heat th.up { height: 11rem; vertical-align: bottom; padding: 0; }
table.heat th.up span { display: block; width: 1.3rem; writing-mode: vertical-rl; transform: rotate(180deg);
  line-height: 1.3rem; }
table.heat tr.group th { padding-top: .9rem; color: var(--quiet); white-space: normal; }
table.heat tr.group th span { display: block; width: 0; white-space: nowrap; position: sticky; left: .2rem; }
.wide { width: max-content; min-width: 100%; max-width: calc(100vw - 4rem); position: relative; left: 50%;
  transform: translateX(-50%); }
table.heat tr.group b { color: var(--ink); font-weight: 600; }
table.heat td { width: 1.3rem; min-width: 1.3rem; height: 1.3rem; padding: 0; text-align: center;
  cursor: default; }
table.heat td:focus { outline: 2px solid var(--accent); outline-offset: 1px; }
.heatread { white-space: pre-line; min-height: 7rem; font-size: .8125rem; }
@media print { .heatread { display: none; } }
.heatkey { list-style: none; margin: .5rem 0 1rem; padding: 0; font-size: .8125rem; columns: 2;
  max-width: 60rem; }
.heatkey li { break-inside: avoid; padding: .12rem 0 .12rem 1.85rem; text-indent: -1.85rem; }
.heatkey span { display: inline-block; width: 1.45rem; text-indent: 0; text-align: center;
  margin-right: .4rem; font-size: .75rem; line-height: 1.35rem; }
.v0 { background: #1b7f5c; color: #fff; } .v1 { background: #8ccbb0; color: #10241c; }
.v2 { background: #dbe9c8; color: #20261a; }
.v3 { background: #f3d27a; color: #2d2408; } .v4 { background: #e0803a; color: #1f1005; }
.v5 { background: #b3261e; color: #fff; }
.v6 { background: #6d1b7b; color: #fff; } .v7 { background: #8a9099; color: #101214; }
.v8 { background: #b5179e; color: #fff; }
.odd { outline: 3px solid #e5007d; outline-offset: -2px; font-weight: 700; }
th[data-sort] { white-space: normal; min-width: 4.5rem; }
button { font: inherit; color: inherit; }
button.sort { background: none; border: 0; padding: 0 1.1em 0 0; margin: 0; position: relative;
  font-weight: 600; text-align: inherit; cursor: pointer; }
button.sort::after { content: "\2195"; color: var(--line); position: absolute; right: .1em;
  bottom: 0; }
th[aria-sort] { color: var(--accent); }
th[aria-sort="ascending"] button.sort::after { content: "\2191"; color: var(--accent); }
th[aria-sort="descending"] button.sort::after { content: "\2193"; color: var(--accent); }
.chart { position: relative; max-width: 52rem; }
.values { color: var(--quiet); }
.live { width: 100%; overflow: hidden; }
.live:empty { height: 20rem; }
.live .u-title { font-size: .9rem; font-weight: 600; }
.live .u-select { background: color-mix(in srgb, var(--accent) 18%, transparent); }
.live .u-cursor-x, .live .u-cursor-y { border-color: var(--quiet); }
.legend { display: flex; flex-wrap: wrap; gap: .25rem .5rem; padding: .25rem 0 0 62px; font-size: .8125rem; }
.legend button { display: inline-flex; align-items: center; gap: .4rem; background: none;
  border: 1px solid transparent; border-radius: 4px; padding: .1rem .4rem; cursor: pointer; }
.legend button:hover { border-color: var(--line); }
.legend button[aria-pressed="false"] { color: var(--quiet); text-decoration: line-through; }
.legend button[aria-pressed="false"] i { opacity: .25; }
.legend .reset { border-color: var(--accent); color: var(--accent); }
.legend .reset[hidden] { display: none; }
.legend .save { color: var(--quiet); }
.legend i, .reading i { display: inline-block; width: 1.1rem; height: 0;
  border-top: 3px solid var(--swatch); }
.legend i.dashed { border-top-style: dashed; border-top-width: 2px; }
.reading { position: absolute; z-index: 2; pointer-events: none; background: var(--page);
  border: 1px solid var(--line); border-radius: 4px; padding: .25rem .5rem; font-size: .8125rem;
  line-height: 1.4; max-width: min(22rem, 90%); box-shadow: 0 1px 4px rgb(0 0 0 / .2);
  font-variant-numeric: tabular-nums; }
.reading div { display: flex; align-items: center; gap: .4rem; }
.reading[hidden], .ring[hidden] { display: none; }
.ring { position: absolute; width: 14px; height: 14px; margin: -7px 0 0 -7px; border-radius: 50%;
  border: 2px solid var(--ink); pointer-events: none; }
.view { max-width: 52rem; }
.view[hidden] { display: none; }
.stage { overflow: hidden; }
.stage canvas { display: block; width: 100%; border: 1px solid var(--line); border-radius: 4px;
  background: var(--tint); }
.player { display: flex; align-items: center; gap: .75rem; margin-top: .4rem; font-size: .875rem; }
.player button { min-width: 4.5rem; padding: .2rem .6rem; background: var(--tint); cursor: pointer;
  border: 1px solid var(--line); border-radius: 4px; }
.player input { flex: 1; min-width: 6rem; accent-color: var(--accent); }
.scale { display: flex; align-items: center; gap: .5rem; font-size: .8125rem; color: var(--quiet);
  padding-top: .3rem; }
.scale i { flex: 0 1 12rem; height: .7rem; border-radius: 2px; print-color-adjust: exact; }
.player output { min-width: 5rem; text-align: right; font-variant-numeric: tabular-nums; }
@media (max-width: 40rem) { body { padding: 1.25rem 1rem 3rem; } h1 { font-size: 1.5rem; }
  .legend { padding-left: 0; } .groups { gap: 0 1.5rem; } .heatkey { columns: 1; }
  table.facts th { padding-right: 1rem; }
  table.facts td { white-space: normal; overflow-wrap: anywhere; } td.w { min-width: 12rem; }
  .wide { max-width: 100%; left: 0; transform: none; } }
@media print { .player, .legend .reset, .legend .save, .reading, .ring, details:not([open]) { display: none; }
  .live .uplot, .live .u-wrap { width: 100% !important; height: auto !important; }
  .live canvas { height: auto; } button.sort::after { content: none; }
  .answer { border: 1px solid var(--line); } .part { break-before: page; }
  .v0, .v1, .v2, .v3, .v4, .v5, .v6, .v7, .v8 { print-color-adjust: exact; }
  :root { color-scheme: light; --page: #ffffff; --ink: #000000; --quiet: #444444; --line: #bbbbbb;
    --tint: #f2f2f2; --good: #1e7a46; --bad: #b3261e; --bad-tint: #ffffff; }
  html { font-size: 10.5pt; } body { max-width: none; padding: 0; }
  h2, h3 { break-after: avoid; } figure, tr { break-inside: avoid; } pre { white-space: pre-wrap; }
  .scroll { overflow: visible; }
  .scroll td, .scroll th { white-space: normal; min-width: 0; padding-right: .4rem; }
  table { font-size: 7.5pt; } button.sort { padding: 0; } }
)css";

}  // namespace palpate::report
