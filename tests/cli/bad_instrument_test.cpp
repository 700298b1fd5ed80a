// SPDX-License-Identifier: MIT
// All the errors that an instrument file can have: one line that names file, key and what is allowed, and nothing
// written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "bad_input.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const std::string kGood = R"({
  "name": "probe",
  "description": "a probe",
  "bodies": [
    { "name": "string", "resonator": "string_c4", "tuning_cents": 3, "max_modes": 20 },
    {
      "name": "other",
      "string": { "length_m": 0.7, "mass_kg": 0.004, "tension_n": 600, "bending_stiffness_n_m2": 0.01,
                  "constant_loss_per_s": 0.5, "quadratic_loss_m2_per_s": 0.0001 }
    },
    { "name": "head", "resonator": "drum_head", "max_modes": 21 },
    { "name": "board", "modes": [ { "frequency_hz": 100, "decay_per_s": 20, "mass_kg": 4 },
                                  { "frequency_hz": 200, "decay_per_s": 25, "mass_kg": 5 } ] },
    { "name": "hammer", "mass_kg": 0.0031 },
    { "name": "bolt", "mass_kg": 0.002 },
    { "name": "lid", "max_modes": 30,
      "plate": { "length_m": 0.4, "width_m": 0.3, "thickness_m": 0.003, "density_kg_m3": 450,
                 "youngs_modulus_pa": 1e10, "poisson_ratio": 0.37, "constant_loss_per_s": 8,
                 "quadratic_loss_m2_per_s": 0.02 } }
  ],
  "places": [
    { "name": "struck", "body": "string", "position_m": 0.07 },
    { "name": "end", "body": "string", "position_m": 0.61 },
    { "name": "line", "body": "string", "positions_m": [0.1, 0.2, 0.3] },
    { "name": "opposite", "body": "other", "positions_m": [0.15, 0.25, 0.35] },
    { "name": "pair", "body": "other", "positions_m": [0.16, 0.26] },
    { "name": "spot", "body": "head", "position_m": 0.05, "angle_rad": 0.4 },
    { "name": "foot", "body": "board", "shapes": [1, -0.5] },
    { "name": "corner", "body": "lid", "position_m": 0.12, "across_m": 0.13 }
  ],
  "contacts": [
    { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4", "gap_m": 0.004, "weight": 1.25 },
    { "name": "rattle", "between": ["line", "opposite"], "material": "rubber_on_wood", "gaps_m": [1e-4, 2e-4, 3e-4],
      "weights": [0.3, 0.4, 0.6] }
  ],
  "springs": [
    { "name": "coil", "between": ["bolt", "ground"], "stiffness_n_per_m": 150, "resistance_n_s_per_m": 0.7,
      "gap_m": 0.001 }
  ],
  "links": [ { "name": "pin", "between": ["end", "foot"] } ],
  "controls": [
    { "name": "push", "force_n": "spot", "initial": 0.11, "min": -7, "max": 8, "release_n": 1.75 },
    { "name": "hand", "damping_per_s": ["string", "other"], "initial": 12 },
    { "name": "felt", "stiffness_ratio": "felt", "initial": 2.5 },
    { "name": "felt", "loss_s_per_m": "felt", "initial": 0.35 },
    { "name": "felt", "gap_shift_m": "felt", "initial": 0.0015 },
    { "name": "coil", "stiffness_n_per_m": "coil", "initial": 180 },
    { "name": "coil", "resistance_n_s_per_m": "coil", "initial": 0.8 }
  ],
  "strikes": ["hammer"],
  "outputs": [
    { "name": "string", "end_force_n": "string" },
    { "name": "spot", "displacement_m": "spot" },
    { "name": "foot", "velocity_m_per_s": ["foot", "spot"] },
    { "name": "felt", "force_n": ["felt", "rattle"] },
    { "name": "corner", "velocity_m_per_s": "corner", "full_scale": 0.06 },
    { "name": "ear", "pressure_pa": "lid", "distance_m": 0.81, "angle_rad": 0.3, "around_rad": 1.3, "side_m": 0.09 }
  ]
})";

std::string range(const std::string& min, const std::string& max) {
  return fmt::format("a number from {} to {}", min, max);
}

