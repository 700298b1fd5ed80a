// SPDX-License-Identifier: MIT
// The generator in the page: the text of a material in, its emitted files and its spline out.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "generator/cli/instrument_page.hpp"
#include "generator/emit/emit_material.hpp"
#include "generator/fit/data_table.hpp"
#include "generator/fit/fit.hpp"
#include "generator/fit/fit_panels.hpp"
#include "generator/fit/fitted_material.hpp"
#include "generator/fit/measurements_reader.hpp"
#include "generator/instrument/diagram.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/material_reader.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/player/tuning.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "hosts/wasm/door.hpp"
#include "hosts/wasm/draw_instrument.hpp"
#include "hosts/wasm/packed_instrument.hpp"

namespace contactspline::web {
namespace {

using Json = nlohmann::ordered_json;

std::map<std::string, std::string> files;  // what the page was given, by name

Bytes instrument_bytes;  // of the last instrument, and what is drawn of it
Bytes packed_bytes;      // of the last instrument that ships

std::string read_file(const std::string& path) {
  const auto given = files.find(path);
  return given == files.end() ? shipped_file(path) : given->second;
}

// The command that the emitted files quote is the one that `contactspline generate NAME.json` quotes.
Json emitted_files(const Design& design) {
  Json files = Json::object();
  const std::string& name = design.material.name;
  for (const Emitter& emitter : emitters()) {
    const std::string command = "contactspline generate " + name + ".json --emit " + std::string(emitter.name);
    files[name + "." + std::string(emitter.extension)] = emit(emitter, design, command);
  }
  return files;
}

Json table_of(const Spline& spline) {
  Json table = Json::array();
  for (const Segment<double>& s : spline.segments) table.push_back({s.knot, s.energy, s.force, s.half_curvature});
  return table;
}

// Force of the exact law and of the spline at points of equal distance over the design range.
Json curve_of(const Design& design) {
  constexpr int kPoints = 480;
  const auto table = segment_table(design.spline);
  Json y = Json::array(), law = Json::array(), spline = Json::array();
  for (int i = 0; i <= kPoints; ++i) {
    const double at = design.spline.end_m * i / kPoints;
    y.push_back(at);
    law.push_back(design.material.contact.force(at));
    spline.push_back(force(SegmentTable<double>(table), at));
  }
  return {{"compression_m", y}, {"law_n", law}, {"spline_n", spline}};
}

Json memory_of(const Material& material) {
  Json memories = Json::array();
  for (const Memory& memory : material.memories) memories.push_back({memory.weight, memory.time_s});
  return memories;
}

Json quality_of(const Design& design) {
  const Quality& quality = design.quality;
  Json result = {{"force", quality.force.worst}, {"energy", quality.energy.worst}};
  if (quality.impact) result["contact_duration"] = quality.impact->contact_duration;
  if (quality.impact) result["max_compression"] = quality.impact->max_compression;
  if (design.spectrum) result["spectrum_db"] = design.spectrum->mean_db;
  return result;
}

Json described(const Design& design) {
  const Material& material = design.material;
  Json result = {{"name", material.name},          {"title", title_of(material)},
                 {"law", law_text(material)},      {"loss_s_per_m", material.loss_s_per_m},
                 {"files", emitted_files(design)}, {"table", table_of(design.spline)},
                 {"memory", memory_of(material)},  {"curve", curve_of(design)},
                 {"quality", quality_of(design)}};
  if (material.impact) result["mass_kg"] = material.impact->mass_kg;
  return result;
}

// Lines, dots and labels in points of the screen from the upper left corner.
Json drawing_of(const InstrumentModel& model, double width) {
  constexpr double kRow = 96;
  const double rows = static_cast<double>(model.bodies.size()) + 0.4;
  const DiagramSize size{width, kRow * std::max(rows, 2.4)};
  const Diagram diagram = diagram_of(model, size);
  const auto on_screen = [&](DiagramPoint at) {
    return Json{size.width * at.x, size.height * (diagram.top - at.y) / (diagram.top - diagram.bottom)};
  };
  Json lines = Json::array(), dots = Json::array(), labels = Json::array();
  for (const auto& [from, to, part] : diagram.lines)
    lines.push_back({{"from", on_screen(from)}, {"to", on_screen(to)}, {"part", name_of(part)}});
  for (const auto& [at, is_mass] : diagram.dots) dots.push_back({{"at", on_screen(at)}, {"isMass", is_mass}});
  for (const auto& [at, text, part] : diagram.labels)
    labels.push_back({{"at", on_screen(at)}, {"text", text}, {"part", name_of(part)}});
  return {{"width", size.width}, {"height", size.height}, {"lines", lines}, {"dots", dots}, {"labels", labels}};
}

// The key of a fit file that a data file belongs to, by what it is over.
const char* key_for(const std::string& file) {
  constexpr std::array kWanted = {Quantity::kTime, Quantity::kCompression, Quantity::kSpeed};
  const DataTable table = read_table(read_file(file), file, kWanted, {});
  if (table.has(Quantity::kTime)) return "pulses";
  if (table.has(Quantity::kCompression)) return "curves";
  if (table.has(Quantity::kSpeed)) return "tables";
  refuse(file, "columns", "none holds a time, a speed or a compression",
         "force over time, contact times over speed_m_per_s, or force over compression; with units, as in time_ms");
}

// Data and model of each kind as rows by rising place; pulses stand one after another.
Json panels_of(const Fit& fit) {
  Json panels = Json::array();
  for (const PanelOfFit& panel : kFitPanels) {
    std::vector<std::array<double, 3>> rows;
    double end = 0;
    for (const FitQuality& quality : fit.qualities) {
      if (quality.quantity != panel.quantity) continue;
      const double begin = panel.from_begin ? end - quality.at.front() : 0;
      for (std::size_t i = 0; i < quality.at.size(); ++i)
        rows.push_back({panel.at_scale * (begin + quality.at[i]), panel.value_scale * quality.measured[i],
                        panel.value_scale * quality.modelled[i]});
      end = begin + quality.at.back();
    }
    if (rows.empty()) continue;
    std::ranges::stable_sort(rows, {}, [](const auto& row) { return row[0]; });
    Json columns = Json::array({Json::array(), Json::array(), Json::array()});
    for (const auto& row : rows)
      for (std::size_t i = 0; i < row.size(); ++i) columns[i].push_back(row[i]);
    panels.push_back({{"quantity", panel.quantity},
                      {"at", panel.at},
                      {"value", panel.value},
                      {"isLine", panel.from_begin || panel.is_relative},
                      {"columns", columns}});
  }
  return panels;
}

// What make() returns as JSON, or {"error": one line} for bad input.
template <typename Make>
const char* answer(const Make& make) {
  try {
    return keep(make().dump());
  } catch (const std::exception& error) {
    return keep(Json{{"error", error.what()}}.dump());
  }
}

// Keeps what make() packs of an instrument that ships. Returns JSON: {"size"}, or {"error": one line}.
template <typename Make>
const char* pack(const char* name, const Make& make) {
  return answer([&] {
    const EmbeddedFile* const found = find_embedded(Shipped::kInstruments, std::string(name) + ".json");
    if (found == nullptr)
      refuse(name, "instrument", "no such instrument ships",
             fmt::format("{}", fmt::join(shipped_names(Shipped::kInstruments), ", ")));
    packed_bytes = make(parse_instrument(std::string(found->content), std::string(found->name), read_file));
    return Json{{"size", packed_bytes.size()}};
  });
}

// The files of a kind that ship, as a JSON object: text by name.
const char* texts_of(Shipped kind) {
  Json texts = Json::object();
  for (const std::string& name : shipped_names(kind))
    texts[name] = std::string(find_embedded(kind, name + ".json")->content);
  return keep(texts.dump());
}

}  // namespace

/// Writes a fit file for data files that the page was given, a name a line, of impacts of this mass. Returns JSON:
/// {"text"}, or {"error": one line}. The page frees `names`.
CONTACTSPLINE_WEB(const char*, contactspline_fit_file, const char* names, double mass_kg) {
  return answer([&] {
    Json fit = {{"name", "fitted"}, {"mass_kg", mass_kg}};
    std::istringstream lines{names};
    for (std::string name; std::getline(lines, name);) fit[key_for(name)].push_back({{"file", name}});
    return Json{{"text", fit.dump(2) + "\n"}};
  });
}

/// Fits a material to the data that a fit file names. Returns JSON: the text of its file, the report that
/// `contactspline fit` prints, and data with model for figures; or {"error": one line}. The page frees `text`.
CONTACTSPLINE_WEB(const char*, contactspline_fit, const char* text, const char* file) {
  return answer([&] {
    const Measurements measured = parse_measurements(text, file, read_file);
    const Fit fit = fit_material(measured, file, [](const std::string& /*what*/) {});
    return Json{{"material", material_text(fit, measured, "Written by contactspline " CONTACTSPLINE_VERSION)},
                {"report", report_of(fit, measured)},
                {"panels", panels_of(fit)}};
  });
}

/// Designs the material of this text. Returns JSON: the emitted files by name, the table, the curve and the errors;
/// or {"error": one line} for bad input. The page frees `text`.
CONTACTSPLINE_WEB(const char*, contactspline_generate, const char* text, const char* file) {
  return answer([&] { return described(design_material(text, file, read_file)); });
}

/// Reads the text of an instrument file. Returns JSON: name, title, table of its parts, as `inspect` prints it, and
/// its drawing so many points of the screen wide; or {"error": one line} for bad input. The page frees `text`.
CONTACTSPLINE_WEB(const char*, contactspline_instrument, const char* text, const char* file, double width,
                  double sample_rate_hz) {
  return answer([&] {
    const InstrumentModel model = parse_instrument(text, file, read_file);
    if (const auto body = silent_body(model, sample_rate_hz / 2))
      refuse(file, *body, fmt::format("has no mode below {} Hz", sample_rate_hz / 2), "a body that moves below it");
    instrument_bytes = packed(arrays_of(model, sample_rate_hz / 2).view());
    std::ranges::copy(packed_drawing(model, sample_rate_hz / 2), std::back_inserter(instrument_bytes));
    return Json{{"name", model.name},
                {"title", title_of(model)},
                {"parts", instrument_table(model, sample_rate_hz)},
                {"drawing", drawing_of(model, width)}};
  });
}

/// The arrays of the last instrument that was read, for the modules that play and draw it.
CONTACTSPLINE_WEB(const std::byte*, contactspline_instrument_bytes) {
  return instrument_bytes.data();
}
CONTACTSPLINE_WEB(int, contactspline_instrument_size) {
  return static_cast<int>(instrument_bytes.size());
}

/// Packs what is drawn of an instrument that ships, with its modes below half of a sample rate; then
/// contactspline_packed() says where. Returns JSON: {"size"} in bytes, or {"error": one line}. The page frees `name`.
CONTACTSPLINE_WEB(const char*, contactspline_drawn, const char* name, double sample_rate_hz) {
  return pack(name, [&](const InstrumentModel& model) { return packed_drawing(model, sample_rate_hz / 2); });
}

/// Packs an instrument that ships, its strings tuned by -1200 to 1200 cents, likewise.
CONTACTSPLINE_WEB(const char*, contactspline_tuned, const char* name, double cents, double sample_rate_hz) {
  return pack(name, [&](InstrumentModel model) {
    if (!(std::abs(cents) <= 1200))
      refuse(name, "tuning_cents", fmt::format("{} is out of range", cents), "-1200 to 1200, such as 700");
    tune(model, cents);
    return packed(arrays_of(model, sample_rate_hz / 2).view());
  });
}
CONTACTSPLINE_WEB(const std::byte*, contactspline_packed) {
  return packed_bytes.data();
}

/// Reads so many bytes of a MIDI file. chosen: a bit for each channel, the lowest for channel 1; none: as `render`
/// chooses them. Returns JSON: title, remarks, end [s] and what is played: channels, each with its number, the
/// program of its first note (1 to 128) and its notes, and messages, each as its time [s] and its bytes, the last of
/// which let all keys go; unchosen: notes of other channels; or {"error": one line}. The page frees `bytes` and
/// `file`.
CONTACTSPLINE_WEB(const char*, contactspline_midi, const char* bytes, std::size_t size, const char* file,
                  int chosen) {
  return answer([&] {
    std::vector<int> wanted;
    for (int channel = 1; channel <= 16; ++channel)
      if ((chosen >> (channel - 1) & 1) != 0) wanted.push_back(channel);
    const auto [played, notes, unchosen] = read_played_midi({bytes, size}, file, wanted);
    Json channels = Json::array();
    for (const auto& [channel, use] : midi_uses(played.messages))
      channels.push_back(Json{{"channel", channel}, {"program", use.program + 1}, {"notes", use.notes}});
    Json messages = Json::array();
    for (const auto& [time_s, message] : played.messages) {
      messages.push_back(Json::array({time_s}));
      for (const int byte : message) messages.back().push_back(byte);
    }
    return Json{{"title", played.title}, {"remarks", played.remarks}, {"end", played.end_s},
                {"channels", channels},  {"unchosen", unchosen},      {"messages", messages}};
  });
}

/// Reads the texts of a scale and a key map of Scala, each of which may be empty, with a pitch of A4 [Hz]; 0: that of
/// the key map, or 440. Returns JSON: {"cents"} of the 128 keys of MIDI, null for a key that does not sound; or
/// {"error": one line}. The page frees the texts.
CONTACTSPLINE_WEB(const char*, contactspline_tuning, const char* scale, const char* keymap, double a4_hz) {
  return answer([&] {
    const auto text = [](const char* of, const char* name) {
      return *of == '\0' ? std::nullopt : std::optional(TuningText{of, name});
    };
    Tuning tuning{text(scale, "scale"), text(keymap, "keymap")};
    if (a4_hz != 0) tuning.a4_hz = a4_hz;
    return Json{{"cents", key_cents(tuning)}};
  });
}

/// The instrument files that ship, as a JSON object: text by name.
CONTACTSPLINE_WEB(const char*, contactspline_instruments) {
  return texts_of(Shipped::kInstruments);
}

/// Takes a file that materials, instruments and fits may name: a measured curve, a material, data of impacts.
CONTACTSPLINE_WEB(void, contactspline_take_file, const char* name, const char* text) {
  files[name] = text;
}

/// The material files that ship, as a JSON object: text by name.
CONTACTSPLINE_WEB(const char*, contactspline_materials) {
  return texts_of(Shipped::kMaterials);
}

CONTACTSPLINE_WEB(void*, contactspline_allocate, std::size_t bytes) {
  return std::malloc(bytes);
}

CONTACTSPLINE_WEB(void, contactspline_free, void* memory) {
  std::free(memory);
}

}  // namespace contactspline::web
