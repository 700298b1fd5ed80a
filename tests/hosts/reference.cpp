// SPDX-License-Identifier: MIT
// reference single|double INSTRUMENT RATE: plays the commands of its input on an instrument's class, without the
// library for C: set NAME VALUE, note KEY VELOCITY, play EVENT [VALUE], process SAMPLES. Writes each sample as its
// outputs, in their units and in the precision of the class, and the contact force. "lists" instead of commands:
// parameters, events and outputs, one in a line.
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "contactspline/data/pluck.hpp"
#include "contactspline/step/flush_denormals.hpp"
#include "hosts/named_instruments.hpp"

namespace contactspline {
namespace {

template <typename List>
std::size_t index_of(const List& list, const std::string& name) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (name == list[i].name) return i;
  throw std::runtime_error(name);
}

constexpr std::size_t kBlock = 64;  // samples, as in the hosts: rounding of vectors depends on it

template <typename T>
void process(AnyInstrument<T>& instrument, std::size_t samples) {
  if (samples > kBlock) {
    process(instrument, kBlock);
    return process(instrument, samples - kBlock);
  }
  const FlushDenormals flushed;
  const std::size_t count = instrument.outputs().size();
  std::vector<std::vector<T>> sound(count + 1, std::vector<T>(samples));
  std::vector<std::span<T>> spans(sound.begin(), sound.end() - 1);
  instrument.process(spans, sound.back());
  for (std::size_t n = 0; n < samples; ++n)
    for (const auto& output : sound) std::fwrite(&output[n], sizeof(T), 1, stdout);
}

template <typename T>
void play(AnyInstrument<T>& instrument, const Event& event, double value) {
  instrument.play({0, action_of(event.kind), event.number, value, kPluckRise_s});
}

template <typename T>
void list(const AnyInstrument<T>& instrument) {
  for (const Parameter& p : instrument.parameters())
    std::printf("parameter %s %.17g %.17g %.17g\n", p.name, p.slider.min, p.slider.max, p.initial);
  for (const Event& e : instrument.events())
    std::printf("event %s %s\n", e.name, instrument.parameters()[e.parameter].name);
  for (const Output& o : instrument.outputs()) std::printf("output %s %.17g\n", o.name, o.full_scale);
}

template <typename T>
void run(const std::string& name, double rate_hz) {
  const auto instrument = maker_of_name(name).make<T>(rate_hz);
  instrument->prepare(rate_hz);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string command, what;
    double value = 0, second = 0;
    words >> command;
    if (command == "lists") {
      list(*instrument);
    } else if (command == "process") {
      words >> value;
      process(*instrument, static_cast<std::size_t>(value));
    } else if (command == "note") {
      words >> value >> second;
      second > 0 ? instrument->note_on(static_cast<int>(value), second)
                 : instrument->note_off(static_cast<int>(value));
    } else if (words >> what; command == "set") {
      words >> value;
      instrument->set(index_of(instrument->parameters(), what), value);
    } else {
      const Event& event = instrument->events()[index_of(instrument->events(), what)];
      play(*instrument, event, words >> value ? value : instrument->value(event.parameter));
    }
  }
}

}  // namespace
}  // namespace contactspline

int main(int count, char** arguments) {
  if (count == 2)
    for (const std::string& name : contactspline::instrument_names()) std::printf("%s\n", name.c_str());
  if (count != 4) return count == 2 ? 0 : 2;
  const std::string precision = arguments[1];
  (precision == "single" ? contactspline::run<float> : contactspline::run<double>)(arguments[2],
                                                                                   std::stod(arguments[3]));
}
