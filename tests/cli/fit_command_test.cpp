// SPDX-License-Identifier: MIT
// contactspline fit: data in many layouts, the files that it writes, and data that it refuses in one line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

// A half sine of 3 ms and of 10 g that arrive at 2 m/s and leave at 1.6 m/s, at 44.1 kHz from 2 ms on.
double half_sine(double time_s) {
  constexpr double kBegin = 0.002, kDuration = 0.003;
  const double phase = std::numbers::pi * (time_s - kBegin) / kDuration;
  return phase > 0 && phase < std::numbers::pi ? 18.85 * std::sin(phase) : 0;
}

// Between -0.5 and 0.5, without order.
double noise(double time_s) {
  return std::fmod(std::abs(43758.5453 * std::sin(12.9898e6 * time_s)), 1.0) - 0.5;
}

using Line = std::function<std::string(double time_s, double force_n)>;

std::string plain(double time_s, double force_n) {
  return fmt::format("{:.8f},{:.6f}\n", time_s, force_n);
}

std::string pulse(const std::string& header = "time_s,force_n\n", const Line& line = plain, int samples = 400) {
  std::string text = header;
  for (int i = 0; i < samples; ++i) text += line(i / 44100.0, half_sine(i / 44100.0));
  return text;
}

std::string changed(const std::function<double(double time_s, double force_n)>& force) {
  return pulse("time_s,force_n\n", [&](double t, double f) { return plain(t, force(t, f)); });
}

std::string fit_file(const std::string& data, const std::string& mass = "0.01", const std::string& more = "") {
  return fmt::format(R"({{ "name": "probe", "mass_kg": {}, {}{} }})", mass, data, more);
}

const std::string kPulse = R"("pulses": [ { "file": "data.csv", "speed_m_per_s": 2.0 } ])";
std::string pulse_with(const std::string& more) {
  return fmt::format(R"("pulses": [ {{ "file": "data.csv", "speed_m_per_s": 2.0, {} }} ])", more);
}
const std::string kTable = R"("tables": [ { "file": "data.csv" } ])";
const std::string kCurve = R"("curves": [ { "file": "data.csv" } ])";

Outcome fitted(const Sandbox& box, const std::string& fit, const std::string& data, const Words& more = {}) {
  write_file(box / "probe.fit.json", fit);
  write_file(box / "data.csv", data);
  return run({.arguments = followed_by({"fit", "probe.fit.json", "-o", "probe.json"}, more), .folder = box.path()});
}

// T ~ v^(-(a - 1)/(a + 1)) for an exponent of 2.
std::string table(const std::string& header = "speed_m_per_s,duration_ms\n", const std::string& last = "") {
  std::string text = header;
  for (const double speed : {0.25, 0.5, 1.0, 2.0, 4.0})
    text += fmt::format("{},{:.6f}\n", speed, 3 * std::pow(speed, -1 / 3.0));
  return text + last;
}

struct BadData {
  std::string test, fit, data, beginning, says;
};

void PrintTo(const BadData& bad, std::ostream* stream) {
  *stream << bad.test;
}

