// SPDX-License-Identifier: MIT
// contactspline._core: what the Python package calls. Arrays go in and out without a copy where that is possible; the
// interpreter's lock is released while something is designed or played.
#include <fmt/format.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/host/oversampled.hpp"
#include "contactspline/host/tuned_keys.hpp"
#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/inspect_json.hpp"
#include "generator/cli/parts.hpp"
#include "generator/fit/fit.hpp"
#include "generator/fit/fitted_material.hpp"
#include "generator/fit/measurements_reader.hpp"
#include "generator/player/playing.hpp"
#include "generator/player/score_player.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design_impact.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/input_file.hpp"
#include "generator/support/sample_rates.hpp"
#include "generator/support/task_pool.hpp"
#include "hosts/python/idle_instruments.hpp"
#include "hosts/python/makers.hpp"
#include "hosts/python/resonators.hpp"
#include "hosts/python/struck_string.hpp"

namespace contactspline::python {
namespace {

namespace py = pybind11;
template <typename T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

// Called now and then by what takes long, without the interpreter's lock: Ctrl-C stops it.
void stop_on_signal() {
  const py::gil_scoped_acquire locked;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

Design design_of(const std::string& source, bool is_text) {
  const py::gil_scoped_release unlocked;
  return is_text ? design_material(source, "material", read_input) : design_argument(source);
}

// Designs the materials that ship or that files and texts describe, on the given number of threads.
std::vector<Design> design_many(const std::vector<std::pair<std::string, bool>>& sources, std::size_t threads,
                                const std::function<void(std::size_t)>& watch) {
  std::vector<std::optional<Design>> designs(sources.size());
  std::atomic<bool> is_stopped = false;
  {
    const py::gil_scoped_release unlocked;
    run_tasks(
        sources.size(), threads,
        [&](std::size_t i) {
          const auto& [source, is_text] = sources[i];
          designs[i] = is_text ? design_material(source, "material", read_input) : design_argument(source);
        },
        [&](std::size_t done) {
          const py::gil_scoped_acquire locked;
          watch(done);
        },
        is_stopped);
  }
  std::vector<Design> all;
  for (auto& design : designs)
    if (design) all.push_back(std::move(*design));
  return all;
}

// The members of all segments as an array.
Array<double> members(const Design& design, double Segment<double>::*member) {
  Array<double> values(static_cast<py::ssize_t>(design.spline.segments.size()));
  for (std::size_t i = 0; i < design.spline.segments.size(); ++i)
    values.mutable_at(static_cast<py::ssize_t>(i)) = design.spline.segments[i].*member;
  return values;
}

template <typename F>
Array<double> each(const Array<double>& compressions, F f) {
  Array<double> values(compressions.request().shape);
  for (py::ssize_t i = 0; i < compressions.size(); ++i) values.mutable_data()[i] = f(compressions.data()[i]);
  return values;
}

// The mass of the material's impacts.
double mass_of(const Design& design) {
  if (!design.material.impact)
    refuse(design.material.name, "mass_kg", "missing, and the material has no impact",
           "a number above 0, such as 0.003");
  return design.material.impact->mass_kg;
}

BarrierImpact impact_of(const Design& design, double speed, double mass, const std::string& of, double rate) {
  if (!(speed > 0 && speed <= 1e3))
    refuse(design.material.name, "speed_m_per_s", fmt::format("{} is refused", speed),
           "a number above 0, up to 1000");
  if (!(mass > 0 && mass <= 1e4))
    refuse(design.material.name, "mass_kg", fmt::format("{} is refused", mass), "a number above 0, up to 10000");
  if (of == "exact") return exact_impact(design.material, mass, speed);
  if (of == "spline") return spline_impact(design, mass, speed);
  if (!(rate >= 1e3 && rate <= 1e8))
    refuse(design.material.name, "sample_rate_hz", fmt::format("{} is refused", rate), "a number from 1000 to 1e+08");
  return simulated_impact(design, mass, speed, rate, design.material.name);
}

// Impacts of speeds and masses, arrays of one shape: largest compressions, durations, exit speeds, largest forces.
py::tuple impacts_of(const Design& design, const Array<double>& speeds, const Array<double>& masses,
                     const std::string& of, double rate) {
  constexpr std::array kMembers = {&BarrierImpact::max_compression_m, &BarrierImpact::contact_duration_s,
                                   &BarrierImpact::exit_speed_m_per_s, &BarrierImpact::max_force_n};
  std::vector<Array<double>> arrays;
  std::array<double*, kMembers.size()> values{};
  for (double*& value : values) value = arrays.emplace_back(speeds.request().shape).mutable_data();
  {
    const auto count = static_cast<std::size_t>(speeds.size());
    const double *const speed = speeds.data(), *const mass = masses.data();
    const py::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < count; ++i) {
      const BarrierImpact impact = impact_of(design, speed[i], mass[i], of, rate);
      for (std::size_t m = 0; m < kMembers.size(); ++m) values[m][i] = impact.*kMembers[m];
      if (i % 16 == 15) stop_on_signal();
    }
  }
  return py::make_tuple(arrays[0], arrays[1], arrays[2], arrays[3]);
}

// The first values of parameters, and all that happens.
using Values = std::vector<std::pair<std::size_t, double>>;
using Rows =
    std::vector<std::tuple<double, int, std::size_t, double, double>>;  // sample, action, number, value, rise

// cents: of the 128 keys of MIDI; none: as they are.
std::vector<TimedEvent> events_in(const Rows& rows, const AnyInstrument<double>& instrument,
                                  const std::vector<double>& cents) {
  TunedKeys keys;
  if (!cents.empty()) {
    if (cents.size() != kMidiKeys)
      refuse(instrument.name(), "tuning", fmt::format("has {} numbers", cents.size()), "128, as read_tuning() gives");
    if (!instrument.bends_keys())
      refuse(instrument.name(), "tuning", "it has no keys that could be tuned",
             "a piano, or an instrument whose keys have a tuned_key");
    KeyCents table;
    std::ranges::copy(cents, table.begin());
    keys.tune(tuned(midi_settings(instrument), table));
  }
  std::vector<TimedEvent> events;
  for (const auto& [sample, action, number, value, rise] : rows)
    keys.take({static_cast<std::size_t>(sample), Action(action), number, value, rise},
              [&](const TimedEvent& event) { events.push_back(event); });
  return events;
}

// The cents of all keys by files of Scala, each empty or a path.
std::vector<double> read_tuning(const std::string& scale, const std::string& keymap, std::optional<double> a4_hz) {
  const KeyCents cents = key_cents(tuning_argument(scale, keymap, a4_hz));
  return {cents.begin(), cents.end()};
}

/// An instrument of Python: how to make it, and one that tells its lists.
class Source {
 public:
  Source(const std::string& source, bool is_text, const std::string& parts) {
    const py::gil_scoped_release unlocked;
    maker_ = maker_of(source, is_text, parts);
    shown_ = maker_.make<double>(44100);
  }

