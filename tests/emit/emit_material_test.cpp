// SPDX-License-Identifier: MIT
// Emitted source text, read back: the spline's bits, nothing of the machine, the same bytes every time.
#include "generator/emit/emit_material.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "generator/emit/emitter.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "support/compare.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

constexpr auto kCommand = "generate felt.json --emit cpp -o -";

const Emitter& emitter(std::string_view name) {
  for (const Emitter& candidate : emitters())
    if (candidate.name == name) return candidate;
  throw std::logic_error("no such emitter");
}

/// A material file with random numbers; every other one has a range of impacts.
std::string random_material_text(std::mt19937_64& random, bool with_impact) {
  const auto uniform = [&](double min, double max) {
    return min + (max - min) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Json file = {{"name", "random"},
               {"contact", {{"stiffness_n_per_m_alpha", std::pow(10, uniform(3, 12))}, {"exponent", uniform(1, 5)}}},
               {"spline",
                {{"knots", "uniform"},
                 {"segments", 1 + static_cast<int>(uniform(0, 100))},
                 {"max_compression_m", std::pow(10, uniform(-6, -2))}}}};
  if (with_impact)
    file["impact"] = {{"mass_kg", uniform(0.001, 0.01)}, {"max_speed_m_per_s", 5.0}, {"min_speed_m_per_s", 0.1}};
  return file.dump();
}

std::vector<EmbeddedFile> shipped_materials() {
  std::vector<EmbeddedFile> materials;
  for (const EmbeddedFile& text : embedded_files(Shipped::kMaterials))
    if (text.name.ends_with(".json")) materials.push_back(text);
  return materials;
}

/// One of the other knot families, which need impacts and end where they do.
std::string fitted_material_text(std::mt19937_64& random, const char* knots) {
  Json file = Json::parse(random_material_text(random, true));
  file["spline"].erase("max_compression_m");
  file["spline"]["knots"] = knots;
  file["spline"]["segments"] = file["spline"]["segments"].get<int>() % 24 + 1;
  return file.dump();
}

/// Forty uniform designs, ten of either other family, and every material that ships.
const std::vector<Design>& designs() {
  static const std::vector<Design> all = [] {
    std::vector<Design> made;
    std::mt19937_64 random(7);
    for (int i = 0; i < 40; ++i)
      made.push_back(design_material(random_material_text(random, i % 2 == 0), "random.json"));
    for (const auto knots : {"graded", "optimal"})
      for (int i = 0; i < 10; ++i)
        made.push_back(design_material(fitted_material_text(random, knots), "random.json"));
    for (const auto& [name, content] : shipped_materials()) made.push_back(design_material(content, name));
    return made;
  }();
  return all;
}

std::vector<double> column(const Spline& spline, double Segment<double>::*member) {
  std::vector<double> values;
  for (const auto& segment : spline.segments) values.push_back(segment.*member);
  return values;
}

::testing::AssertionResult same_bits(const std::vector<double>& read, const std::vector<double>& meant) {
  if (read.size() != meant.size() || meant.empty())
    return ::testing::AssertionFailure() << read.size() << " values instead of " << meant.size();
  for (std::size_t i = 0; i < meant.size(); ++i)
    if (std::bit_cast<std::uint64_t>(read[i]) != std::bit_cast<std::uint64_t>(meant[i]))
      return ::testing::AssertionFailure() << "at " << i << ": " << read[i] << " instead of " << meant[i];
  return ::testing::AssertionSuccess();
}

::testing::AssertionResult same_bits(double read, double meant) {
  return same_bits(std::vector{read}, std::vector{meant});
}

/// Numbers of a comma-separated list; anything else in it fails.
std::vector<double> numbers(const std::string& list) {
  std::vector<double> values;
  std::istringstream stream(list);
  for (std::string item; std::getline(stream, item, ',');) {
    char* end = nullptr;
    values.push_back(std::strtod(item.c_str(), &end));
    EXPECT_EQ(std::string(end).find_first_not_of(" \n"), std::string::npos) << item;
    EXPECT_NE(item.find_first_of(".e"), std::string::npos) << "an integer: " << item;
  }
  return values;
}

std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const auto begin = text.find(before);
  if (begin == std::string::npos) return {};
  const auto from = begin + before.size();
  return text.substr(from, text.find(after, from) - from);
}

