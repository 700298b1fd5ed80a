// SPDX-License-Identifier: MIT
// Line plots in the colours of the page, by uPlot.
import uPlot from "uplot";
import { csvOf, download } from "./save.js";

const plots = new Set();
const colours = new Map(); // of the theme that is shown

/** A colour of style.css. */
export function colour(name) {
  if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  return colours.get(name);
}

/** A plot in an element: { x, y } axis labels; lines: [{ label, colour, dash, width, isPoints, size, isFilled }]; height [px]. set(data) redraws it. A button
 * in the caption of its figure saves the data as CSV. */
export function linePlot(element, { x, y, lines, range, height = 190 }) {
  let plot = null;
  let data = [[], ...lines.map(() => [])];
  const axis = (label) => ({
    label,
    labelSize: 14,
    labelGap: 0,
    labelFont: "12px system-ui",
    font: "12px system-ui",
    stroke: colour("soft"),
    grid: { stroke: colour("line"), width: 1 },
    ticks: { stroke: colour("line"), width: 1 },
  });
  const draw = () => {
    plot?.destroy();
    plot = new uPlot(
      {
        width: Math.max(200, element.clientWidth),
        height,
        scales: { x: { time: false }, y: range ? { range } : {} },
        axes: [{ ...axis(x), size: 30 }, { ...axis(y), size: 48 }],
        cursor: { show: false },
        legend: { live: false },
        series: [
          {},
          ...lines.map((line) => ({
            label: line.label,
            stroke: colour(line.colour),
            dash: line.dash,
            width: line.isPoints ? 0 : (line.width ?? 2),
            pxAlign: 0, // whole pixels make steps of a straight line
            fill: line.isFilled ? `${colour(line.colour)}40` : undefined,
            spanGaps: lines.some(({ isPoints }) => isPoints), // null: a point that another line has
            points: { show: line.isPoints ?? false, size: line.size ?? 6, fill: colour(line.colour) },
          })),
        ],
      },
      data,
      element,
    );
  };
  draw();
  new ResizeObserver(() => plot.setSize({ width: Math.max(200, element.clientWidth), height })).observe(element);
  plots.add(draw);
  const save = document.createElement("button");
  const caption = element.parentElement.querySelector("figcaption");
  const title = caption.querySelector("b").textContent;
  save.textContent = "CSV";
  save.className = "small";
  save.setAttribute("aria-label", `Save as CSV: ${title}`);
  save.addEventListener("click", () =>
    download(`${title.toLowerCase().replace(/\W+/g, "_")}.csv`, csvOf([x, ...lines.map(({ label }) => `${label}: ${y}`)], data), "text/csv"),
  );
  caption.append(" ", save);
  return {
    set(next) {
      data = next;
      plot.setData(data);
    },
    data: () => data,
  };
}

/** Takes the colours of the theme that is shown now, and draws every plot again. */
export function redrawPlots() {
  colours.clear();
  for (const draw of plots) draw();
}