std::vector<BadData> bad_fit_files() {
  const std::string good = pulse(), file = "probe.fit.json: ";
  return {{"not_json", "name", good, file, ""},
          {"data", good, good, file + "file: is no fit file", R"("pulses": [ { "file": "data.csv" } ])"},
          {"no_data", R"({ "name": "probe", "mass_kg": 0.01 })", good, file + "fit: has no data",
           "pulses, tables, curves or struck"},
          {"no_name", R"({ "mass_kg": 0.01 })", good, file + "name: missing", ""},
          {"bad_name", R"({ "name": "My Felt", "mass_kg": 0.01 })", good, file + "name: ", "a-z, 0-9"},
          {"no_mass", R"({ "name": "probe" })", good, file + "mass_kg: missing", "a number from 1e-07 to 1000"},
          {"mass_of_0", fit_file(kPulse, "0"), good, file + "mass_kg: 0 is out of range", ""},
          {"mass_is_text", fit_file(kPulse, R"("10 g")"), good, file + "mass_kg: is not a number", ""},
          {"unknown_key", fit_file(kPulse, "0.01", R"(, "weight": 1)"), good, file + "weight: unknown key", "pulses"},
          {"unknown_law", fit_file(kPulse, "0.01", R"(, "laws": ["cubic"])"), good, file + "laws: 'cubic' is unknown",
           "power, hertz, layers"},
          {"layers_alone", fit_file(kPulse, "0.01", R"(, "laws": "layers")"), good,
           file + "laws: layers stand without the power law", "power beside layers"},
          {"law_twice", fit_file(kPulse, "0.01", R"(, "laws": ["hertz", "hertz"])"), good,
           file + "laws: names one of them", ""},
          {"unknown_loss", fit_file(kPulse, "0.01", R"(, "losses": "air")"), good, file + "losses: 'air' is unknown",
           "hunt_crossley"},
          {"no_pulses", fit_file(R"("pulses": [])"), good, file + "pulses: has 0 entries", ""},
          {"no_file", fit_file(R"("pulses": [{}])"), good, file + "pulses[0].file: missing", "CSV"},
          {"file_of_no_name", fit_file(R"("pulses": [{ "file": "" }])"), good,
           file + "pulses[0].file: '' is not usable", ""},
          {"absolute_path", fit_file(R"("pulses": [{ "file": "/etc/passwd" }])"), good,
           file + "pulses[0].file: '/etc/passwd'", "relative to the fit file"},
          {"missing_file", fit_file(R"("pulses": [{ "file": "none.csv" }])"), good,
           file + "pulses[0].file: none.csv: file: does not exist", ""},
          {"speed_of_0", fit_file(R"("pulses": [{ "file": "data.csv", "speed_m_per_s": 0 }])"), good,
           file + "pulses[0].speed_m_per_s: 0 is out of range", "0.001 to 100"},
          {"negative_speed", fit_file(R"("pulses": [{ "file": "data.csv", "speed_m_per_s": -2 }])"), good,
           file + "pulses[0].speed_m_per_s: -2 is out of range", ""},
          {"unknown_column_key", fit_file(R"("pulses": [{ "file": "data.csv", "columns": { "time_h": "t" } }])"),
           good, file + "pulses[0].columns.time_h: unknown key", "time_ms"},
          {"no_such_column", fit_file(R"("pulses": [{ "file": "data.csv", "columns": { "force_n": "Channel B" } }])"),
           good, "data.csv: line 1: there is no column 'Channel B'", "time_s, force_n, or a number from 1 to 2"},
          {"order_without_low_pass", fit_file(pulse_with(R"("low_pass_order": 2)")), good,
           file + "pulses[0].low_pass_order: stands without low_pass_hz", ""},
          {"low_pass_of_1_hz", fit_file(pulse_with(R"("low_pass_hz": 1)")), good,
           file + "pulses[0].low_pass_hz: 1 is out of range", "10 to 1000000"},
          {"sensitivity_of_newtons", fit_file(pulse_with(R"("sensitivity_mv_per_n": 10)")), good,
           file + "pulses[0].sensitivity_mv_per_n: stands beside a force that is in newtons", "a column in V or mV"},
          {"volts_without_sensitivity", fit_file(kPulse), pulse("time_s,force [V]\n"), "data.csv: force: is in volts",
           "newtons, or the key sensitivity_mv_per_n"},
          {"skips_all_lines", fit_file(pulse_with(R"("skip_lines": 9999)")), good, "data.csv: file: is empty", ""}};
}