/// What the unit of length of the normalised tables is called: uniform knots have their width, others the whole
/// range.
std::string length_scale(const Design& design) {
  return design.material.spline.knots == Knots::uniform ? "segment_width" : "length_scale";
}

/// Normalised knots, from the others: uniform ones are numbers.
::testing::AssertionResult are_normalised_knots(const std::vector<double>& read, const Design& design) {
  if (read.size() != design.spline.segments.size()) return ::testing::AssertionFailure() << read.size() << " knots";
  for (std::size_t j = 0; j < read.size(); ++j) {
    const double knot = design.spline.segments[j].knot / design.spline.length_scale_m;
    const bool uniform = design.material.spline.knots == Knots::uniform;
    if (uniform ? read[j] != static_cast<double>(j) : !relatively_within(read[j], knot, 3 * 0x1p-53))
      return ::testing::AssertionFailure() << "knot " << j << " is " << read[j];
  }
  return ::testing::AssertionSuccess();
}

TEST(Emitters, AreFaustCppAndJson) {
  std::set<std::string_view> names, extensions;
  for (const Emitter& e : emitters()) {
    names.insert(e.name);
    extensions.insert(e.extension);
  }
  EXPECT_EQ(names, (std::set<std::string_view>{"faust", "cpp", "json"}));
  EXPECT_EQ(extensions, (std::set<std::string_view>{"lib", "hpp", "json"}));
}

TEST(Json, HoldsTheBitsOfTheSpline) {
  for (const Design& design : designs()) {
    const Json read = Json::parse(emit(emitter("json"), design, kCommand));
    const Spline& s = design.spline;
    const auto array = [](const Json& values) { return values.get<std::vector<double>>(); };
    EXPECT_TRUE(same_bits(array(read.at("knots_m")), column(s, &Segment<double>::knot)));
    EXPECT_TRUE(same_bits(array(read.at("energy_j")), column(s, &Segment<double>::energy)));
    EXPECT_TRUE(same_bits(array(read.at("force_n")), column(s, &Segment<double>::force)));
    EXPECT_TRUE(same_bits(array(read.at("half_curvature_n_per_m")), column(s, &Segment<double>::half_curvature)));
    EXPECT_TRUE(same_bits(array(read.at("regular").at("a")), s.regular.a));
    EXPECT_TRUE(same_bits(array(read.at("regular").at("b")), s.regular.b));
    EXPECT_TRUE(same_bits(array(read.at("regular").at("c")), s.regular.c));
    EXPECT_TRUE(same_bits(array(read.at("normalised").at("a")), s.normalised.a));
    EXPECT_TRUE(same_bits(array(read.at("normalised").at("b")), s.normalised.b));
    EXPECT_TRUE(same_bits(array(read.at("normalised").at("c")), s.normalised.c));
    EXPECT_TRUE(same_bits(read.at(length_scale(design) + "_m").get<double>(), s.length_scale_m));
    EXPECT_TRUE(same_bits(read.at("energy_scale_j").get<double>(), s.energy_scale_j));
    if (const PowerLaw* law = design.material.contact.power_law()) {
      EXPECT_TRUE(same_bits(read.at("stiffness_n_per_m_alpha").get<double>(), law->stiffness));
      EXPECT_TRUE(same_bits(read.at("exponent").get<double>(), law->exponent));
    } else {
      EXPECT_EQ(read.at("law"), law_text(design.material));
    }
    EXPECT_TRUE(same_bits(read.at("loss_s_per_m").get<double>(), design.material.loss_s_per_m));
    EXPECT_TRUE(same_bits(read.at("max_compression_m").get<double>(), design.material.spline.max_compression_m));
    EXPECT_EQ(read.at("name"), design.material.name);
  }
}