std::vector<BadFile> all_number_cases() {
  const std::vector<NumberKey> numbers = {
      {"bodies[0].", "tuning_cents", "3", range("-1200", "1200"), {"-1201", "1201"}},
      {"bodies[0].", "max_modes", "20", "an integer from 1 to 4096", {"0", "-1", "4097"}, true},
      {"bodies[1].string.", "length_m", "0.7", range("0.0001", "100"), {"0", "101"}},
      {"bodies[3].modes[1].", "frequency_hz", "200", range("0.1", "1000000"), {"0", "-1"}},
      {"bodies[3].modes[1].", "decay_per_s", "25", range("0", "1000000"), {"-1"}},
      {"bodies[4].", "mass_kg", "0.0031", range("1e-09", "10000"), {"0", "-1", "10001"}},
      {"places[0].", "position_m", "0.07", range("0", "0.62"), {"-0.1", "0.63"}},
      {"places[5].", "position_m", "0.05", range("-0.165", "0.165"), {"-0.17", "0.17"}},
      {"places[5].", "angle_rad", "0.4", range("-7", "7"), {"-8", "8"}},
      {"places[7].", "position_m", "0.12", range("0", "0.4"), {"-0.1", "0.41"}},
      {"places[7].", "across_m", "0.13", range("0", "0.3"), {"-0.1", "0.31"}},
      {"contacts[0].", "gap_m", "0.004", range("-0.1", "0.1"), {"-0.11", "0.11"}},
      {"contacts[0].", "weight", "1.25", range("1e-09", "1000000000"), {"0", "-1"}},
      {"springs[0].", "stiffness_n_per_m", "150", range("0", "1000000000"), {"-1", "1e10"}},
      {"springs[0].", "resistance_n_s_per_m", "0.7", range("0", "1000000"), {"-1", "1e7"}},
      {"controls[0].", "initial", "0.11", range("-7", "8"), {"-7.1", "8.1"}},
      {"controls[0].", "min", "-7", range("-1000", "1000"), {"-1001", "1001"}},
      {"controls[0].", "max", "8", range("-1000", "1000"), {"-1001", "1001"}},
      {"controls[0].", "release_n", "1.75", range("-7", "8"), {"-7.1", "8.1"}},
      {"outputs[4].", "full_scale", "0.06", range("1e-09", "1000000000"), {"0", "-1", "1e10"}},
      {"controls[1].", "initial", "12", range("0", "100000"), {"-1", "1e6"}},
      {"controls[2].", "initial", "2.5", range("1e-06", "1000000"), {"0", "-1", "1e7"}},
      {"controls[3].", "initial", "0.35", range("0", "1000"), {"-1", "1001"}},
      {"controls[4].", "initial", "0.0015", range("-0.1", "0.1"), {"-0.2", "0.2"}},
      {"controls[5].", "initial", "180", range("0", "1000000000"), {"-1", "1e10"}},
      {"controls[6].", "initial", "0.8", range("0", "1000000"), {"-1", "1e7"}}};
  std::vector<BadFile> cases;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    std::ranges::move(number_cases(fmt::format("number_{}", i), kGood, numbers[i]), std::back_inserter(cases));
  return cases;
}

std::vector<BadFile> body_cases() {
  return {
      {"name_missing", changed(kGood, R"("name": "probe",)", ""), "name", "missing; allowed: a-z"},
      {"name_of_a_member", changed(kGood, R"("probe")", R"("tick")"), "name", "'tick' is not a usable identifier"},
      {"name_of_a_setter", changed(kGood, R"("probe")", R"("set_a")"), "name", "begins with set_"},
      {"description_of_two_lines", changed(kGood, "a probe", "a\\nprobe"), "description", "allowed: one line"},
      {"unknown_key", changed(kGood, R"("bodies")", R"("tempo": 3, "bodies")"), "tempo",
       "unknown key; allowed: name, description, license, bodies, places, contacts, springs, links, controls, "
       "strikes, "
       "outputs, keys, polyphony, damper, presets"},
      {"outputs_missing", kGood.substr(0, kGood.find(",\n  \"outputs\"")) + "}", "outputs",
       "missing; allowed: an array of 1 to 64 objects"},
      {"bodies_missing", R"({ "name": "probe", "outputs": [ { "name": "a", "force_n": "b" } ] })", "bodies",
       "missing; allowed: an array of 1 to 64 objects"},
      {"bodies_empty", R"({ "name": "probe", "bodies": [], "outputs": [] })", "bodies", "has 0 entries"},
      {"contacts_empty",
       R"({ "name": "probe", "bodies": [ { "name": "a", "mass_kg": 1 } ], "contacts": [],
            "outputs": [ { "name": "a", "displacement_m": "a" } ] })",
       "contacts", "has 0 entries; allowed: an array of 1 to 256 objects"},
      {"body_unknown_key", changed(kGood, R"("mass_kg": 0.0031)", R"("mass": 0.0031)"), "bodies[4].mass",
       "unknown key; allowed: name, resonator, string, bar, membrane, plate, modes, mass_kg, tuning_cents, "
       "max_modes"},
      {"body_without_name", changed(kGood, R"("name": "bolt", )", ""), "bodies[5].name", "missing; allowed: a-z"},
      {"body_twice", changed(kGood, R"("name": "bolt")", R"("name": "hammer")"), "bodies[5].name",
       "'hammer' is the name of two objects; allowed: once"},
      {"body_called_ground", changed(kGood, R"("name": "bolt")", R"("name": "ground")"), "bodies[5].name",
       "'ground' is not a usable identifier"},
      {"body_upper_case", changed(kGood, R"("name": "bolt")", R"("name": "Bolt")"), "bodies[5].name",
       "'Bolt' is not a usable identifier"},
      {"body_with_underscore", changed(kGood, R"("name": "bolt")", R"("name": "bolt_")"), "bodies[5].name",
       "'bolt_' is not a usable identifier"},
      {"body_of_nothing", changed(kGood, R"(, "mass_kg": 0.002)", ""), "bodies[5].resonator",
       "0 kinds of body are given; allowed: just one of resonator, string, bar, membrane, plate, modes, mass_kg"},
      {"body_of_two_kinds", changed(kGood, R"("mass_kg": 0.002)", R"("mass_kg": 0.002, "resonator": "drum_head")"),
       "bodies[5].mass_kg", "2 kinds of body are given"},
      {"resonator_unknown", changed(kGood, R"("string_c4")", R"("string_c9")"), "bodies[0].resonator",
       "'string_c9' does not ship; allowed: a .json file, string_c2"},
      {"resonator_is_a_material", changed(kGood, R"("string_c4")", R"("felt_c4")"), "bodies[0].resonator",
       "'felt_c4' is a material"},
      {"resonator_file_missing", changed(kGood, R"("string_c4")", R"("x.json")"), "bodies[0].resonator",
       "x.json: file: does not exist"},
      {"resonator_of_many_strings", changed(kGood, R"("string_c4")", R"("dulcimer_g4")"), "bodies[0].resonator",
       "has several strings; allowed: one body each"},
      {"tuned_mass", changed(kGood, R"("mass_kg": 0.002)", R"("mass_kg": 0.002, "tuning_cents": 1)"),
       "bodies[5].tuning_cents", "is not for this body; allowed: beside strings"},
      {"modes_of_a_mass", changed(kGood, R"("mass_kg": 0.002)", R"("mass_kg": 0.002, "max_modes": 1)"),
       "bodies[5].max_modes", "is not for a mass"},
      {"string_key_unknown", changed(kGood, R"("length_m": 0.7)", R"("length_m": 0.7, "pitch_hz": 3)"),
       "bodies[1].string.pitch_hz", "unknown key"},
      {"mode_with_shapes", changed(kGood, R"("frequency_hz": 100)", R"("frequency_hz": 100, "strike_shape": 1)"),
       "bodies[3].modes[0].strike_shape", "unknown key; allowed: frequency_hz, decay_per_s, mass_kg"},
      {"body_is_a_number", changed(kGood, R"("bodies": [)", R"("bodies": [ 1,)"), "bodies[0]", "is not an object"}};
}