  [[nodiscard]] const AnyInstrument<double>& shown() const { return *shown_; }
  [[nodiscard]] static std::size_t latency(int factor) { return Decimator<double>(factor).delay(); }

  /// Returns all wanted outputs, the force (or nothing) and the energies (or nothing). Sounds and force of an
  /// instrument that runs at `factor` times the rate begin latency(factor) samples late, and have so many more.
  template <std::floating_point T>
  [[nodiscard]] py::tuple play(const Values& initial, const Rows& rows, std::size_t samples, double rate,
                               const std::vector<bool>& wanted, bool force, std::size_t energy_step,
                               const std::vector<double>& cents, int factor) const {
    samples += latency(factor);
    py::list outputs;
    Recording<T> recording;
    const auto array = [&](auto value, std::size_t length) {
      return py::array_t<decltype(value)>(static_cast<py::ssize_t>(length));
    };
    for (const bool is_wanted : wanted) {
      py::array_t<T> output = array(T(), is_wanted ? samples : 0);
      recording.outputs.emplace_back(output.mutable_data(), is_wanted ? samples : 0);
      outputs.append(output);
    }
    py::array_t<T> forces = array(T(), force ? samples : 0);
    py::array_t<double> energies = array(0.0, energy_step > 0 ? samples / energy_step : 0);
    if (force) recording.force = {forces.mutable_data(), samples};
    recording.energy = {energies.mutable_data(), static_cast<std::size_t>(energies.size())};
    recording.energy_step = energy_step;
    {
      const py::gil_scoped_release unlocked;
      const auto events = events_in(rows, *shown_, cents);
      Handle<T> instrument = factor == 1 ? idle_in(T()).take(maker_, rate)
                                         : std::make_unique<Oversampled<T>>(maker_.make<T>(factor * rate), factor);
      for (const auto& [parameter, value] : initial) instrument->set(parameter, value);
      instrument->prepare(rate);
      try {
        render<T>(*instrument, events, samples, recording, stop_on_signal);
      } catch (const NotFinite& failure) {
        refuse(shown_->name(), "sound", failure.what(), "other values of parameters or events");
      }
      if (cents.empty() && factor == 1) idle_in(T()).put(std::move(instrument), rate);  // tuned keys stay bent
    }
    return py::make_tuple(outputs, forces, energies);
  }