TEST(Json, HasOneEntryPerSegmentInEveryArray) {
  for (const Design& design : designs()) {
    const Json read = Json::parse(emit(emitter("json"), design, kCommand));
    const auto n = static_cast<std::size_t>(design.material.spline.segments);
    for (const auto key : {"knots_m", "energy_j", "force_n", "half_curvature_n_per_m"})
      EXPECT_EQ(read.at(key).size(), n) << key;
    for (const auto form : {"regular", "normalised"})
      for (const auto key : {"a", "b", "c"}) EXPECT_EQ(read.at(form).at(key).size(), n) << form << "." << key;
  }
}

// Four digits: half a unit of the fourth is at most 5e-4 of the value; below 1e-12 nothing but rounding is left.
TEST(Json, HoldsTheQualityToFourDigits) {
  for (const Design& design : designs()) {
    const Json read = Json::parse(emit(emitter("json"), design, kCommand)).at("quality");
    const Quality& q = design.quality;
    const auto expect_figure = [&](const char* key, double value) {
      EXPECT_TRUE(within(read.at(key).get<double>(), value, 5.0001e-4 * value + 1e-12)) << key;
    };
    expect_figure("worst_force_error", q.force.worst);
    expect_figure("rms_force_error", q.force.rms);
    expect_figure("worst_energy_error", q.energy.worst);
    expect_figure("rms_energy_error", q.energy.rms);
    ASSERT_EQ(q.impact.has_value(), design.material.impact.has_value());
    if (!q.impact) continue;
    expect_figure("worst_contact_duration_error", q.impact->contact_duration);
    expect_figure("worst_max_compression_error", q.impact->max_compression);
  }
}

/// The constants of a power law stand there, with the right bits; other laws have none.
template <typename Scalar>
void expect_law(const Design& design, Scalar scalar, const std::string& stiffness) {
  const PowerLaw* law = design.material.contact.power_law();
  if (law == nullptr) {
    EXPECT_TRUE(scalar(stiffness).empty() && scalar("exponent").empty());
    return;
  }
  EXPECT_TRUE(same_bits(scalar(stiffness), {law->stiffness}));
  EXPECT_TRUE(same_bits(scalar("exponent"), {law->exponent}));
}

constexpr Emitter kCppOfAllForms = {"cpp", "hpp", true};

TEST(Cpp, HoldsTheBitsOfTheSpline) {
  for (const Design& design : designs()) {
    const std::string text = emit(kCppOfAllForms, design, kCommand);
    const Spline& s = design.spline;
    const auto array = [](const std::string& scope, const std::string& name) {
      return numbers(between(scope, "std::array<double, segments> " + name + " = {\n", "};"));
    };
    EXPECT_TRUE(same_bits(array(text, "knots"), column(s, &Segment<double>::knot)));
    EXPECT_TRUE(same_bits(array(text, "energies"), column(s, &Segment<double>::energy)));
    EXPECT_TRUE(same_bits(array(text, "forces"), column(s, &Segment<double>::force)));
    EXPECT_TRUE(same_bits(array(text, "half_curvatures"), column(s, &Segment<double>::half_curvature)));
    const std::string normalised = between(text, "struct normalised {", "\n  };");
    EXPECT_TRUE(are_normalised_knots(array(normalised, "knots"), design));
    EXPECT_TRUE(same_bits(array(normalised, "energies"), s.normalised.c));
    EXPECT_TRUE(same_bits(array(normalised, "forces"), s.normalised.b));
    EXPECT_TRUE(same_bits(array(normalised, "half_curvatures"), s.normalised.a));
    const std::string regular = between(text, "struct regular {", "\n  };");
    EXPECT_TRUE(same_bits(array(regular, "a"), s.regular.a));
    EXPECT_TRUE(same_bits(array(regular, "b"), s.regular.b));
    EXPECT_TRUE(same_bits(array(regular, "c"), s.regular.c));
    const auto scalar = [&](const std::string& name) {
      return numbers(between(text, "static constexpr double " + name + " = ", ";"));
    };
    expect_law(design, scalar, "stiffness_n_per_m_alpha");
    EXPECT_TRUE(same_bits(scalar("loss_s_per_m"), {design.material.loss_s_per_m}));
    EXPECT_TRUE(same_bits(numbers(between(normalised, "static constexpr double loss = ", ";")),
                          {design.material.loss_s_per_m * s.length_scale_m}));
    EXPECT_TRUE(same_bits(scalar("max_compression_m"), {design.material.spline.max_compression_m}));
    EXPECT_TRUE(same_bits(scalar(length_scale(design) + "_m"), {s.length_scale_m}));
    EXPECT_TRUE(same_bits(scalar("energy_scale_j"), {s.energy_scale_j}));
    EXPECT_EQ(between(text, "std::size_t segments = ", ";"), std::to_string(s.segments.size()));
    EXPECT_EQ(between(normalised, "std::size_t segments = ", ";"), std::to_string(s.segments.size()));
  }
}