std::vector<BadFile> place_cases() {
  return {
      {"place_on_no_body", changed(kGood, R"("body": "board")", R"("body": "table")"), "places[6].body",
       "'table' is no body; allowed: string, other, head, board, hammer, bolt, lid"},
      {"place_on_a_mass", changed(kGood, R"("body": "board")", R"("body": "bolt")"), "places[6].body",
       "'bolt' is a mass; allowed: a resonator; a mass is itself a place"},
      {"place_without_body", changed(kGood, R"("body": "board", )", ""), "places[6].body",
       "missing; allowed: string"},
      {"place_like_a_body", changed(kGood, R"("name": "foot", "body")", R"("name": "bolt", "body")"),
       "places[6].name", "'bolt' is the name of two objects"},
      {"place_nowhere", changed(kGood, R"(, "position_m": 0.07)", ""), "places[0].position_m",
       "0 kinds of position are given; allowed: just one of position_m, positions_m"},
      {"place_twice", changed(kGood, R"("position_m": 0.07)", R"("position_m": 0.07, "positions_m": [0.1])"),
       "places[0].positions_m", "2 kinds of position are given"},
      {"points_beyond_the_string", changed(kGood, "[0.1, 0.2, 0.3]", "[0.1, 0.2, 0.9]"), "places[2].positions_m[2]",
       "0.9 is out of range; allowed: a number from 0 to 0.62"},
      {"points_empty", changed(kGood, "[0.1, 0.2, 0.3]", "[]"), "places[2].positions_m", "has 0 entries"},
      {"angle_on_a_string", changed(kGood, R"("position_m": 0.07)", R"("position_m": 0.07, "angle_rad": 1)"),
       "places[0].angle_rad", "is not for this body; allowed: on a membrane"},
      {"across_missing_on_a_plate", changed(kGood, R"(, "across_m": 0.13)", ""), "places[7].across_m",
       "missing; allowed: a number from 0 to 0.3"},
      {"across_on_a_string", changed(kGood, R"("position_m": 0.07)", R"("position_m": 0.07, "across_m": 0.1)"),
       "places[0].across_m", "is not for this body; allowed: on a plate"},
      {"mean_on_a_string", changed(kGood, R"("position_m": 0.07)", R"("mean_radius_m": 0.07)"),
       "places[0].mean_radius_m", "is not for this body; allowed: on a membrane"},
      {"mean_and_angle", changed(kGood, R"("position_m": 0.05)", R"("mean_radius_m": 0.05)"), "places[5].angle_rad",
       "stands beside mean_radius_m; allowed: one of the two"},
      {"mean_beyond_the_rim", changed(kGood, R"("position_m": 0.05, "angle_rad": 0.4)", R"("mean_radius_m": 0.17)"),
       "places[5].mean_radius_m", "0.17 is out of range; allowed: a number from 1e-06 to 0.165"},
      {"mean_on_a_table", changed(kGood, R"("shapes": [1, -0.5])", R"("mean_radius_m": 0.1)"),
       "places[6].mean_radius_m", "has no meaning on a table of modes; allowed: shapes"},
      {"across_on_a_membrane", changed(kGood, R"("angle_rad": 0.4)", R"("across_m": 0.1)"), "places[5].across_m",
       "is not for this body; allowed: on a plate"},
      {"across_on_modes", changed(kGood, R"("shapes": [1, -0.5])", R"("shapes": [1, -0.5], "across_m": 0.1)"),
       "places[6].across_m", "has no meaning on a table of modes; allowed: shapes"},
      {"angle_on_a_plate", changed(kGood, R"("across_m": 0.13)", R"("across_m": 0.13, "angle_rad": 1)"),
       "places[7].angle_rad", "is not for this body; allowed: on a membrane"},
      {"shapes_on_a_string", changed(kGood, R"("position_m": 0.07)", R"("shapes": [1])"), "places[0].shapes",
       "is not for this body; allowed: position_m or positions_m"},
      {"position_on_modes", changed(kGood, R"("shapes": [1, -0.5])", R"("position_m": 0.1)"), "places[6].position_m",
       "has no meaning on a table of modes; allowed: shapes"},
      {"shapes_missing", changed(kGood, R"(, "shapes": [1, -0.5])", ""), "places[6].shapes", "missing"},
      {"shapes_too_few", changed(kGood, "[1, -0.5]", "[1]"), "places[6].shapes",
       "has 1 entries; allowed: one for each of the 2 modes"},
      {"shapes_out_of_range", changed(kGood, "[1, -0.5]", "[1, 1e7]"), "places[6].shapes[1]", "is out of range"}};
}

