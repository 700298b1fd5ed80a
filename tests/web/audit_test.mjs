// SPDX-License-Identifier: MIT
// audit_test.mjs NODE_MODULES PAGE.html: axe-core finds no violation, dark and light, on a phone and on a desktop; and
// the page's times and sizes.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { join } from "node:path";

import { serve } from "../../web/serve.mjs";
import { closeBrowser, openPage } from "./browser.mjs";

const [modules, file] = process.argv.slice(2);
const server = await serve(file);
const sizes = { desktop: { width: 1280, height: 800 }, phone: { width: 390, height: 844 } };

for (const [device, size] of Object.entries(sizes))
  for (const colorScheme of ["light", "dark"]) {
    const { page, close } = await openPage(modules, server.address, { ...size, colorScheme });
    await page.evaluate(() => contactSpline.loaded);
    for (let chapter = 1; chapter <= 7; ++chapter) await page.evaluate((chapter) => contactSpline.page.story.go(chapter), chapter);
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
console.log(`largest contentful paint after ${largest.toFixed(0)} ms, the stage moves after ${moving.toFixed(0)} ms`);
console.log(`first force of the struck model within ${(sound - pressed).toFixed(0)} ms of the strike`);
const size = statSync(file).size;
assert.ok(size < 3e6, `${size} bytes`);
console.log(`${(size / 1e6).toFixed(2)} MB`);

// How many times real time the page's audio thread renders, and how many voices that makes.
{
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
// Frames of the screen while 32 notes sound, and how far the sound falls behind the clock.
{
  const { page, close } = await openPage(modules, server.address);
  await page.evaluate(() => contactSpline.loaded);
  await page.selectOption("#instrument", "piano");
  const seconds = process.env.CONTACTSPLINE_FULL_TESTS ? 300 : 4;
  const { frames, behind } = await page.evaluate(async (lasting) => {
    const { page } = contactSpline;
    for (let key = 44; key < 76; ++key) await page.strike(key, 0.5);
    const { context } = page.audio;
    const [began, sounded] = [performance.now(), context.currentTime];
    let frames = 0;
    while (performance.now() - began < 1000 * lasting) {
      await new Promise(requestAnimationFrame);
      ++frames;
    }
    const seconds = (performance.now() - began) / 1000;
    return { frames: frames / seconds, behind: seconds - (context.currentTime - sounded) };
  }, seconds);
  console.log(`32 notes of the piano: ${frames.toFixed(0)} frames a second, sound ${(1000 * behind).toFixed(0)} ms behind after ${seconds} s`);
  await close();
}
await closeBrowser();
server.close();