std::vector<BadData> bad_pulses() {
  const std::string fit = fit_file(kPulse), file = "data.csv: ";
  const auto with = [&](const std::string& test, const std::string& data, const std::string& beginning,
                        const std::string& says = "") {
    return BadData{test, fit, data, file + beginning, says};
  };
  return {
      with("empty", "", "file: is empty", "a header"),
      with("comments_only", "# nothing\n", "file: is empty"),
      with("no_text", "PK\3\4" + std::string(8, '\0') + "\n", "file: is no text", "a recording ends in .wav, .flac"),
      with("header_only", "time_s,force_n\n", "samples: has a header and no numbers"),
      with("one_sample", "time_s,force_n\n0,1\n", "samples: has 1;", "16 or more"),
      with("no_header", pulse(""), "line 1: there is no header", "columns"),
      with("header_of_an_oscilloscope", "Model,MSO44\nLabel,,\n" + pulse("TIME,CH1\n"),
           "line 3: the column 'time' has no unit",
           "time_s, time_ms, time_us, in the header or as a key of columns beside file"),
      with("lines_above_no_header", "Recorded by me\n" + pulse(""), "line 2: has 1 columns",
           "or the key skip_lines for lines above the header"),
      with("unit_missing", pulse("time,force_n\n"), "line 1: the column 'time' has no unit",
           "time_s, time_ms, time_us"),
      with("unit_unknown", pulse("time [h],force_n\n"), "line 1: the unit 'h' of the column 'time' is unknown",
           "time_ms"),
      with("no_force", pulse("time_s,voltage\n"),
           "force: no column holds it, nor an acceleration: the header has time_s, voltage",
           "force_kgf, acceleration_m_per_s2, acceleration_g, or the key columns"),
      with(
          "no_time", pulse("moment,force_n\n"), "time: no column holds it: the header has moment, force_n",
          R"(a column time_s, time_ms, time_us, or the key columns beside file, such as "columns": { "time_s": "NAME" })"),
      with("force_twice", pulse("force_n,force_mn\n"),
           "line 1: two columns hold the force: 'force_n' and 'force_mn'"),
      with("force_and_acceleration", "time_s,force_n,acceleration_g\n0,0,0\n",
           "force: is there beside an acceleration"),
      with("not_a_number", pulse() + "1,one\n", "line 402: 'one' is not a number"),
      with("nan", pulse() + "1,nan\n", "line 402: 'nan' is not a number"),
      with("infinite", pulse() + "1,inf\n", "line 402: 'inf' is not a number"),
      with("blank_cell", pulse() + "1,\n", "line 402: '' is not a number"),
      with("row_of_one", pulse() + "1\n", "line 402: has 1 columns", "2 columns"),
      with("row_of_three", pulse() + "1,2,3\n", "line 402: has 3 columns", "2 columns"),
      with("decimal_commas_between_commas", pulse() + "0,01,2,5\n", "line 402: has 4 columns"),
      with("unsorted", pulse() + "0.001,0\n", "line 402: time 0.001 s does not rise", "rising times"),
      with("time_stands", pulse() + "0.00904762,0\n", "line 402: time 0.00904762 s does not rise"),
      with("exchanged", pulse("force_n,time_s\n"), "line 3: time 0 s does not rise", "are two columns exchanged?"),
      with("silence", changed([](double, double) { return 0.0; }), "force: is 0 N throughout: there is no contact"),
      with("noise_alone", changed([](double t, double) { return noise(t); }), "force: no contact stands out"),
      with("wrong_sign", changed([](double, double f) { return -f; }), "force: reaches -18.85 N downwards",
           "change the sign"),
      with("begins_in_contact", changed([](double t, double) { return half_sine(t + 0.0035); }),
           "force: the record begins within the contact"),
      with("ends_in_contact", changed([](double t, double) { return half_sine(t - 0.0055); }),
           "force: the record ends within the contact"),
      with("saturated", changed([](double, double f) { return std::min(f, 15.0); }),
           "force: 55 samples in a row are 15 N: the sensor was saturated", "within the range"),
      with("two_contacts", changed([](double t, double f) { return f + 0.6 * half_sine(t - 0.0035); }),
           "force: has a second contact at"),
      with("too_few_in_contact",
           pulse("time_ms,force_n\n", [](double t, double) { return plain(20 * t * 1e3, half_sine(20 * t)); }),
           "samples: has 6 in the contact", "a higher sample rate"),
      with("force_in_mn", pulse("time_s,force_mn\n"), "force: its impulse is 0.0018",
           "is a unit, the mass or the speed wrong?"),
      with("force_in_kn", pulse("time_s,force_kn\n"), "force: its impulse is 1800 times mass times speed"),
      with("time_in_ms", pulse("time_ms,force_n\n"), "force: its impulse is 0.0018"),
      with("time_too_long", pulse("time_s,force_n\n", [](double t, double f) { return plain(1000 * t, f); }),
           "time: the contact lasts 2.789 s", "a wrong unit?"),
      with("acceleration_in_g", pulse("time_s,acceleration_g\n"), "force: its impulse is 0.17"),
      with("force_too_large", changed([](double, double f) { return 1e6 * f; }),
           "force: reaches 1.885e+07 N: a wrong unit?"),
  };
}