std::vector<BadFile> connection_cases() {
  const std::string felt = R"("between": ["hammer", "struck"])";
  const auto between = [&](const std::string& with) { return changed(kGood, felt, R"("between": )" + with); };
  return {{"contact_of_nothing", changed(kGood, felt + ", ", ""), "contacts[0].between",
           "missing; allowed: an array of two places, one of which may be ground"},
          {"contact_of_one", between(R"(["hammer"])"), "contacts[0].between", "names one place"},
          {"contact_of_text", between(R"("hammer")"), "contacts[0].between", "names one place"},
          {"contact_of_three", between(R"(["hammer", "struck", "end"])"), "contacts[0].between", "has 3 entries"},
          {"contact_of_numbers", between("[1, 2]"), "contacts[0].between[0]", "is not a string"},
          {"contact_with_no_place", between(R"(["hammer", "nail"])"), "contacts[0].between",
           "'nail' is no place; allowed: hammer, bolt, struck, end, line"},
          {"contact_with_a_body", between(R"(["hammer", "string"])"), "contacts[0].between", "'string' is no place"},
          {"contact_of_the_ground", between(R"(["ground", "ground"])"), "contacts[0].between",
           "joins the ground with itself; allowed: a place of a body"},
          {"contact_with_itself", between(R"(["struck", "end"])"), "contacts[0].between",
           "joins body 'string' with itself; allowed: places of two bodies"},
          {"contact_of_unequal_lists", changed(kGood, R"(["line", "opposite"])", R"(["line", "pair"])"),
           "contacts[1].between", "joins lists of different length"},
          {"contact_like_a_place", changed(kGood, R"("name": "rattle")", R"("name": "spot")"), "contacts[1].name",
           "'spot' is the name of two objects"},
          {"material_missing", changed(kGood, R"("material": "felt_c4", )", ""), "contacts[0].material",
           "missing; allowed: a .json file, felt_c2"},
          {"material_unknown", changed(kGood, R"("felt_c4")", R"("felt")"), "contacts[0].material",
           "'felt' does not ship; allowed: a .json file, felt_c2"},
          {"material_is_a_resonator", changed(kGood, R"("felt_c4")", R"("string_c4")").replace(0, 0, ""),
           "contacts[0].material", "'string_c4' is a resonator"},
          {"gaps_too_few", changed(kGood, "[1e-4, 2e-4, 3e-4]", "[1e-4, 2e-4]"), "contacts[1].gaps_m",
           "has 2 entries; allowed: one for each of the 3 connections"},
          {"gaps_beside_gap", changed(kGood, R"("gaps_m": [1e)", R"("gap_m": 0, "gaps_m": [1e)"),
           "contacts[1].gaps_m", "stands beside gap_m; allowed: one of the two"},
          {"weights_too_many", changed(kGood, "[0.3, 0.4, 0.6]", "[0.3, 0.4, 0.6, 1]"), "contacts[1].weights",
           "has 4 entries; allowed: one for each of the 3 connections"},
          {"weight_zero", changed(kGood, "[0.3, 0.4, 0.6]", "[0.3, 0, 0.6]"), "contacts[1].weights[1]",
           "0 is out of range"},
          {"contact_too_stiff",
           changed(changed(kGood, R"("felt_c4")", R"("steel_on_steel")"), R"("weight": 1.25)", R"("weight": 1e9)"),
           "contacts[0].weight", "contact 'felt' with 7.52e+16 N/m oscillates on the"},
          {"contact_too_stiff_by_its_control", changed(kGood, R"("mass_kg": 0.0031)", R"("mass_kg": 1e-9)"),
           "controls[2].max", "allowed: at most 1e+09 Hz: larger masses, or a max of at most 8.3e+04"},
          {"contact_with_stiffness", changed(kGood, R"("weight": 1.25)", R"("stiffness_n_per_m": 1)"),
           "contacts[0].stiffness_n_per_m", "unknown key; allowed: name, between, material, gap_m"},
          {"spring_of_nothing",
           changed(changed(kGood, R"("stiffness_n_per_m": 150, )", ""), R"("resistance_n_s_per_m": 0.7,)", ""),
           "springs[0].stiffness_n_per_m", "missing; allowed: stiffness_n_per_m, resistance_n_s_per_m, or both"},
          {"spring_with_material", changed(kGood, R"("stiffness_n_per_m": 150)", R"("material": "felt_c4")"),
           "springs[0].material", "unknown key"},
          {"circle_of_links",
           changed(kGood, R"("between": ["end", "foot"] })",
                   R"("between": ["end", "foot"] }, { "name": "a", "between": ["foot", "ground"] },
                  { "name": "b", "between": ["ground", "end"] })"),
           "links[2].between", "closes a circle of rigid links; allowed: links that hold each place once"},
          {"link_twice",
           changed(kGood, R"("between": ["end", "foot"] })",
                   R"("between": ["end", "foot"] }, { "name": "a", "between": ["foot", "end"] })"),
           "links[1].between", "closes a circle of rigid links"}};
}

