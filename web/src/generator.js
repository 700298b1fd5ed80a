// SPDX-License-Identifier: MIT
// The generator of Contact Spline, in the page.
import { startModule, textAt, withTexts } from "./wasm_module.js";

/** The generator, from generator.wasm compiled or as bytes. */
export function startGenerator(module) {
  const exports = startModule(module);
  return {
    /** The text of every material that ships, by name. */
    materials: () => JSON.parse(textAt(exports, exports.contactspline_materials())),

    /** Takes a measured curve, a CSV file that materials may name. */
    takeCurve: (name, csv) => withTexts(exports, [name, csv], (...at) => exports.contactspline_take_curve(...at)),

    /** Designs a material: its emitted files by name, table, curve and errors (web/wasm/generator.cpp). Throws bad input. */
    design(text, file) {
      const address = withTexts(exports, [text, file], (...at) => exports.contactspline_generate(...at));
      const design = JSON.parse(textAt(exports, address));
      if (design.error) throw new Error(design.error);
      return design;
    },
  };
}