  /// Row i of `sounds` is what output `output` plays, or after the last one the force of contacts, under row i of
  /// `values`, of the parameters `numbers`.
  template <std::floating_point T>
  void play_many(const std::vector<std::size_t>& numbers, const Array<double>& values, const Rows& rows, double rate,
                 std::size_t output, py::array_t<float, py::array::c_style> sounds, std::size_t threads,
                 const std::function<void(std::size_t)>& watch) const {
    const auto samples = static_cast<std::size_t>(sounds.shape(1));
    float* const first = sounds.mutable_data();
    const double* const value = values.data();
    const std::size_t outputs = shown_->outputs().size();
    std::atomic<bool> is_stopped = false;
    const py::gil_scoped_release unlocked;
    const auto events = events_in(rows, *shown_, {});
    IdleInstruments<T> idle;
    run_tasks(
        static_cast<std::size_t>(sounds.shape(0)), threads,
        [&](std::size_t i) {
          auto instrument = idle.take(maker_, rate);
          for (std::size_t p = 0; p < numbers.size(); ++p) instrument->set(numbers[p], value[i * numbers.size() + p]);
          instrument->prepare(rate);
          const auto stop = [&] {
            if (is_stopped) throw Stopped();
          };
          const std::span<float> sound(first + i * samples, samples);
          const auto rendered = [&](const Recording<T>& into) {
            try {
              render<T>(*instrument, events, samples, into, stop);
            } catch (const NotFinite& failure) {
              refuse(shown_->name(), fmt::format("row {}", i), failure.what(),
                     "other values of parameters or events");
            }
          };
          Recording<T> recording{std::vector<std::span<T>>(outputs), {}};
          std::span<T>& recorded = output < outputs ? recording.outputs[output] : recording.force;
          if constexpr (std::same_as<T, float>) {
            recorded = sound;
            rendered(recording);
          } else {
            std::vector<T> exact(samples);
            recorded = exact;
            rendered(recording);
            std::ranges::transform(exact, sound.begin(), [](T sample) { return static_cast<float>(sample); });
          }
          idle.put(std::move(instrument), rate);
        },
        [&](std::size_t done) {
          const py::gil_scoped_acquire locked;
          watch(done);
        },
        is_stopped);
  }

 private:
  [[nodiscard]] IdleInstruments<float>& idle_in(float) const { return idle_in_single_; }
  [[nodiscard]] IdleInstruments<double>& idle_in(double) const { return idle_in_double_; }