// Controls that move a place, and set a mass from note to note.
std::vector<BadFile> note_cases() {
  const std::string last = R"("resistance_n_s_per_m": "coil", "initial": 0.8 })";
  const std::string moving = changed(kGood, last, last + R"(,
    { "name": "hammer", "mass_kg": "hammer", "initial": 0.0032, "min": 0.001 },
    { "name": "struck", "place_m": "struck", "initial": 0.083, "acts": "at_next_note" })");
  return {
      {"place_of_a_head", changed(moving, R"("place_m": "struck")", R"("place_m": "spot")"), "controls[8].place_m",
       "'spot' is not on a string; allowed: a place on a string"},
      {"place_of_several_points", changed(moving, R"("place_m": "struck")", R"("place_m": "line")"),
       "controls[8].place_m", "'line' has several points; allowed: a place of one point"},
      {"place_that_a_link_holds", changed(moving, R"("place_m": "struck")", R"("place_m": "end")"),
       "controls[8].place_m", "the rigid link 'pin' holds 'end' where it is"},
      {"place_that_an_output_reads", changed(moving, R"("displacement_m": "spot")", R"("displacement_m": "struck")"),
       "outputs[1].displacement_m", "a control moves 'struck'; allowed: a place of its own that stays"},
      {"mass_that_nothing_strikes", changed(moving, R"("mass_kg": "hammer")", R"("mass_kg": "bolt")"),
       "controls[7].mass_kg", "'bolt' is not struck; allowed: a mass that `strikes` names"},
      {"mass_too_light_for_its_contact", changed(moving, R"("min": 0.001)", R"("min": 1e-9)"), "controls[7].min",
       "allowed: at most 1e+09 Hz: larger masses, or a weight of at most 0.1"},
      {"acts_some_day", changed(moving, R"("at_next_note")", R"("later")"), "controls[8].acts",
       "'later' is neither; allowed: at_once or at_next_note"},
      {"mass_at_once", changed(moving, R"("initial": 0.0032)", R"("initial": 0.0032, "acts": "at_once")"),
       "controls[7].acts", "is at_once beside a mass; allowed: at_next_note"},
      {"place_beyond_the_string", changed(moving, "0.083", "0.63"), "controls[8].initial",
       "is out of range; allowed: " + range("0", "0.62")},
      {"mass_beyond_its_range", changed(moving, "0.0032", "1e5"), "controls[7].initial",
       "is out of range; allowed: " + range("0.001", "10000")}};
}