// Without the two forms that nothing calls, a header is the same text.
TEST(Cpp, HasTheOtherFormsOnRequest) {
  for (const Design& design : designs()) {
    std::string text = emit(kCppOfAllForms, design, kCommand);
    const auto erase = [&](std::size_t from, std::size_t count) { text.erase(from, count); };
    const std::size_t forms = text.find("\n\n  // The same for y in ");
    const std::string last = "\n  };", regular = "struct regular {";
    ASSERT_LT(forms, text.find(regular));
    erase(forms, text.find(last, text.find(regular)) + last.size() - forms);
    ASSERT_NE(text.find(" --all-forms\n"), std::string::npos);
    erase(text.find(" --all-forms\n"), std::string(" --all-forms").size());
    EXPECT_EQ(emit(emitter("cpp"), design, kCommand), text);
  }
}

// Each table begins with "out of contact", then one entry per segment.
TEST(Faust, HoldsTheBitsOfTheSpline) {
  for (const Design& design : designs()) {
    const std::string text = emit(emitter("faust"), design, kCommand);
    const Spline& s = design.spline;
    const auto expect_table = [](const std::string& scope, const std::string& name, std::vector<double> meant) {
      meant.insert(meant.begin(), 0.0);
      const auto read = numbers(between(scope, name + "(index) = rdtable(waveform{", "}, int(index));"));
      EXPECT_TRUE(same_bits(read, meant)) << name;
    };
    const std::string si = between(text, "segments = ", "environment {");
    expect_table(si, "\nknot", column(s, &Segment<double>::knot));
    expect_table(si, "\nenergy", column(s, &Segment<double>::energy));
    expect_table(si, "\nforce", column(s, &Segment<double>::force));
    expect_table(si, "\nhalf_curvature", column(s, &Segment<double>::half_curvature));
    const std::string normalised = between(text, "normalised = environment {", "\n};");
    expect_table(normalised, "\n  knot", s.normalised_knots);
    EXPECT_TRUE(are_normalised_knots(s.normalised_knots, design));
    expect_table(normalised, "\n  energy", s.normalised.c);
    expect_table(normalised, "\n  force", s.normalised.b);
    expect_table(normalised, "\n  half_curvature", s.normalised.a);
    const auto scalar = [&](const std::string& name) { return numbers(between(text, "\n" + name + " = ", ";")); };
    expect_law(design, scalar, "stiffness");
    EXPECT_TRUE(same_bits(scalar("loss"), {design.material.loss_s_per_m}));
    EXPECT_TRUE(same_bits(numbers(between(normalised, "\n  loss = ", ";")),
                          {design.material.loss_s_per_m * s.length_scale_m}));
    EXPECT_TRUE(same_bits(scalar("max_compression"), {design.material.spline.max_compression_m}));
    EXPECT_TRUE(same_bits(scalar(length_scale(design)), {s.length_scale_m}));
    EXPECT_TRUE(same_bits(scalar("energy_scale"), {s.energy_scale_j}));
  }
}