  InstrumentMaker maker_;
  std::unique_ptr<AnyInstrument<double>> shown_;
  mutable IdleInstruments<float> idle_in_single_;
  mutable IdleInstruments<double> idle_in_double_;
};

// The list of parameters, events, outputs or presets as dictionaries.
py::list parameters_of(const Source& source) {
  py::list rows;
  for (std::size_t i = 0; i < source.shown().parameters().size(); ++i) {
    const Parameter& p = source.shown().parameters()[i];
    const Label label = label_of(p.name);
    rows.append(py::dict(py::arg("name") = p.name, py::arg("title") = label.text, py::arg("unit") = p.unit,
                         py::arg("min") = p.allowed.min, py::arg("max") = p.allowed.max,
                         py::arg("slider") = py::make_tuple(p.slider.min, p.slider.max),
                         py::arg("initial") = source.shown().value(i),
                         py::arg("is_logarithmic") = p.scale == Scale::kLogarithmic,
                         py::arg("acts") = p.acts == Acts::kAtOnce ? "at once" : "at the next note"));
  }
  return rows;
}

py::list events_of(const Source& source) {
  py::list rows;
  for (const Event& e : source.shown().events())
    rows.append(py::dict(py::arg("name") = e.name, py::arg("kind") = event_kind(e.kind).verb,
                         py::arg("number") = e.number,
                         py::arg("parameter") = source.shown().parameters()[e.parameter].name));
  return rows;
}

py::list outputs_of(const Source& source) {
  py::list rows;
  for (const Output& o : source.shown().outputs())
    rows.append(py::dict(py::arg("name") = o.name, py::arg("unit") = o.unit, py::arg("full_scale") = o.full_scale));
  return rows;
}

py::dict presets_of(const Source& source) {
  py::dict presets;
  for (const Preset& preset : source.shown().presets()) presets[preset.name] = preset.values;
  return presets;
}

// What plays a MIDI file: one instrument with its channels, or several, each with what stands before its name.
using ByChannel = std::vector<std::pair<std::string, std::string>>;

Parts parts_of(const std::string& instrument, const ByChannel& by_channel, const std::vector<int>& channels) {
  if (by_channel.empty()) return {{{instrument, channels}}};
  if (!channels.empty())
    throw BadInput("--channel: stands beside the channels of --instrument; allowed: one of the two");
  return parts_by_channel(by_channel);
}

// The parts of a score that ships, of a file or of a text.
std::vector<PartSource> sources_of(const std::string& source, bool is_text, const Parts& parts,
                                   const Tuning& tuning) {
  if (!is_text) return read_parts(source, parts, tuning).list;
  if (parts.by_channel || !parts.list[0].instrument.empty() || !parts.list[0].channels.empty())
    refuse("score", "--instrument and --channel", "are for MIDI files", "without them");
  return {{"", {parse_score(source, "score", read_input, nullptr, tuning), {}}}};
}

// A score as `render` plays it: samples by channel, largest forces, and what the sound is.
py::tuple play_score(const std::string& source, bool is_text, double rate, bool is_single,
                     const std::string& instrument, const ByChannel& by_channel, const std::vector<int>& channels,
                     const std::string& scale, const std::string& keymap, std::optional<double> a4_hz) {
  Performance performance{rate, 1, {}, {}, 0, 0};
  std::string output, unit;
  std::optional<double> level_db;
  {
    const py::gil_scoped_release unlocked;
    const Tuning tuning = tuning_argument(scale, keymap, a4_hz);
    const std::vector<PartSource> parts =
        sources_of(source, is_text, parts_of(instrument, by_channel, channels), tuning);
    const auto options_of = [&](const Score& score) {
      PlayOptions options{rate};
      options.precision = precision_of(score, is_single ? Precision::kSingle : Precision::kDouble);
      options.oversampling = score.oversampling;
      if (score.ring_s > 0) options.max_ring_s = kLongestRing_s;
      choose_best_output(score, options);
      return options;
    };
    for (const PartSource& part : parts)
      performance.channels =
          std::max(performance.channels, channels_of(part.source.score, options_of(part.source.score), part.mix));
    level_db = parts[0].source.score.level_db;
    for (const auto& [name, read, mix] : parts) {
      const Score& score = read.score;
      const PlayOptions options = options_of(score);
      Performance part = play(score, options, [](double) { stop_on_signal(); });
      const Output chosen = sounding_output(score, options);
      output = options.is_on_body ? "body_velocity_m_per_s" : chosen.name;
      unit = options.is_on_body ? "m/s" : chosen.unit;
      if (parts.size() == 1 && mix.empty())
        performance = std::move(part);
      else
        add_part(performance, part, parts.size() > 1 ? full_scale_of(score, options) : 1, mix);
    }
    if (parts.size() > 1) output = "sum", unit = "";
  }
  const auto sides = static_cast<py::ssize_t>(performance.channels);
  py::array_t<float> samples({static_cast<py::ssize_t>(performance.samples.size()) / sides, sides});
  std::ranges::copy(performance.samples, samples.mutable_data());
  return py::make_tuple(
      samples, py::array_t<float>(static_cast<py::ssize_t>(performance.force_n.size()), performance.force_n.data()),
      performance.contacts, output, unit, level_db);
}

// Renders a plan, of a file or of a text, into HDF5 files. Returns the path of the one that was written last.
std::string dataset(const std::string& plan, bool is_text, const std::string& folder, std::size_t shards,
                    std::size_t only, int threads, bool force, const std::function<void(std::string)>& report) {
#ifdef CONTACTSPLINE_DATASETS
  DatasetOptions options;
  options.plan = is_text ? "plan" : plan;
  options.text = is_text ? plan : std::string();
  options.output = folder;
  options.shards = shards;
  options.only = only;
  options.threads = threads;
  options.force = force;
  options.report = [&](const std::string& line) {
    const py::gil_scoped_acquire locked;
    report(line);
  };
  options.watch = stop_on_signal;
  const py::gil_scoped_release unlocked;
  return make_dataset(options);
#else
  refuse("dataset", "HDF5", "is not part of this build", "a build with CONTACTSPLINE_BUILD_DATASETS=ON");
#endif
}

// A felt and a string, each a name, a path or the text of a file.
StruckString struck_string(const std::string& felt, bool felt_is_text, const std::string& string, bool string_is_text,
                           double rate) {
  Design design = design_of(felt, felt_is_text);
  const py::gil_scoped_release unlocked;
  auto resonator = string_is_text ? std::optional(parse_resonator(string, "string")) : resonator_argument(string);
  if (!resonator) refuse(string, "string", "is no resonator", "the name or the file of a string, such as string_c4");
  return {std::move(design), std::move(*resonator), rate};
}

std::span<const double> span_of(const Array<double>& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

std::span<double> writable_span_of(py::array_t<double>& values) {
  return {values.mutable_data(), static_cast<std::size_t>(values.size())};
}

py::tuple play_struck(const StruckString& struck, const Array<double>& values, py::ssize_t samples) {
  py::array_t<double> displacement(samples), force(samples);
  const auto all = span_of(values);
  const auto d = writable_span_of(displacement), f = writable_span_of(force);
  {
    const py::gil_scoped_release unlocked;
    struck.play(all, d, f, stop_on_signal);
  }
  return py::make_tuple(displacement, force);
}

py::tuple tangents_of_struck(const StruckString& struck, const Array<double>& values,
                             const std::vector<std::size_t>& numbers, py::ssize_t samples) {
  const auto rows = static_cast<py::ssize_t>(numbers.size());
  py::array_t<double> displacements({rows, samples}), forces({rows, samples});
  const auto all = span_of(values);
  const auto d = writable_span_of(displacements), f = writable_span_of(forces);
  {
    const py::gil_scoped_release unlocked;
    struck.tangents(all, numbers, d, f, stop_on_signal);
  }
  return py::make_tuple(displacements, forces);
}

std::vector<double> gradient_of_struck(const StruckString& struck, const Array<double>& values,
                                       const Array<double>& displacement_weights,
                                       const Array<double>& force_weights) {
  const auto all = span_of(values), of_displacement = span_of(displacement_weights),
             of_force = span_of(force_weights);
  const py::gil_scoped_release unlocked;
  return struck.gradient(all, of_displacement, of_force);
}

py::list parameters_of_struck(const StruckString& struck) {
  py::list rows;
  for (const auto& [name, unit, initial, min, max] : struck.parameters())
    rows.append(py::dict(py::arg("name") = name, py::arg("unit") = unit, py::arg("initial") = initial,
                         py::arg("min") = min, py::arg("max") = max));
  return rows;
}

// Fits a material. Returns its numbers as JSON, its material file and the report. folder: of the data.
py::tuple fit_of(const std::string& source, bool is_text, const std::string& folder,
                 const std::function<void(std::string)>& tell) {
  const py::gil_scoped_release unlocked;
  const std::filesystem::path file = source;
  const std::string name = is_text ? "fit" : source;
  const std::filesystem::path beside = is_text ? std::filesystem::path(folder) : file.parent_path();
  const Measurements measured = parse_measurements(
      is_text ? source : read_input(file), name, [&](const std::string& path) { return read_input(beside / path); });
  const Fit found = fit_material(measured, name, [&](const std::string& line) {
    const py::gil_scoped_acquire locked;
    tell(line);
    stop_on_signal();
  });
  const std::string json = json_of(found, measured), material = material_text(found, measured, mark()),
                    report = report_of(found, measured);
  const py::gil_scoped_acquire locked;
  return py::make_tuple(json, material, report);
}

void bind_struck_string(py::module_& m) {
  py::class_<StruckString>(m, "StruckString", "A strike as a function of its parameters.")
      .def(py::init(&struck_string))
      .def("parameters", &parameters_of_struck)
      .def("play", &play_struck)
      .def("tangents", &tangents_of_struck)
      .def("gradient", &gradient_of_struck);
  m.def("fit", &fit_of);
}

void bind_design(py::module_& m) {
  py::class_<Design>(m, "Design", "A material with its spline.")
      .def_property_readonly("name", [](const Design& d) { return d.material.name; })
      .def_property_readonly("description", [](const Design& d) { return d.material.description; })
      .def_property_readonly("law", [](const Design& d) { return law_text(d.material); })
      .def_property_readonly("loss_s_per_m", [](const Design& d) { return d.material.loss_s_per_m; })
      .def_property_readonly("end_m", [](const Design& d) { return d.spline.end_m; })
      .def_property_readonly("json", [](const Design& d) { return json_of(d); })
      .def_property_readonly("speeds",
                             [](const Design& d) -> std::optional<std::pair<double, double>> {
                               if (!d.material.impact) return std::nullopt;
                               return std::pair(d.material.impact->min_speed_m_per_s,
                                                d.material.impact->max_speed_m_per_s);
                             })
      .def("mass_kg", &mass_of)
      .def("knots", [](const Design& d) { return members(d, &Segment<double>::knot); })
      .def("energies", [](const Design& d) { return members(d, &Segment<double>::energy); })
      .def("forces", [](const Design& d) { return members(d, &Segment<double>::force); })
      .def("half_curvatures", [](const Design& d) { return members(d, &Segment<double>::half_curvature); })
      .def("spline_force",
           [](const Design& d, const Array<double>& y) {
             const auto table = segment_table(d.spline);
             return each(y, [&](double at) { return force<double>(std::span(table), at); });
           })
      .def("spline_potential",
           [](const Design& d, const Array<double>& y) {
             const auto table = segment_table(d.spline);
             return each(y, [&](double at) { return potential<double>(std::span(table), at); });
           })
      .def("exact_force",
           [](const Design& d, const Array<double>& y) {
             return each(y, [&](double at) { return at > 0 ? d.material.contact.force(at) : 0; });
           })
      .def("impacts", &impacts_of);
  m.def("design", &design_of);
  m.def("design_many", &design_many);
}

void bind_instrument(py::module_& m) {
  py::class_<Source>(m, "Source", "What an instrument is made of.")
      .def(py::init<const std::string&, bool, const std::string&>())
      .def_property_readonly("name", [](const Source& s) { return s.shown().name(); })
      .def_property_readonly("description", [](const Source& s) { return s.shown().description(); })
      .def_property_readonly("license", [](const Source& s) { return s.shown().license(); })
      .def("parameters", &parameters_of)
      .def("events", &events_of)
      .def("outputs", &outputs_of)
      .def("presets", &presets_of)
      .def("play_single", &Source::play<float>)
      .def("play_double", &Source::play<double>)
      .def_static("latency", &Source::latency)
      .def("play_many_single", &Source::play_many<float>)
      .def("play_many_double", &Source::play_many<double>);
  m.def("play_score", &play_score);
  m.def("read_tuning", &read_tuning, py::call_guard<py::gil_scoped_release>());
  m.def("dataset", &dataset);
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  m.doc() = "The compiled part of contactspline.";
  m.attr("__version__") = CONTACTSPLINE_VERSION;
  py::register_exception<BadInput>(m, "Error", PyExc_ValueError);
  bind_design(m);
  bind_instrument(m);
  bind_struck_string(m);
  m.def("resonator", &resonator_json, py::call_guard<py::gil_scoped_release>());
  m.def("keyboard", &keyboard_json, py::call_guard<py::gil_scoped_release>());
  m.attr("oversamplings") =
      py::tuple(py::cast(std::vector<int>(std::begin(kOversamplings), std::end(kOversamplings))));
  m.attr("sample_rates_hz") = py::make_tuple(kSampleRates_hz.min, kSampleRates_hz.max);
  py::dict actions;
  for (const auto& [name, action] : {std::pair("strike", Action::kStrike),
                                     {"release", Action::kRelease},
                                     {"pluck", Action::kPluck},
                                     {"note_on", Action::kNoteOn},
                                     {"note_off", Action::kNoteOff},
                                     {"set", Action::kSet},
                                     {"bow", Action::kBow}})
    actions[name] = static_cast<int>(action);
  m.attr("actions") = actions;
  py::dict shipped;
  for (const Shipped folder : {Shipped::kMaterials, Shipped::kFrictions, Shipped::kResonators, Shipped::kKeyboards,
                               Shipped::kInstruments, Shipped::kScores})
    shipped[py::str(std::string(kind_name(folder)) + "s")] = shipped_names(folder);
  m.attr("shipped") = shipped;
}

}  // namespace contactspline::python