std::vector<BadData> bad_tables() {
  const std::string fit = fit_file(kTable), curve = fit_file(kCurve), file = "data.csv: ";
  const auto with = [&](const std::string& test, const std::string& data, const std::string& beginning,
                        const std::string& says = "") {
    return BadData{test, fit, data, beginning, says};
  };
  const std::string tables = "probe.fit.json: tables: ";
  return {
      with("table_is_empty", "", file + "file: is empty"),
      with("no_speed", table("rate,duration_ms\n"), file + "speed: no column holds it",
           "speed_m_per_s, speed_cm_per_s"),
      with("speeds_alone", "speed_m_per_s\n1\n2\n3\n", file + "columns: there is nothing but speeds",
           "contact durations"),
      with("negative_duration", table("speed_m_per_s,duration_ms\n", "5,-1\n"),
           file + "line 7: a duration of -0.001"),
      with("negative_speed_in_table", table("speed_m_per_s,duration_ms\n", "-1,3\n"), file + "line 7: a speed of -1"),
      with("speed_of_0_in_table", table("speed_m_per_s,duration_ms\n", "0,3\n"), file + "line 7: a speed of 0"),
      with("duration_in_s", table("speed_m_per_s,duration_s\n"), file + "line 2: a duration of 4.7", "a wrong unit"),
      with("columns_exchanged", table("duration_s,speed_m_per_s\n"), file + "line 2: a duration of 0.25",
           "exchanged?"),
      with("restitution_above_1", "speed_m_per_s,duration_ms,e\n1,3,0.8\n2,2.4,1.2\n",
           file + "line 3: a restitution of 1.2"),
      with("restitution_in_percent", "speed_m_per_s,duration_ms,e\n1,3,80\n", file + "line 2: a restitution of 80"),
      with("restitution_alone", "speed_m_per_s,e\n1,0.8\n2,0.7\n3,0.6\n", tables + "tell nothing of the stiffness"),
      with("two_rows", "speed_m_per_s,duration_ms\n1,3\n2,2.4\n", tables + "has 2 impacts", "3 or more"),
      with("one_speed", "speed_m_per_s,duration_ms\n1,3\n1,3.1\n1,2.9\n",
           tables + "has 3 impacts at speeds from 1 to 1 m/s"),
      {"curve_of_few", curve, "compression_mm,force_n\n0.1,1\n0.2,3\n", file + "samples: has 2", "8 to 10000"},
      {"curve_falls", curve, "compression_mm,force_n\n0.2,1\n0.1,3\n",
       file + "line 3: compression 0.0001 m does not rise", ""},
      {"curve_without_compression", curve, "depth,force_n\n1,1\n", file + "compression: no column holds it", ""}};
}

// Data whose best law no material file may hold: a stiffness, or that of a core, is out of range.
std::string press_of_core() {
  std::string text = "compression_um,force_n\n";
  for (int i = 1; i <= 40; ++i) {
    const double y = i / 40.0;
    text +=
        fmt::format("{},{:.6f}\n", 0.01 * y, 1e5 * std::pow(y, 1.2) + 1.5e6 * std::pow(std::max(0.0, y - 0.5), 1.5));
  }
  return text;
}

std::string durations_of_exponent_4() {
  std::string text = "speed_m_per_s,duration_us\n";
  for (const double speed : {0.25, 0.5, 1.0, 2.0, 4.0})
    text += fmt::format("{},{:.6f}\n", speed, 3 * std::pow(speed, -0.6));
  return text;
}

std::vector<BadData> no_materials() {
  const std::string fit = "probe.fit.json: fit: the ";
  return {
      {"stiffness", fit_file(kTable), durations_of_exponent_4(),
       fit + "power law without loss describes the data far better than all others, and its stiffness is 1.02e+28 "
             "N/m^4, which no material has",
       "0.001 to 1e+18 N/m^4: do the units"},
      {"core", fit_file(kCurve), press_of_core(),
       fit + "power law over a core without loss describes the data far better than all others, and its stiffness "
             "of the core is 1.5",
       "0.001 to 1e+18 N/m^1.5: is a length wrong? else \"laws\": [\"power\", \"hertz\"]"}};
}

