// SPDX-License-Identifier: MIT
// The material that the editor shows, and its file.

/** The text of the material file. */
export function materialText(m) {
  const contact = { stiffness_n_per_m_alpha: m.stiffness, exponent: m.exponent };
  if (m.loss > 0) contact.loss_s_per_m = m.loss;
  if (m.memory) contact.memory = m.memory;
  const spline = { knots: m.knots };
  if (m.knots === "optimal") spline.minimise = m.minimise;
  spline.segments = m.segments;
  const material = {
    name: m.name,
    contact,
    impact: { mass_kg: m.mass, max_speed_m_per_s: m.fastest, min_speed_m_per_s: m.slowest },
    spline,
  };
  return JSON.stringify(material, null, 2) + "\n";
}

/** The fields of a material file's text, or null if its contact is not one power law, which the editor cannot show. designed: its
 * segments, if it states a tolerance. */
export function materialFields(text, designed) {
  let material;
  try {
    material = JSON.parse(text.replace(/^\s*\/\/.*$/gm, ""));
  } catch {
    return null;
  }
  const { contact, impact, spline } = material ?? {};
  const needed = [
    contact?.stiffness_n_per_m_alpha, contact?.exponent, impact?.mass_kg, impact?.min_speed_m_per_s, impact?.max_speed_m_per_s,
    spline?.segments ?? designed,
  ];
  if (!needed.every(Number.isFinite) || material.live_exponent) return null;
  return {
    name: material.name,
    stiffness: contact.stiffness_n_per_m_alpha,
    exponent: contact.exponent,
    loss: contact.loss_s_per_m ?? 0,
    memory: contact.memory,
    mass: impact.mass_kg,
    slowest: impact.min_speed_m_per_s,
    fastest: impact.max_speed_m_per_s,
    segments: spline.segments ?? designed,
    knots: spline.knots,
    minimise: spline.minimise ?? "contact_duration",
  };
}

/** The file of a material of a measured curve: a CSV file of this name. */
export function measuredText(file) {
  const name = file.replace(/\.csv$/i, "").toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^[^a-z]+|_+$/g, "") || "measured";
  const material = {
    name,
    contact: { curve: { file, shape: "hardening" } },
    impact: { mass_kg: 0.00297, max_speed_m_per_s: 4.0, min_speed_m_per_s: 0.5 },
    spline: { knots: "uniform", segments: 48 },
  };
  return JSON.stringify(material, null, 2) + "\n";
}

/** The curves of law and spline of a design, with a point at each knot in view: compression [mm], law, spline, knots [N]. */
export function withKnots({ compression_m, law_n, spline_n }, table) {
  const millimetres = compression_m.map((y) => 1000 * y);
  const end = millimetres.at(-1);
  const knots = table.map(([knot, , force]) => [1000 * knot, null, null, force]).filter(([knot]) => knot <= end);
  const rows = [...millimetres.map((y, i) => [y, law_n[i], spline_n[i], null]), ...knots].sort(([a], [b]) => a - b);
  return [0, 1, 2, 3].map((k) => rows.map((row) => row[k]));
}