// A text without comments and blanks, each number and each list of numbers a #.
std::string without_numbers(const std::string& text) {
  const auto is_part_of = [](char c, const char* set) { return std::string_view(set).find(c) != std::string::npos; };
  std::string plain;
  for (std::size_t at = 0; at < text.size();) {
    const bool is_in_word =
        !plain.empty() && (std::isalpha(static_cast<unsigned char>(plain.back())) || plain.back() == '_');
    if (text.compare(at, 2, "//") == 0) {
      at = std::min(text.find('\n', at), text.size());
    } else if (!is_in_word && (std::isdigit(static_cast<unsigned char>(text[at])) || is_part_of(text[at], "-"))) {
      at = std::min(text.find_first_not_of("0123456789.e+-", at), text.size());
      if (plain.ends_with("#,"))
        plain.pop_back();
      else
        plain += '#';
    } else {
      if (!is_part_of(text[at], " \n")) plain += text[at];
      ++at;
    }
  }
  return plain;
}

// What Faust compiles of one material says something of the others: tests/faust compiles one of each kind.
TEST(Faust, DiffersInNumbersAlone) {
  ASSERT_EQ(without_numbers("a = -1e-05; // 3\nb2(i) = f{0.0,\n  1.5, 2.0};"), "a=#;b2(i)=f{#};");
  std::map<std::string, std::string> texts;
  for (const Design& design : designs()) {
    if (!design.material.memories.empty() || design.material.live_exponent) continue;  // have functions of their own
    const std::string text = replaced(without_numbers(emit(emitter("faust"), design, kCommand)), "[a-z_]+=#;", "");
    const auto [first, is_new] = texts.try_emplace(length_scale(design), text);
    EXPECT_EQ(text, first->second) << design.material.name;
  }
  EXPECT_EQ(texts.size(), 2u) << "uniform knots, and others";
}

// ceil(log2(N + 1)) probes (design 2.2), in both environments.
TEST(Faust, CountsSegmentsAndProbes) {
  for (const Design& design : designs()) {
    const std::string text = emit(emitter("faust"), design, kCommand);
    const auto n = design.spline.segments.size();
    const std::string probes = std::to_string(static_cast<int>(std::ceil(std::log2(static_cast<double>(n) + 1))));
    for (const std::string indent : {"\n", "\n  "}) {
      EXPECT_EQ(between(text, indent + "segments = ", ";"), std::to_string(n));
      EXPECT_EQ(between(text, indent + "probes = ", ";"), probes) << n;
    }
  }
}

class EveryEmitter : public ::testing::TestWithParam<std::string_view> {
 protected:
  static std::string text(const Design& design) { return emit(emitter(GetParam()), design, kCommand); }
};

TEST_P(EveryEmitter, GivesTheSameBytesTwice) {
  for (const auto& [name, content] : shipped_materials()) {
    const std::string elsewhere = "/home/somebody/" + std::string(name);
    EXPECT_EQ(text(design_material(content, name)), text(design_material(content, elsewhere))) << name;
  }
}

// Neither where it was built, nor where the material lay, nor anything that looks like either.
TEST_P(EveryEmitter, HasNoAbsolutePath) {
  const char* absolute = R"((^|[\s"'(=:])/[A-Za-z0-9_.]+/)";
  ASSERT_TRUE(first_match("see /usr/share/x", absolute));
  const Design elsewhere = design_material(shipped_materials().front().content, "/home/somebody/felt.json");
  EXPECT_EQ(text(elsewhere).find("somebody"), std::string::npos);
  for (const Design& each : designs()) {
    const std::string emitted = text(each);
    EXPECT_FALSE(first_match(emitted, absolute)) << emitted;
    EXPECT_EQ(emitted.find(SOURCE_FOLDER), std::string::npos);
    EXPECT_EQ(emitted.find(BUILD_FOLDER), std::string::npos);
  }
}

TEST_P(EveryEmitter, HasNoDate) {
  const char* date = R"(20\d\d-\d\d)";
  ASSERT_TRUE(first_match("2024-04", date));
  for (const Design& design : designs()) EXPECT_FALSE(first_match(text(design), date));
}

TEST_P(EveryEmitter, QuotesCommandAndVersion) {
  for (const Design& design : designs())
    EXPECT_TRUE(first_match(text(design), R"(contactspline \d+\.\d+\.\d+: )" + std::string(kCommand)));
}

TEST_P(EveryEmitter, LeavesNoPlaceholder) {
  for (const Design& design : designs()) EXPECT_EQ(text(design).find('@'), std::string::npos);
}