std::vector<BadFile> outside_cases() {
  const std::string push = R"("force_n": "spot", "initial": 0.11)";
  return {
      {"range_upside_down", changed(kGood, R"("max": 8)", R"("max": -8)"), "controls[0].max",
       "leaves no range; allowed: min below max"},
      {"range_of_one_value", changed(kGood, R"("min": -7, "max": 8)", R"("min": 1000)"), "controls[0].min",
       "leaves no range; allowed: min below max"},
      {"first_value_outside_the_range", changed(kGood, R"("initial": 0.11, "min": -7)", R"("min": 1)"),
       "controls[0].initial", "missing, and the file begins with 0; allowed: 1 to 8"},
      {"pluck_without_force", changed(kGood, "1.75", "0"), "controls[0].release_n",
       "plucks without force; allowed: not 0"},
      {"pluck_of_a_damping", changed(kGood, R"("initial": 12)", R"("initial": 12, "release_n": 1)"),
       "controls[1].release_n", "is not for this control; allowed: beside force_n"},
      {"control_of_nothing", changed(kGood, push, R"("initial": 0.11)"), "controls[0].force_n",
       "0 quantities are given; allowed: just one of force_n, damping_per_s, stiffness_ratio, loss_s_per_m"},
      {"control_of_two", changed(kGood, push, push + R"(, "damping_per_s": "head")"), "controls[0].damping_per_s",
       "2 quantities are given"},
      {"control_unknown_quantity", changed(kGood, push, R"("pressure_pa": "spot")"), "controls[0].pressure_pa",
       "unknown key; allowed: name, initial, min, max, release_n, acts, force_n"},
      {"control_without_name", changed(kGood, R"("name": "push", )", ""), "controls[0].name", "missing"},
      {"control_twice",
       changed(kGood, R"("name": "push", "force_n": "spot", "initial": 0.11, "min": -7, "max": 8, "release_n": 1.75)",
               R"("name": "felt", "loss_s_per_m": "rattle")"),
       "controls[3].name", "'felt_loss_s_per_m' stands for two things; allowed: another name"},
      {"target_twice", changed(kGood, R"(["string", "other"])", R"(["string", "string"])"),
       "controls[1].damping_per_s", "'string' already has such a control; allowed: one control for each"},
      {"force_on_no_place", changed(kGood, push, R"("force_n": "head")"), "controls[0].force_n",
       "'head' is no place; allowed: hammer, bolt, struck"},
      {"force_on_several", changed(kGood, push, R"("force_n": "line")"), "controls[0].force_n",
       "'line' has several points; allowed: a place of one point"},
      {"damping_of_a_place", changed(kGood, R"(["string", "other"])", R"(["string", "spot"])"),
       "controls[1].damping_per_s", "'spot' is no body"},
      {"ratio_of_a_spring", changed(kGood, R"("stiffness_ratio": "felt")", R"("stiffness_ratio": "coil")"),
       "controls[2].stiffness_ratio", "'coil' is a spring; allowed: a contact"},
      {"loss_of_a_link", changed(kGood, R"("loss_s_per_m": "felt")", R"("loss_s_per_m": "pin")"),
       "controls[3].loss_s_per_m", "'pin' is a link; allowed: a contact"},
      {"stiffness_of_a_contact", changed(kGood, R"("stiffness_n_per_m": "coil")", R"("stiffness_n_per_m": "felt")"),
       "controls[5].stiffness_n_per_m", "'felt' is a contact; allowed: a spring"},
      {"gap_of_a_place", changed(kGood, R"("gap_shift_m": "felt")", R"("gap_shift_m": "spot")"),
       "controls[4].gap_shift_m", "'spot' is no contact, spring or link; allowed: felt, rattle, coil, pin"},
      {"gap_shifted_too_far", changed(kGood, R"("initial": 0.0015)", R"("initial": 0.097)"), "controls[4].initial",
       "0.097 m added to the gap 0.004 m of 'felt' is out of range; allowed: a sum from -0.1 to 0.1 m"},
      {"one_gap_of_many_shifted_too_far",
       changed(kGood, R"("gap_shift_m": "felt", "initial": 0.0015)",
               R"("gap_shift_m": "rattle", "initial": 0.09975)"),
       "controls[4].initial", "0.09975 m added to the gap 0.0003 m of 'rattle' is out of range"},
      {"gap_shifted_too_far_back",
       changed(changed(kGood, R"("gap_m": 0.004)", R"("gap_m": -0.004)"), R"("initial": 0.0015)",
               R"("initial": -0.097)"),
       "controls[4].initial", "-0.097 m added to the gap -0.004 m of 'felt' is out of range"},
      {"force_at_next_note", changed(kGood, push, push + R"(, "acts": "at_next_note")"), "controls[0].acts",
       "is at_next_note beside a force; allowed: at_once, or release_n for a pluck"},
      {"control_of_a_number", changed(kGood, push, R"("force_n": 3)"), "controls[0].force_n", "is not an array"},
      {"strike_of_a_string", changed(kGood, R"(["hammer"])", R"(["string"])"), "strikes",
       "'string' is not a mass; allowed: masses"},
      {"strike_of_nothing", changed(kGood, R"(["hammer"])", R"(["axe"])"), "strikes", "'axe' is no body"},
      {"strike_twice", changed(kGood, R"(["hammer"])", R"(["hammer", "hammer"])"), "strikes",
       "'hammer_speed_m_per_s' stands for two things"},
      {"output_of_nothing", changed(kGood, R"(, "displacement_m": "spot")", ""), "outputs[1].displacement_m",
       "0 quantities are given; allowed: just one of displacement_m, velocity_m_per_s, force_n, end_force_n, "
       "pressure_pa"},
      {"output_of_a_line", changed(kGood, R"("displacement_m": "spot")", R"("displacement_m": "line")"),
       "outputs[1].displacement_m", "'line' has several points"},
      {"output_unknown", changed(kGood, R"(["felt", "rattle"])", R"(["felt", "spot"])"), "outputs[3].force_n",
       "'spot' is no contact, spring or link"},
      {"end_of_a_membrane", changed(kGood, R"("end_force_n": "string")", R"("end_force_n": "head")"),
       "outputs[0].end_force_n", "'head' is not a string; allowed: a string"},
      {"pressure_of_a_string", changed(kGood, R"("pressure_pa": "lid")", R"("pressure_pa": "string")"),
       "outputs[5].pressure_pa",
       "names a body of the kind 'string'; allowed: a plate or a membrane, whose shapes are known everywhere"},
      {"pressure_of_a_mass", changed(kGood, R"("pressure_pa": "lid")", R"("pressure_pa": "bolt")"),
       "outputs[5].pressure_pa", "names a body of the kind 'modes'"},
      {"pressure_of_a_place", changed(kGood, R"("pressure_pa": "lid")", R"("pressure_pa": "corner")"),
       "outputs[5].pressure_pa", "'corner' is no body; allowed: string, other, head, board, hammer, bolt, lid"},
      {"pressure_without_distance", changed(kGood, R"("distance_m": 0.81, )", ""), "outputs[5].distance_m",
       "missing; allowed: " + range("0.05", "20")},
      {"pressure_behind_the_wall", changed(kGood, R"("angle_rad": 0.3)", R"("angle_rad": 1.6)"),
       "outputs[5].angle_rad", "1.6 is out of range; allowed: " + range("-1.5", "1.5")},
      {"pressure_near_the_wall",
       changed(kGood, R"("distance_m": 0.81, "angle_rad": 0.3)", R"("distance_m": 0.3, "angle_rad": 1.5)"),
       "outputs[5].angle_rad", "m before the plane of the body; allowed: at least 0.05 m"},
      {"pressure_far_aside", changed(kGood, R"("side_m": 0.09)", R"("side_m": 6)"), "outputs[5].side_m",
       "6 is out of range; allowed: " + range("-5", "5")},
      {"pressure_of_a_large_plate",
       changed(changed(kGood, R"("plate": { "length_m": 0.4)", R"("plate": { "length_m": 2.9)"),
               R"("angle_rad": 0.3, "around_rad": 1.3)", R"("angle_rad": 1.3)"),
       "outputs[5].distance_m",
       "m farther from one point of the body than from another; allowed: at most 2 m: a smaller body"},
      {"pressure_far_from_another",
       changed(kGood, R"("outputs": [)",
               R"("outputs": [ { "name": "far", "pressure_pa": "lid", "distance_m": 4.9 },)"),
       "outputs[6].distance_m", "m away from points of their bodies; allowed: distances that differ by at most 4 m"},
      {"pressure_of_too_many_modes",
       changed(changed(kGood, R"("name": "lid", "max_modes": 30)", R"("name": "lid")"), R"("thickness_m": 0.003)",
               R"("thickness_m": 0.0001)"),
       "outputs[5].pressure_pa", "modes below 24000 Hz; allowed: at most 512, by max_modes"},
      {"pressure_of_a_huge_plate", changed(kGood, R"("plate": { "length_m": 0.4)", R"("plate": { "length_m": 3.1)"),
       "outputs[5].pressure_pa", "names a body of 3.1 m; allowed: at most 3 m"},
      {"distance_of_a_pickup", changed(kGood, R"("full_scale": 0.06)", R"("full_scale": 0.06, "distance_m": 1)"),
       "outputs[4].distance_m", "stands beside velocity_m_per_s; allowed: beside pressure_pa"},
      {"output_like_a_control",
       changed(kGood, R"("name": "felt", "force_n": ["felt", "rattle"])", R"("name": "push", "force_n": "felt")"),
       "outputs[3].name", "'push_force_n' stands for two things"},
      {"empty", "", "line 1, column 1", "the file ends; allowed: a value"},
      {"truncated", kGood.substr(0, kGood.size() / 2), "line ", "; allowed: "},
      {"large", kGood + std::string(1 << 20, ' '), "file", "is larger than 1 MiB"}};
}