// Blows on the bar that ships: partials 1, 3, 5, ... sound.
std::string struck_file(const std::string& blows, const std::string& output = "acceleration_m_per_s2",
                        const std::string& resonator = "marimba_c4", const std::string& gain = "common") {
  return fit_file(fmt::format(R"("struck": {{ "resonator": "{}", "output": "{}", "gain": "{}", "blows": [{}] }})",
                              resonator, output, gain, blows));
}

std::vector<BadData> bad_blows() {
  const std::string blow = R"({ "file": "data.csv", "speed_m_per_s": 1 })", fit = struck_file(blow),
                    good = "partial,level_db\n1,-3\n3,-9\n5,-20\n",
                    file = "data.csv: ", struck = "probe.fit.json: struck";
  const auto with = [&](const std::string& test, const std::string& data, const std::string& beginning,
                        const std::string& says = "") {
    return BadData{test, fit, data, file + beginning, says};
  };
  return {
      with("no_levels", "", "file: is empty"),
      with("levels_of_header_only", "partial,level_db\n", "samples: has a header and no numbers"),
      with("level_is_nan", good + "7,nan\n", "line 5: 'nan' is not a number"),
      with("level_is_infinite", good + "7,inf\n", "line 5: 'inf' is not a number"),
      with("level_of_1000_db", good + "7,1000\n", "line 5: a level of 1000 dB", "-300 to 300"),
      with("no_level", "partial,loudness\n1,2\n", "level: no column holds it", "a column level_db, or"),
      with("no_partial", "row,level_db\n1,2\n", "columns: no column names the partials", "frequency_UNIT"),
      with("partials_and_frequencies", "partial,frequency_hz,level_db\n1,261.6,2\n",
           "columns: there are partials beside frequencies"),
      with("negative_frequency", "frequency_hz,level_db\n-261.6,2\n", "line 2: a frequency of -261.6 Hz"),
      with("frequency_of_no_mode", "frequency_hz,level_db\n440,2\n", "line 2: no mode is within 3 % of 440 Hz"),
      with("partial_0", "partial,level_db\n0,2\n", "line 2: there is no partial 0"),
      with("partial_of_a_half", "partial,level_db\n1.5,2\n", "line 2: there is no partial 1.5"),
      with("partial_at_a_node", "partial,level_db\n2,2\n", "line 2: partial 2 has a node"),
      with("partial_twice", good + "3,-9\n", "line 5: partial 3 of", "each partial once"),
      with("two_partials", "partial,level_db\n1,-3\n3,-9\n", "partials: 2 of them can be used", "3 or more"),
      {"unknown_resonator", struck_file(blow, "velocity_m_per_s", "tamtam"), good,
       struck + ".resonator: 'tamtam' does not ship", "list resonators"},
      {"unknown_output", struck_file(blow, "loudness"), good, struck + ".output: 'loudness' is unknown",
       "acceleration_m_per_s2"},
      {"bridge_of_a_bar", struck_file(blow, "bridge_force_n"), good, struck + ".output: 'bridge_force_n' is unknown",
       ""},
      {"unknown_gain", struck_file(blow, "displacement_m", "marimba_c4", "3"), good, struck + ".gain: '3' is unknown",
       "common, of_each_blow"},
      {"unknown_key_of_blow", struck_file(R"({ "file": "data.csv", "speed": 1 })"), good,
       struck + ".blows[0].speed: unknown key", "speed_m_per_s"},
      {"no_speeds", struck_file(R"({ "file": "data.csv" })"), good, struck + ".blows: the speeds", "one known speed"},
      {"blows_of_one_speed", fit, good, struck + ".blows: speeds from 1 to 1 m/s", "hertz"},
      {"partials_of_a_table", struck_file(R"({ "file": "data.csv", "partials": [1] })"), good,
       struck + ".blows[0].partials: stands beside a table", "columns"},
      {"struck_without_data", fit_file(R"("struck": { "resonator": "marimba_c4" })"), good, struck + ": has no data",
       "blows, pulses or both"},
      {"gain_of_pulses",
       fit_file(R"("struck": { "resonator": "marimba_c4", "gain": "common", "pulses": [{ "file": "data.csv" }] })"),
       good, struck + ".gain: stands without blows", "pulses alone"},
      {"struck_pulse_without_time",
       fit_file(R"("struck": { "resonator": "marimba_c4", "pulses": [{ "file": "data.csv" }] })"), good,
       file + "time: no column holds it", ""},
      {"mass_fitted_to_struck_pulses",
       fit_file(R"("struck": { "resonator": "marimba_c4", "pulses": [{ "file": "data.csv" }] })", "\"fit\""), pulse(),
       "probe.fit.json: mass_kg: can be fitted", ""},
      {"mass_fitted_to_pulses", fit_file(kPulse, "\"fit\""), pulse(), "probe.fit.json: mass_kg: can be fitted", ""}};
}

