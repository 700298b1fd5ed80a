// SPDX-License-Identifier: MIT
// What the first screen must hold on laptops and phones, upright and on their side.
import assert from "node:assert/strict";

export const kFirstScreens = [[1440, 900], [1280, 720], [390, 844], [844, 390]].map(([width, height]) => ({ width, height }));

/** Asserts that the sentence, the stage, what plays and the keys are whole in the first screen, and that the stage is large. */
export async function assertFirstScreen(page, { width, height }) {
  const name = `${width} x ${height}`;
  const inner = await page.evaluate(() => document.documentElement.clientWidth); // without a bar to scroll
  const boxes = {};
  for (const shown of ["h1", "#stage", "#strike", "#piece", "#scores", "#keys", "#undo", "#share", "#theme"]) {
    boxes[shown] = await page.locator(shown).evaluate((element) => element.getBoundingClientRect().toJSON());
    const { left, right, top, bottom } = boxes[shown];
    assert.ok(left >= 0 && right <= inner && top >= 0 && bottom <= height && bottom - top > 15, `${name}, ${shown}: ${JSON.stringify(boxes[shown])}`);
  }
  assert.ok(boxes["#stage"].width === inner && boxes["#stage"].height > 0.5 * height, `${name}: a stage of ${boxes["#stage"].width} x ${boxes["#stage"].height}`);
  assert.ok(boxes["#keys"].top >= boxes["#stage"].bottom - 1 && boxes["#keys"].height >= 70, `${name}: keys under the stage`);
}