Outcome generate(const Sandbox& box, const Words& options = {}) {
  return run({.arguments = followed_by({"generate", "probe.json", "-o", "out"}, options), .folder = box.path()});
}

class BadInstrumentFile : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadInstrumentFile, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, text, key, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.json", text);
  const auto before = box.listing();
  expect_refused(generate(box), "probe.json: " + key, says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

CONTACTSPLINE_CASES(Number, BadInstrumentFile, all_number_cases());
CONTACTSPLINE_CASES(Body, BadInstrumentFile, body_cases());
CONTACTSPLINE_CASES(Place, BadInstrumentFile, place_cases());
CONTACTSPLINE_CASES(Connection, BadInstrumentFile, connection_cases());
CONTACTSPLINE_CASES(Note, BadInstrumentFile, note_cases());
CONTACTSPLINE_CASES(Outside, BadInstrumentFile, outside_cases());

// What the tables above are made of is good itself.
TEST(GoodInstrumentFile, IsAccepted) {
  const Sandbox box;
  write_file(box / "probe.json", kGood);
  const Outcome outcome = generate(box);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "wrote out/probe.lib\nwrote out/probe.hpp\nwrote out/probe.json\n");
}

// A Faust program of many contacts would take too long to compile.
TEST(BadInstrument, OfManyContactsHasNoFaustText) {
  const Sandbox box;
  std::string many = kGood;
  for (const auto& [three, six] : {std::pair("[0.1, 0.2, 0.3]", "[0.1, 0.15, 0.2, 0.25, 0.3, 0.35]"),
                                   {"[0.15, 0.25, 0.35]", "[0.1, 0.15, 0.2, 0.25, 0.3, 0.35]"},
                                   {"[1e-4, 2e-4, 3e-4]", "[1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4]"},
                                   {"[0.3, 0.4, 0.6]", "[1, 1, 1, 1, 1, 1]"}})
    many = changed(many, three, six);
  write_file(box / "probe.json", many);
  const std::string why = "probe has 7 points of contact, and Faust compiles at most 6 in reasonable time";
  expect_refused(generate(box, {"--emit", "faust"}), "probe.json: --emit: " + why, "allowed: cpp, whose class");
  const Outcome outcome = generate(box);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "wrote out/probe.hpp\nwrote out/probe.json\nleft out probe.lib: " + why + "\n");
}

// The good file with so many modes of its board.
std::string with_board_modes(std::size_t count) {
  std::string modes, shapes;
  for (std::size_t i = 0; i < count; ++i) {
    modes +=
        fmt::format(R"({}{{ "frequency_hz": {}, "decay_per_s": 20, "mass_kg": 4 }})", i > 0 ? ", " : "", 100 + i);
    shapes += i > 0 ? ", 1" : "1";
  }
  const std::size_t begin = kGood.find(R"({ "frequency_hz": 100)"), end = kGood.find(" ] },", begin);
  return changed(changed(kGood, kGood.substr(begin, end - begin), modes), "[1, -0.5]", "[" + shapes + "]");
}

TEST(BadInstrument, Of401ModesHasNoFaustText) {
  const Sandbox box;
  const auto generated = [&](std::size_t board_modes) {
    write_file(box / "probe.json", with_board_modes(board_modes));
    const Outcome outcome = generate(box);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  const auto left_out = [](std::size_t modes) {
    return fmt::format("left out probe.lib: probe has {} modes, and Faust compiles at most 400 in reasonable time\n",
                       modes);
  };
  constexpr std::size_t modes = 500;  // modes of the board; the other bodies get what is left
  const std::string message = generated(modes);
  std::size_t others = 0;
  while (others < 400 && message.find(left_out(modes + others)) == std::string::npos) ++others;
  ASSERT_LT(others, 400U) << message;
  EXPECT_NE(generated(401 - others).find(left_out(401)), std::string::npos);
  EXPECT_NE(generated(400 - others).find("wrote out/probe.lib\n"), std::string::npos);
}

TEST(BadInstrument, HasNoModeAtALowRate) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kGood, R"("frequency_hz": 100)", R"("frequency_hz": 21000)"));
  EXPECT_EQ(generate(box).exit_code, 0);
  write_file(box / "probe.json", changed(changed(kGood, R"("frequency_hz": 100)", R"("frequency_hz": 21000)"),
                                         R"("frequency_hz": 200)", R"("frequency_hz": 21500)"));
  expect_refused(generate(box, {"--rate", "40000"}), "probe.json: bodies: body 'board' has no mode below 20000 Hz",
                 "allowed: a higher --rate, a lower frequency, or losses below the frequencies");
}

const std::string kScore = R"({
  "instrument": "probe.json",
  "duration_s": 0.05,
  "voices": [ { "name": "a", "tuning_cents": 4, "pan": 0.2 } ],
  "events": [
    { "time_s": 0.01, "voice": "a", "hammer_speed_m_per_s": 2.5 },
    { "time_s": 0.02, "over_s": 0.005, "push_release_n": 0.6 },
    { "time_s": 0.03, "hand_damping_per_s": 7 }
  ]
})";