class BadMeasurements : public ::testing::TestWithParam<BadData> {};

TEST_P(BadMeasurements, AreRefusedInOneLineAndNothingIsWritten) {
  const Sandbox box;
  expect_refused(fitted(box, GetParam().fit, GetParam().data), GetParam().beginning, GetParam().says);
  EXPECT_FALSE(fs::exists(box / "probe.json"));
}

const auto kName = [](const auto& bad) { return bad.param.test; };
INSTANTIATE_TEST_SUITE_P(FitFile, BadMeasurements, ::testing::ValuesIn(bad_fit_files()), kName);
INSTANTIATE_TEST_SUITE_P(Pulse, BadMeasurements, ::testing::ValuesIn(bad_pulses()), kName);
INSTANTIATE_TEST_SUITE_P(Blow, BadMeasurements, ::testing::ValuesIn(bad_blows()), kName);
INSTANTIATE_TEST_SUITE_P(Table, BadMeasurements, ::testing::ValuesIn(bad_tables()), kName);
INSTANTIATE_TEST_SUITE_P(NoMaterial, BadMeasurements, ::testing::ValuesIn(no_materials()), kName);

// The same pulse in other columns, units and separators gives the same material, but for rounding: of the times, by
// which a sample at the border of what is fitted may come or go.
TEST(Measurements, AreReadInManyLayouts) {
  const auto exponent = [](const std::string& fit, const std::string& data) {
    const Sandbox box;
    const auto found = nlohmann::json::parse(succeed(fitted(box, fit, data, {"--json"})));
    EXPECT_NE(read_file(box / "probe.json").find("\"name\": \"probe\""), std::string::npos);
    return found.at("estimates").at("exponent").at("value").get<double>();
  };
  const std::string power = R"(, "laws": "power", "losses": "hunt_crossley")", fit = fit_file(kPulse, "0.01", power);
  const double plainly = exponent(fit, pulse());
  const auto comma = [](double t, double f) {
    std::string line = fmt::format("{:.8f};x;{:.6f}\n", 1e3 * (t - 0.01), f);
    std::ranges::replace(line, '.', ',');
    return line;
  };
  const auto acceleration = [](double t, double f) {
    return fmt::format(" {:.8f}   {:.9f}\r\n", 1e6 * t, f / 0.01 / 9.80665);
  };
  EXPECT_TRUE(within(exponent(fit, pulse("Time (ms);Note;Force (N)\n", comma)), plainly, 3e-3));
  EXPECT_TRUE(within(exponent(fit, pulse("t;Channel A;F\n(ms);(V);(N)\n", comma)), plainly, 3e-3));
  EXPECT_TRUE(within(exponent(fit, pulse("time_us acc_g\r\n", acceleration)), plainly, 3e-3));
  EXPECT_TRUE(within(exponent(fit, pulse("\xef\xbb\xbf% a comment\nt/s,load [N]\n")), plainly, 1e-9));
  const std::string named =
      R"("pulses": [ { "file": "data.csv", "speed_m_per_s": 2.0, "columns": { "time_s": "1", "force_n": "2" } } ])";
  EXPECT_TRUE(within(exponent(fit_file(named, "0.01", power), pulse("")), plainly, 1e-9));
  EXPECT_TRUE(within(exponent(fit_file(named, "0.01", power), pulse("A,B\n")), plainly, 1e-9));
  const auto utf_16 = [](const std::string& text) {
    std::string wide = "\xff\xfe";
    for (const char c : text) (wide += c) += '\0';
    return wide;
  };
  EXPECT_TRUE(within(exponent(fit, utf_16(pulse())), plainly, 1e-9));
  EXPECT_TRUE(within(exponent(fit, pulse("t [s],F [N],Pr\xfc"
                                         "fling\n",
                                         [](double t, double f) { return fmt::format("{:.8f},{:.6f},1\n", t, f); })),
                     plainly, 1e-9));
  const auto scaled = [](double factor) {
    return [factor](double t, double f) { return fmt::format("{:.8f},{:.9f}\n", t, factor * f); };
  };
  EXPECT_TRUE(within(exponent(fit, pulse("time_s,force_lbf\n", scaled(1 / 4.4482216152605))), plainly, 1e-4));
  EXPECT_TRUE(within(exponent(fit, pulse("time_s,force_kgf\n", scaled(1 / 9.80665))), plainly, 1e-4));
  const std::string volts = pulse_with(R"("sensitivity_mv_per_n": 11.2)");
  EXPECT_TRUE(
      within(exponent(fit_file(volts, "0.01", power), pulse("time_s,force [V]\n", scaled(11.2e-3))), plainly, 1e-4));
  const std::string preamble = "Model,MSO44\nSample Interval,2.2e-05\nVertical Units,N\n\n";
  EXPECT_TRUE(within(exponent(fit, preamble + pulse()), plainly, 1e-9));
  for (const auto& [columns, header] : {std::pair{R"("time_s": "TIME", "force_n": "CH1")", "TIME,CH1\n"},
                                        {R"("time_s": "1", "force_n": "2")", "TIME,CH1\n"},
                                        {R"("time_s": "1", "force_n": "2")", "A,B\n(s),(N)\n"}})
    EXPECT_TRUE(within(exponent(fit_file(pulse_with(fmt::format(R"("columns": {{ {} }})", columns)), "0.01", power),
                                preamble + "Label,,\nRecord,Length\n1000,2\n" + pulse(header)),
                       plainly, 1e-9))
        << columns << header;
  EXPECT_TRUE(within(exponent(fit_file(pulse_with(R"("skip_lines": 2)"), "0.01", power), "1,2,3\n4;5\n" + pulse()),
                     plainly, 1e-9));
}

