// SPDX-License-Identifier: MIT
#include "generator/listen/note_renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <thread>

#include "contactspline/host/any_instrument.hpp"
#include "generator/player/instrument_maker.hpp"
#include "generator/player/playing.hpp"
#include "generator/support/error.hpp"
#include "generator/support/task_pool.hpp"

namespace contactspline {
namespace {

constexpr double kDepth_db = 80;
constexpr std::size_t kMaxPartials = 60;
constexpr double kWaits_s[] = {0.1, 0.5, 2.5};  // until what strikes is there

// Both sides where no output is named. Outputs have that name, or its beginning as `render --signal` takes it.
Sides heard_outputs(const AnyInstrument<double>& instrument, const RecordedInstrument& recorded) {
  if (recorded.output.empty()) return sides_of(instrument.outputs(), 0);
  std::string names;
  for (std::size_t i = 0; i < instrument.outputs().size(); ++i) {
    const std::string name = instrument.outputs()[i].name;
    if (name == recorded.output || name.starts_with(recorded.output + "_")) return {i, i};
    names += (i > 0 ? ", " : "") + name;
  }
  refuse(recorded.file, "outputs", fmt::format("'{}' is none of them", shown(recorded.output)), names);
}

// What plays with these numbers in the text: of a keyboard one key, else all.
struct Played {
  std::vector<double> point;
  int key = 0;
  auto operator<=>(const Played&) const = default;
};

Played played_by(const RecordedInstrument& recorded, const NoteToRender& note) {
  return {note.point, recorded.is_keyboard ? recorded.notes[note.note].key : 0};
}

InstrumentMaker maker_of(const RecordedInstrument& recorded, const ReadFile& read, DesignedMaterials& materials,
                         const Played& played) {
  const std::span<const OpenNumber> open = std::span(recorded.open).first(recorded.open_in_text);
  const std::string text = filled(recorded.text, open, played.point);
  if (recorded.is_keyboard) return maker_of_key(text, recorded.file, read, played.key);
  return maker_of_text(text, recorded.file, read, materials);
}

// That of the recording; where there are contacts, whose error falls to a quarter when the rate doubles, times a
// power of two, by which windows stay the same.
double rendered_rate_hz(const RecordedInstrument& recorded, const RecordedNote& note) {
  constexpr double kLeast_hz = 88000;
  double rate_hz = note.recording.sample_rate_hz;
  while (recorded.has_contacts && rate_hz < kLeast_hz) rate_hz *= 2;
  return rate_hz;
}

// The mean of both sides, as of recordings.
std::vector<double> samples_of(const InstrumentMaker& maker, const RecordedInstrument& recorded,
                               const RecordedNote& note, double velocity, double length_s) {
  const double rate_hz = rendered_rate_hz(recorded, note);
  const auto instrument = maker.make<double>(rate_hz);
  instrument->prepare(rate_hz);
  if (!instrument->has_key(note.key))
    refuse(recorded.file, "keys", fmt::format("key {} of {} plays nothing", note.key, note.file),
           "a key that `contactspline inspect` lists");
  const TimedEvent event{0, Action::kNoteOn, static_cast<std::size_t>(note.key), velocity, 0};
  std::vector<double> samples(static_cast<std::size_t>(length_s * rate_hz)), on_right(samples.size());
  const auto [left, right] = heard_outputs(*instrument, recorded);
  Recording<double> into;
  into.outputs.resize(instrument->outputs().size());
  into.outputs[right] = on_right;
  into.outputs[left] = samples;
  render<double>(*instrument, std::span(&event, 1), samples.size(), into, [] {});
  if (left == right) return samples;
  std::ranges::transform(samples, on_right, samples.begin(), [](double l, double r) { return (l + r) / 2; });
  return samples;
}

// Waits until the note begins.
NoteImpression play(const InstrumentMaker& maker, const RecordedInstrument& recorded, const RecordedNote& note,
                    const std::vector<double>& point) {
  const double recorded_hz = note.recording.sample_rate_hz, rate_hz = rendered_rate_hz(recorded, note);
  const double velocity = note.open_velocity ? point[*note.open_velocity] : note.velocity;
  const double recorded_s = static_cast<double>(note.recording.samples.size()) / recorded_hz;
  const double seconds = std::min(recorded.seconds, recorded_s);
  for (const double wait_s : kWaits_s) {
    const std::vector<double> samples = samples_of(maker, recorded, note, velocity, wait_s + seconds);
    const bool sounds = std::ranges::any_of(samples, [](double sample) { return sample != 0; });
    if (sounds && onset_of(samples, rate_hz) <= wait_s)
      return impression_of({samples, rate_hz, recorded_hz}, seconds, kDepth_db, kMaxPartials);
  }
  refuse(recorded.file, "outputs", fmt::format("key {} of {} is silent for {} s", note.key, note.file, kWaits_s[2]),
         "an output that sounds, a shorter way to it");
}

void run_on_all_cores(std::size_t tasks, const std::function<void(std::size_t)>& task) {
  std::atomic<bool> is_stopped = false;
  run_tasks(
      tasks, std::max(1u, std::thread::hardware_concurrency()), task, [](std::size_t) {}, is_stopped);
}

}  // namespace

NoteRenderer::NoteRenderer(const RecordedInstrument& recorded, const ReadFile& read)
    : recorded_(recorded),
      read_([&](const std::string& path) {
        return read((std::filesystem::path(recorded.file).parent_path() / path).string());
      }),
      materials_(std::make_unique<DesignedMaterials>(read_)) {}

std::vector<std::optional<NoteImpression>> NoteRenderer::render(std::span<const NoteToRender> notes) const {
  std::map<Played, std::optional<InstrumentMaker>> makers;
  for (const NoteToRender& note : notes) makers.try_emplace(played_by(recorded_, note));
  std::vector<decltype(makers)::iterator> to_make;
  for (auto at = makers.begin(); at != makers.end(); ++at) to_make.push_back(at);
  run_on_all_cores(to_make.size(), [&](std::size_t i) {
    try {
      to_make[i]->second = maker_of(recorded_, read_, *materials_, to_make[i]->first);
    } catch (const BadInput&) {
    }
  });
  std::vector<std::optional<NoteImpression>> impressions(notes.size());
  run_on_all_cores(notes.size(), [&](std::size_t i) {
    const auto& maker = makers.at(played_by(recorded_, notes[i]));
    if (!maker) return;
    try {
      impressions[i] = play(*maker, recorded_, recorded_.notes[notes[i].note], notes[i].point);
    } catch (const BadInput&) {
    } catch (const NotFinite&) {
    }
  });
  return impressions;
}

std::vector<RenderedNotes> NoteRenderer::render(std::span<const std::vector<double>> points,
                                                std::span<const std::size_t> notes) const {
  std::vector<NoteToRender> all;
  for (const std::vector<double>& point : points)
    for (const std::size_t note : notes) all.push_back({note, point});
  std::vector<std::optional<NoteImpression>> impressions = render(all);
  std::vector<RenderedNotes> rendered(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto of_point = std::span(impressions).subspan(p * notes.size(), notes.size());
    if (!std::ranges::all_of(of_point, [](const auto& impression) { return impression.has_value(); })) continue;
    rendered[p].emplace();
    for (auto& impression : of_point) rendered[p]->push_back(std::move(*impression));
  }
  return rendered;
}

std::vector<NoteImpression> NoteRenderer::render_one(const std::vector<double>& point,
                                                     std::span<const std::size_t> notes) const {
  std::vector<NoteImpression> impressions(notes.size());
  run_on_all_cores(notes.size(), [&](std::size_t i) {
    const InstrumentMaker maker = maker_of(recorded_, read_, *materials_, played_by(recorded_, {notes[i], point}));
    impressions[i] = play(maker, recorded_, recorded_.notes[notes[i]], point);
  });
  return impressions;
}

}  // namespace contactspline