// Faust knows no hexadecimal floats and no upper-case E; NaN and infinity are no literals anywhere.
TEST_P(EveryEmitter, HasNoNumberThatFaustCannotRead) {
  const char* unreadable = R"(\b\d+(\.\d*)?E|\b0[xX]|\b(nan|inf)\b)";
  ASSERT_TRUE(first_match("1.5E3", unreadable) && first_match("0x1p3", unreadable));
  for (const Design& design : designs()) EXPECT_FALSE(first_match(text(design), unreadable));
}

TEST_P(EveryEmitter, SpeaksOfImpactsOnlyWhereTheMaterialDoes) {
  for (const Design& design : designs()) {
    const bool speaks = first_match(text(design), "contact.duration").has_value();
    EXPECT_EQ(speaks, design.material.impact.has_value());
  }
}

TEST_P(EveryEmitter, EndsWithOneNewlineAndHasNoTrailingBlank) {
  for (const Design& design : designs()) {
    const std::string emitted = text(design);
    EXPECT_TRUE(emitted.ends_with('\n'));
    EXPECT_FALSE(emitted.ends_with("\n\n"));
    EXPECT_EQ(emitted.find(" \n"), std::string::npos);
    EXPECT_EQ(emitted.find('\t'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, EveryEmitter, ::testing::Values("faust", "cpp", "json"),
                         [](const auto& tested) { return std::string(tested.param); });

// Errors below 1e-12, or 1e-6 dB, are rounding: figures must not differ between machines.
TEST(Quality, OfALinearContactIsZeroInEveryFormat) {
  const Design design = design_material(
      R"({"name": "linear", "contact": {"stiffness_n_per_m_alpha": 3e5, "exponent": 1},
          "impact": {"mass_kg": 0.01, "max_speed_m_per_s": 3, "min_speed_m_per_s": 0.1},
          "spline": {"knots": "uniform", "segments": 17}})",
      "linear.json");
  const Json figures = Json::parse(emit(emitter("json"), design, kCommand)).at("quality");
  EXPECT_EQ(figures.size(), 8U);
  for (const auto& figure : figures) EXPECT_EQ(figure.get<double>(), 0);
  for (const auto name : {"faust", "cpp"})
    EXPECT_NE(emit(emitter(name), design, kCommand).find("contact duration within 0 %"), std::string::npos);
}

TEST(DesignContact, RefusesWhatTheSplineRefuses) {
  EXPECT_THROW(static_cast<void>(design_material(
                   R"({"name": "soft", "contact": {"stiffness_n_per_m_alpha": 3e5, "exponent": 0.5},
                       "spline": {"knots": "uniform", "segments": 17, "max_compression_m": 1e-3}})",
                   "soft.json")),
               BadInput);
}

// The corrected law ends at the integral of theta/tan(theta) over the compressions, theta = dt/2 sqrt(F'/m).
TEST(Emit, SaysHowFarACompensatedSplineReaches) {
  const double rate = 12000, mass_kg = 0.00297;
  const Design design = design_material(
      R"({ "name": "soft", "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
    "impact": { "mass_kg": 0.00297, "max_speed_m_per_s": 6, "min_speed_m_per_s": 1 },
    "spline": { "knots": "graded", "segments": 16 },
    "compensation": { "sample_rate_hz": 12000, "mass_kg": 0.00297 } })",
      "soft.json");
  const double range = design.material.spline.max_compression_m;
  double expected = 0;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i) {
    const double y = (i + 0.5) / kSteps * range;
    const double theta = 0.5 / rate * std::sqrt(4.5e9 * 2.5 * std::pow(y, 1.5) / mass_kg);
    expected += theta / std::tan(theta) * range / kSteps;
  }
  EXPECT_LT(expected, 0.98 * range);
  for (const auto name : {"faust", "cpp"}) {
    const std::string text = emit(emitter(name), design, kCommand);
    const auto at = text.find("segments over 0 to ");
    ASSERT_NE(at, std::string::npos);
    EXPECT_TRUE(relatively_within(std::stod(text.substr(at + 19)), expected, 2e-3)) << name;
  }
  EXPECT_LE(design.quality.impact->contact_duration, 0.01);
}