// A baseline of the sensor is taken away whole. What stays is the rounding of the file, and two more terms that
// follow the noise where there is a hum.
TEST(Measurements, AreFreedOfOffsetDriftAndHum) {
  const auto exponent = [](const std::function<double(double time_s)>& more) {
    const Sandbox box;
    const std::string fit = fit_file(kPulse, "0.01", R"(, "laws": "power", "losses": "hunt_crossley")");
    const std::string data = pulse(
        "time_s,force_n\n", [&](double t, double f) { return plain(t, f + more(t) + 0.1 * noise(t)); }, 2000);
    const auto found = nlohmann::json::parse(succeed(fitted(box, fit, data, {"--json"})));
    return found.at("estimates").at("exponent").at("value").get<double>();
  };
  const double plainly = exponent([](double) { return 0.0; });
  for (const auto& more : std::initializer_list<std::function<double(double)>>{
           [](double) { return 5.0; }, [](double) { return -5.0; }, [](double t) { return 60 * t; },
           [](double t) { return 3 * std::cos(2 * std::numbers::pi * 50 * t); }})
    EXPECT_TRUE(within(exponent(more), plainly, 1e-3));
}

// Data of one random attack each: a law with a stiffness of 1.5e19 once described the first best, and an infinite
// interval the second.
TEST(Fit, WritesOnlyWhatCommandsAndJsonReadersTake) {
  const fs::path data = fs::path(SOURCE_FOLDER) / "tests/fit/data";
  for (const char* name : {"core_out_of_reach", "infinite_interval"}) {
    const Sandbox box;
    const Outcome outcome =
        run({.arguments = {"fit", (data / name / "probe.fit.json").string(), "--json", "-o", "probe.json"},
             .folder = box.path()});
    ASSERT_EQ(outcome.exit_code, 0) << name << outcome.err;
    for (const auto& [key, estimate] : nlohmann::json::parse(outcome.out).at("estimates").items())
      EXPECT_TRUE(estimate.at("low").is_number() && estimate.at("high").is_number()) << name << ' ' << key;
    succeed({.arguments = {"inspect", "probe.json"}, .folder = box.path()});
  }
}