std::vector<BadFile> score_cases() {
  std::vector<BadFile> cases = {
      {"instrument_unknown", changed(kScore, R"("probe.json")", R"("sitar")"), "instrument",
       "'sitar' is unknown; allowed: hammer-string, slide-string, fret-string, a .json file, classical_guitar"},
      {"instrument_is_a_score", changed(kScore, R"("probe.json")", R"("score.json")"), "instrument",
       "'score.json' is a score"},
      {"keyboard", changed(kScore, R"("voices")", R"("keyboard": "piano", "voices")"), "keyboard",
       "has no place here"},
      {"voice_with_material", changed(kScore, R"("pan": 0.2)", R"("material": "mb1")"), "voices[0].material",
       "unknown key; allowed: name, tuning_cents, pan"},
      {"voice_unknown", changed(kScore, R"("voice": "a")", R"("voice": "b")"), "events[0].voice",
       "'b' is no voice; allowed: a"},
      {"control_unknown", changed(kScore, "hand_damping_per_s", "hand_force_n"), "events[2].hand_force_n",
       "unknown key; allowed: time_s, voice, over_s, push_force_n, push_release_n, hand_damping_per_s"},
      {"control_out_of_range", changed(kScore, R"("hand_damping_per_s": 7)", R"("hand_damping_per_s": -1)"),
       "events[2].hand_damping_per_s", "-1 is out of range; allowed: a number from 0 to 100000"},
      {"speed_out_of_range", changed(kScore, "2.5", "101"), "events[0].hammer_speed_m_per_s", "101 is out of range"},
      {"pluck_and_force", changed(kScore, R"("push_release_n": 0.6)", R"("push_release_n": 0.6, "push_force_n": 1)"),
       "events[1].push_release_n", "stands beside push_force_n; allowed: one of the two"},
      {"glide_to_nothing", changed(kScore, R"("voice": "a")", R"("over_s": 0.1)"), "events[0].over_s",
       "glides to nothing; allowed: beside a control"},
      {"nothing_happens", changed(kScore, R"(, "hand_damping_per_s": 7)", ""), "events[2].time_s", "nothing happens"},
      {"too_late", changed(kScore, R"("time_s": 0.03)", R"("time_s": 0.06)"), "events[2].time_s", "is out of range"}};
  return cases;
}

class BadInstrumentScore : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadInstrumentScore, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, text, key, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.json", kGood);
  write_file(box / "score.json", text);
  const auto before = box.listing();
  expect_refused(
      run({.arguments = {"render", "instrument", "--score", "score.json", "-o", "a.wav"}, .folder = box.path()}),
      "score.json: " + key, says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

CONTACTSPLINE_CASES(All, BadInstrumentScore, score_cases());

TEST(GoodInstrumentScore, IsPlayedFromAnyFolderWithEachOutput) {
  const Sandbox box;
  fs::create_directory(box / "music");
  write_file(box / "music/probe.json", kGood);
  write_file(box / "music/score.json", kScore);
  const auto render = [&](const Words& options) {
    return run({.arguments = followed_by(
                    {"render", "instrument", "--score", "music/score.json", "-o", "a.wav", "--no-figure"}, options),
                .folder = box.path()});
  };
  for (const auto& [output, unit] : {std::pair("string_end_force_n", "N (string end force)"),
                                     {"spot_displacement_m", "m (spot displacement)"},
                                     {"foot_velocity_m_per_s", "m/s (foot velocity)"},
                                     {"corner_velocity_m_per_s", "m/s (corner velocity)"},
                                     {"ear", "Pa (ear pressure)"},
                                     {"spot", "m (spot displacement)"},
                                     {"force", "N (felt force)"}}) {  // not that of the string's end
    const Outcome outcome = render({"--signal", output});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(unit), std::string::npos) << outcome.out;
  }
  write_file(box / "music/probe.json", changed(kGood, R"("name": "string", "end)", R"("name": "force_at", "end)"));
  EXPECT_NE(render({"--signal", "force"}).out.find("N (felt force)"), std::string::npos);
  write_file(box / "music/probe.json", kGood);
  expect_refused(render({"--signal", "velocity"}), "--signal: 'velocity' is no output",
                 "allowed: string_end_force_n, spot_displacement_m, foot_velocity_m_per_s, felt_force_n, "
                 "corner_velocity_m_per_s, ear_pressure_pa");
  expect_refused(run({.arguments = {"render", "hammer-string", "--score", "music/score.json", "-o", "a.wav"},
                      .folder = box.path()}),
                 "music/score.json: instrument: the score is for an instrument file", "allowed: render instrument");
}

// What names a missing file is told: the file, as its own reader names it, and the key.
TEST(BadInstrumentScore, NamesWhoNamesAMissingFile) {
  const Sandbox box;
  fs::create_directory(box / "music");
  write_file(box / "music/score.json", kScore);
  write_file(box / "music/probe.json", changed(kGood, R"("felt_c4")", R"("felts/own.json")"));
  const Call call{.arguments = {"render", "music/score.json", "-o", "a.wav"}, .folder = box.path()};
  expect_refused(run(call),
                 "probe.json: contacts[0].material: music/felts/own.json: file: does not exist; allowed: a file "
                 "of at most 1 MiB",
                 "");
  fs::create_directory(box / "music/felts");
  write_file(box / "music/felts/own.json", R"({"name": "own", "contact": {"curve": {"file": "own.csv",
    "shape": "hardening"}}, "spline": {"knots": "uniform", "segments": 8, "max_compression_m": 0.001}})");
  expect_refused(run(call), "felts/own.json: contact.curve.file: music/felts/own.csv: file: does not exist",
                 "a file of at most 1 MiB");
  fs::remove(box / "music/probe.json");
  expect_refused(run(call), "music/score.json: instrument: music/probe.json: file: does not exist", "");
}

}  // namespace
}  // namespace contactspline::testing