/// A felt whose exponent is live, of so many segments and members; `max` from 2.6 on.
std::string live_felt(int segments, int members, double max) {
  return fmt::format(R"({{ "name": "felt_alive", "contact": {{ "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 }},
    "impact": {{ "mass_kg": 0.00297, "max_speed_m_per_s": 6, "min_speed_m_per_s": 0.12 }},
    "spline": {{ "knots": "uniform", "segments": {} }},
    "live_exponent": {{ "min": 1.2, "max": {}, "members": {} }} }})",
                     segments, max, members);
}

// The figures of a family, by blending what was emitted: 2,000 speeds, seven exponents between any two members, where
// the generator takes three. Peaks it misses stay within 3 % of the figure. All of the family is convex and reaches
// as deep as the fastest impact at any exponent, (a + 1) E = F y (y/y_max)^a.
TEST(Emit, FiguresOfALiveExponentAreTheWorstOfAllExponents) {
  for (const auto& [segments, members, max] :
       {std::tuple(1, 2, 3.2), {4, 2, 3.2}, {4, 5, 10.0}, {8, 3, 2.6}, {16, 21, 3.2}, {40, 9, 6.0}}) {
    const Design design = design_material(live_felt(segments, members, max), "live.json");
    const Json live = Json::parse(emit(emitter("json"), design, kCommand)).at("live");
    const auto numbers = [&](const char* key) { return live.at(key).get<std::vector<double>>(); };
    const auto knots = numbers("knots_m"), energies = numbers("energy_j"), forces = numbers("force_n"),
               halves = numbers("half_curvature_n_per_m");
    const double range = design.material.spline.max_compression_m, largest = design.material.contact.force(range);
    double worst_duration = 0, worst_compression = 0, deepest = range;
    const int steps = 8 * (members - 1);
    for (int i = 0; i <= steps; ++i) {
      const double exponent = 1.2 + (max - 1.2) * i / steps;
      const auto below = static_cast<std::size_t>(std::min(i / 8, members - 2));
      const double part = i / 8.0 - static_cast<double>(below);
      Spline spline{{}, 1, 1, {}, {}, {}};
      for (std::size_t j = 0; j < knots.size(); ++j) {
        const std::size_t low = below * knots.size() + j, high = low + knots.size();
        const auto blend = [&](const std::vector<double>& of) { return of[low] + part * (of[high] - of[low]); };
        spline.segments.push_back({knots[j], blend(energies), blend(forces), blend(halves)});
        EXPECT_GE(spline.segments.back().half_curvature, 0) << segments << " " << exponent;
      }
      const PowerLaw law{largest / std::pow(range, exponent), exponent};
      deepest = std::max(deepest, law.max_compression(0.00297, 6));
      for (int n = 0; n <= 2000; ++n) {
        const double speed = 6 * std::pow(50.0, -n / 2000.0);
        const SplineImpact found = impact_on_spline(spline, 0.00297, speed);
        worst_duration =
            std::max(worst_duration, std::abs(found.contact_duration_s / law.contact_duration(0.00297, speed) - 1));
        worst_compression =
            std::max(worst_compression, std::abs(found.max_compression_m / law.max_compression(0.00297, speed) - 1));
      }
    }
    const Json figures = live.at("quality");
    EXPECT_TRUE(relatively_within(figures.at("worst_contact_duration_error").get<double>(), worst_duration, 0.03));
    EXPECT_TRUE(relatively_within(figures.at("worst_max_compression_error").get<double>(), worst_compression, 0.03));
    EXPECT_GE(live.at("max_compression_m").get<double>(), deepest * (1 - 1e-3)) << max;  // between the steps
    EXPECT_LE(live.at("max_compression_m").get<double>(), deepest * (1 + 1e-3)) << max;
    const std::string shown =
        fmt::format("{:.3g} %, max compression", 100 * figures.at("worst_contact_duration_error").get<double>());
    for (const auto name : {"faust", "cpp"})
      EXPECT_NE(emit(emitter(name), design, kCommand).find("contact duration within " + shown), std::string::npos);
  }
}

}  // namespace
}  // namespace contactspline::testing