// Twenty thousand samples tell what 400 do, and take no longer.
TEST(Fit, TakesTheMeansOfManySamples) {
  constexpr int kSamples = 20000;
  std::string many = "time_s,force_n\n";
  for (int i = 0; i < kSamples; ++i) many += fmt::format("{:.10f},{:.6f}\n", 5e-7 * i, half_sine(5e-7 * i));
  const auto fit_to = [](const std::string& data) {
    const Sandbox box;
    const std::string fit = fit_file(kPulse, "0.01", R"(, "laws": "power", "losses": "hunt_crossley")");
    return nlohmann::json::parse(succeed(fitted(box, fit, data, {"--json"})));
  };
  const auto found = fit_to(many), few = fit_to(pulse());
  EXPECT_LE(found.at("data")[0].at("samples"), 1500);
  EXPECT_NE(found.at("notes").dump().find("the means of neighbours were fitted"), std::string::npos) << found;
  EXPECT_EQ(few.at("notes").dump().find("means"), std::string::npos);
  EXPECT_TRUE(within(found.at("estimates").at("exponent").at("value").get<double>(),
                     few.at("estimates").at("exponent").at("value").get<double>(), 0.01));
}

// A millionth of the stiffness of any hammer: volts, say, in a column of newtons.
TEST(Fit, QuestionsForcesOutOfProportion) {
  const Sandbox box;
  const std::string fit = fit_file(R"("pulses": [ { "file": "data.csv" } ])");
  const std::string report = succeed(fitted(box, fit, changed([](double, double f) { return 1e-4 * f; })));
  EXPECT_NE(report.find("is out of proportion: is a unit wrong, or are volts called newtons?"), std::string::npos)
      << report;
}

// The file that is written is a material, and says how good the fit is.
TEST(Fit, WritesAMaterialThatTheGeneratorReads) {
  const Sandbox box;
  const std::string report = succeed(fitted(box, fit_file(kTable), table()));
  EXPECT_NE(report.find("power law without loss, mass 0.01 kg"), std::string::npos) << report;
  EXPECT_NE(report.find("95 % interval"), std::string::npos);
  EXPECT_NE(report.find("the largest speed"), std::string::npos);
  const std::string text = read_file(box / "probe.json");
  for (const char* line : {"// Written by contactspline", "//   exponent", "// chosen by the Bayesian"})
    EXPECT_NE(text.find(line), std::string::npos) << text;
  const auto material = nlohmann::json::parse(text, nullptr, true, true);
  EXPECT_TRUE(within(material.at("contact").at("exponent"), 2, 1e-4));
  EXPECT_TRUE(relatively_within(material.at("impact").at("max_speed_m_per_s"), 4, 2e-3));
  EXPECT_NE(succeed({.arguments = {"inspect", "probe.json"}, .folder = box.path()}).find("probe"), std::string::npos);
  succeed({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
  succeed(fitted(box, fit_file(kTable), table()));  // replaces its own file
  write_file(box / "probe.json", "{}");
  expect_refused(fitted(box, fit_file(kTable), table()), "probe.json: file: ", "--force");
}

TEST(Fit, DrawsDataModelAndResiduals) {
  const Sandbox box;
  succeed(fitted(box, fit_file(kTable), table(), {"--figure", "probe.svg"}));
  for (const char* text : {"figure of a fit", "<text>data</text>", "<text>model</text>"})
    EXPECT_NE(read_file(box / "probe.svg").find(text), std::string::npos) << text;
  expect_refused(fitted(box, fit_file(kTable), table(), {"--figure", "probe.xyz"}), "probe.xyz: figure: ", ".svg");
}

}  // namespace
}  // namespace contactspline::testing
