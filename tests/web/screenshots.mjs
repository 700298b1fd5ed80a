// SPDX-License-Identifier: MIT
// screenshots.mjs NODE_MODULES PAGE.html FOLDER: the page after a strike and each chapter of its story, a fitted material, the instrument file, on a phone and a desktop, dark and light, to look
// at; preview.png, the image of links; and docs-light.png, which is docs/figures/web.png.
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

import { serve } from "../../web/serve.mjs";
import { closeBrowser, openPage } from "./browser.mjs";

const [modules, file, folder] = process.argv.slice(2);
const server = await serve(file);
mkdirSync(folder, { recursive: true });
const devices = { desktop: { width: 1280, height: 800 }, phone: { width: 390, height: 844 }, docs: { width: 1280, height: 800 }, "phone-aside": { width: 844, height: 390 } };

// What a link to the page shows: its stage in a blow.
{
  const { page, close } = await openPage(modules, `${server.address}?embed`, { width: 1200, height: 630 });
  await page.evaluate(() => contactSpline.loaded);
  await page.evaluate(() => {
    const { stage } = contactSpline.page;
    stage.setPlaying(false);
    stage.time.value = 0.26;
    stage.time.dispatchEvent(new Event("input"));
  });
  await page.addStyleTag({ content: "#play > :not(#stage-figure), #change, footer, #stage-play { display: none !important }" });
  await page.screenshot({ path: join(folder, "preview.png") });
  await close();
}
const examples = new URL("../../examples/fit/", import.meta.url);
const pulses = ["felt.fit.json", ...[1, 2, 3, 4, 5].map((i) => `felt_${i}.csv`)].map((name) => fileURLToPath(new URL(name, examples)));
for (const [device, size] of Object.entries(devices))
  for (const colorScheme of ["light", "dark"]) {
    const { page, close } = await openPage(modules, server.address, { ...size, colorScheme, permissions: ["midi"] });
    await page.evaluate(() => contactSpline.loaded);
    for (const key of "adg") {
      await page.keyboard.down(key);
      await page.waitForTimeout(600);
    }
    await page.evaluate(() => {
      const { stage } = contactSpline.page;
      stage.setPlaying(false);
      stage.time.value = 0.26;
      stage.time.dispatchEvent(new Event("input"));
    });
    // What is out of view is not drawn.
    for (const seen of device === "docs" ? ["#figures", "#play"] : []) {
      await page.evaluate((seen) => document.querySelector(seen).scrollIntoView({ behavior: "instant", block: "end" }), seen);
      await page.waitForTimeout(600);
    }
    const below = device === "docs" ? { fullPage: true, clip: { x: 0, y: 0, width: 1280, height: 1390 } } : {};
    await page.screenshot({ path: join(folder, `${device}-${colorScheme}.png`), ...below });
    for (let chapter = 1; device !== "docs" && chapter <= 9; ++chapter) {
      await page.evaluate((chapter) => contactSpline.page.story.go(chapter), chapter);
      await page.waitForTimeout(400);
      await page.locator(`#chapter-${chapter}`).screenshot({ path: join(folder, `${device}-${colorScheme}-chapter-${chapter}.png`) });
    }
    await page.getByText("Fit a material to measurements").click();
    await page.locator("#fit-input").setInputFiles(pulses);
    await page.getByText("Fitted in").waitFor();
    if (device !== "docs") await page.locator("#editor").screenshot({ path: join(folder, `${device}-${colorScheme}-material.png`) });
    const editor = page.locator("#instrument-editor");
    await editor.scrollIntoViewIfNeeded();
    await page.locator("#file-drawing svg").waitFor();
    if (device !== "docs") await editor.screenshot({ path: join(folder, `${device}-${colorScheme}-instrument.png`) });
    await page.screenshot({ path: join(folder, `${device}-${colorScheme}-whole.png`), fullPage: true });
    await close();
  }
await closeBrowser();
server.close();
