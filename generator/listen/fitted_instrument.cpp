// SPDX-License-Identifier: MIT
#include "generator/listen/fitted_instrument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

constexpr int kDigits = 6;

// Two more than the interval has zeros between its half width and the number, so that it shows.
int digits_of(const FoundNumber& number) {
  const double width = (number.high - number.low) / 2, size = std::max(std::abs(number.low), std::abs(number.high));
  if (!(width > 0)) return kDigits;
  return std::clamp(2 + static_cast<int>(std::floor(std::log10(size)) - std::floor(std::log10(width))), 4, 12);
}

std::string words_of(const FoundNumber& number, bool is_explained) {
  if (number.is_at_bound) return "; at its bound: wider bounds may fit better";
  if (!number.is_told) return "; the recordings do not tell it";
  return fmt::format("; {3} {0:.{2}g} to {1:.{2}g}", number.low, number.high, digits_of(number),
                     is_explained ? "95 % interval" : "doubtful:");
}

std::string json_of(const NoteDistance& distance) {
  return fmt::format(R"({{ "level_db": {}, "noise_db": {}, "cents": {} }})", distance.level_db, distance.noise_db,
                     distance.cents);
}

}  // namespace

std::string report_of(const InstrumentFit& fit, const RecordedInstrument& recorded) {
  std::string text;
  for (std::size_t i = 0; i < fit.numbers.size(); ++i)
    text += fmt::format("  {:<44} {:.{}g}{}\n", recorded.open[i].key, fit.numbers[i].value, digits_of(fit.numbers[i]),
                        words_of(fit.numbers[i], fit.is_explained));
  if (!fit.is_explained)
    text += "The intervals are doubtful: they hold if the instrument explains the notes, and it does not.\n";
  text += "distance before and after, of levels by band and time, beside what noise alone leaves; of partials\n";
  for (std::size_t n = 0; n < fit.notes.size(); ++n) {
    const auto& [before, after] = std::tie(fit.notes[n].before, fit.notes[n].after);
    text += fmt::format("  {:<36} {:<7} {:>6.2f} {:>6.2f} dB ({:.2f}) {:>7.1f} {:>6.1f} cents\n",
                        shown(recorded.notes[n].file), recorded.notes[n].is_kept ? "kept" : "fitted", before.level_db,
                        after.level_db, after.noise_db, before.cents, after.cents);
  }
  for (const std::string& doubt : fit.doubts) text += "  " + doubt + "\n";
  return text;
}

std::string json_of(const InstrumentFit& fit, const RecordedInstrument& recorded) {
  std::vector<std::string> numbers, notes, doubts;
  for (const std::string& doubt : fit.doubts) doubts.push_back(json_string(doubt));
  for (std::size_t i = 0; i < fit.numbers.size(); ++i)
    numbers.push_back(
        fmt::format(R"(    {}: {{ "value": {}, "low": {}, "high": {}, "at_bound": {}, "told": {}, "doubtful": {} }})",
                    json_string(recorded.open[i].key), fit.numbers[i].value, fit.numbers[i].low, fit.numbers[i].high,
                    fit.numbers[i].is_at_bound, fit.numbers[i].is_told, !fit.is_explained));
  for (std::size_t n = 0; n < fit.notes.size(); ++n)
    notes.push_back(fmt::format(R"(    {{ "file": {}, "kept": {}, "before": {}, "after": {} }})",
                                json_string(recorded.notes[n].file), recorded.notes[n].is_kept,
                                json_of(fit.notes[n].before), json_of(fit.notes[n].after)));
  return fmt::format("{{\n  \"estimates\": {{\n{}\n  }},\n  \"recordings\": [\n{}\n  ],\n  \"doubts\": [{}]\n}}\n",
                     fmt::join(numbers, ",\n"), fmt::join(notes, ",\n"), fmt::join(doubts, ", "));
}

std::string instrument_text(const InstrumentFit& fit, const RecordedInstrument& recorded, std::string_view mark) {
  std::string text = fmt::format("// {}: fitted to recordings.\n// ", mark), report = report_of(fit, recorded);
  report.pop_back();
  for (const char c : report) text += c == '\n' ? "\n// " : std::string(1, c);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < recorded.open_in_text; ++i)
    numbers.push_back(rounded_to(fit.numbers[i].value, std::max(kDigits, digits_of(fit.numbers[i]))));
  return text + "\n" + filled(recorded.text, std::span(recorded.open).first(recorded.open_in_text), numbers);
}

}  // namespace contactspline
