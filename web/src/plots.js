// SPDX-License-Identifier: MIT
// Line plots in the colours of the page, by uPlot.
import uPlot from "uplot";

/** A colour of style.css. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

const plots = new Set();

/** A plot in an element: { x, y } axis labels; lines: [{ label, colour, dash, width }]. set(data) redraws it. */
export function linePlot(element, { x, y, lines, range }) {
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
        height: 190,
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
            width: line.width ?? 2,
            points: { show: false },
          })),
        ],
      },
      data,
      element,
    );
  };
  draw();
  new ResizeObserver(() => plot.setSize({ width: Math.max(200, element.clientWidth), height: 190 })).observe(element);
  plots.add(draw);
  return {
    set(next) {
      data = next;
      plot.setData(data);
    },
    data: () => data,
  };
}

/** Draws every plot again, in the colours of now. */
export function redrawPlots() {
  for (const draw of plots) draw();
}
