// SPDX-License-Identifier: MIT
#include "generator/cli/figures.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "generator/cli/file_ending.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/instrument_page.hpp"
#include "generator/cli/sound_file.hpp"
#include "generator/player/spectrogram.hpp"
#include "generator/spline/exponent_family.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr int kPointsPerSegment = 24;
constexpr int kMaxCurvePoints = 4096;
constexpr std::size_t kMaxKnots = 1024;
constexpr std::size_t kColumns = 1200;

constexpr auto kTitle = "TITLE-OF-THE-FIGURE";

// In the order of FigureFormat. A PNG has 200 dpi where the others have 100.
constexpr std::array kTerminals = {
    "set terminal svg size 1080,760 font 'sans-serif,14' background rgb 'white' dynamic\n",
    "set terminal pngcairo size 2160,1520 font 'sans-serif,14' fontscale 1.5 linewidth 2 pointscale 2\n",
    "set terminal pdfcairo size 10.8,7.6 font 'sans-serif,14' fontscale 0.72 background rgb 'white'\n"};

// The common style of all figures, with colours that colour-blind readers can distinguish.
constexpr auto kStyle = R"(
set encoding utf8
set border 3 lc rgb '#888888'
set tics nomirror out scale 0.5 textcolor rgb '#444444'
set grid lc rgb '#e4e4e4' lw 1
set key top left reverse Left samplen 2 textcolor rgb '#444444'
set linetype 1 lc rgb '#b8b8b8' lw 6
set linetype 2 lc rgb '#0072b2' lw 1.6
set linetype 3 lc rgb '#d55e00' lw 1.6
set linetype 4 lc rgb '#0072b2' pt 7 ps 0.35
set linetype 5 lc rgb '#d55e00' pt 6 ps 0.8 lw 1.4
set linetype 6 lc rgb '#e69f00' lw 0.6
)";

// Layouts with the same left and right border for all panels of a column, whatever the width of their numbers.
constexpr auto kFourPanels = "2,2 margins 0.115,0.985,0.085,0.93 spacing 0.125,0.14";
constexpr auto kThreePanels = "3,1 margins 0.115,0.985,0.085,0.93 spacing 0,0.13";
constexpr auto kThreePanelsWithKey = "3,1 margins 0.115,0.74,0.085,0.93 spacing 0,0.13";
constexpr auto kOwnMargins = "3,1";
constexpr auto kWholePage = "1,1 margins 0.01,0.99,0.01,0.94";

constexpr auto kPotentialScript = R"(
set xlabel 'compression [mm]'
set ylabel 'contact potential [mJ]'
plot $curve using 1:2 with lines lt 1 title law, '' using 1:3 with lines lt 2 title 'spline', $knots using 1:2 with points lt 4 title 'knots'
set ylabel 'contact force [N]'
plot )";

constexpr auto kForceCurves =
    "$curve using 1:4 with lines lt 1 title law, '' using 1:5 with lines lt 2 title 'spline', $knots using 1:3 with "
    "points lt 4 title 'knots'";

constexpr auto kErrorsScript = R"(
unset key
set ylabel 'potential error [% of largest]'
plot $curve using 1:6 with lines lt 3, $knots using 1:4 with points lt 4
set ylabel 'force error [% of largest]'
plot $curve using 1:7 with lines lt 3, $knots using 1:5 with points lt 4
unset multiplot)";

constexpr auto kFamiliesScript = R"(
set logscale xy
set xrange [*:*] noextend
set yrange [1e-6:*]
set format y '%g'
set key outside right top
set xlabel 'impact speed [m/s]'
set ylabel 'contact duration error [%]'
)";

constexpr auto kMotionScript = R"(
unset key
set xlabel 'time [s]'
set ylabel 'height [mm]'
plot $height with lines lt 2
set ylabel 'contact force [N]'
plot $force with lines lt 3
set xlabel contact_label
plot $contact with linespoints lt 3 pt 7 ps 0.3
unset multiplot)";

constexpr auto kPerformanceScript = R"(
unset key
set lmargin at screen 0.1
set rmargin at screen 0.88
set xrange [0:duration]
set format x ''
set tmargin at screen 0.93
set bmargin at screen 0.72
set ylabel sound_label
set ytics sound_tics
plot $sound with lines lt 2 lw 0.8
set tmargin at screen 0.69
set bmargin at screen 0.53
set ylabel 'contact force [N]'
set ytics force_tics
set yrange [0:*]
plot $force with lines lt 3 lw 1
set tmargin at screen 0.5
set bmargin at screen 0.095
set format x
set xlabel 'time [s]'
set ylabel 'frequency [Hz]'
unset grid
set tics front
set yrange [log10(lowest):log10(highest)]
set ytics ('50' log10(50), '100' log10(100), '200' log10(200), '500' log10(500), '1 k' 3, '2 k' log10(2000), '5 k' log10(5000), '10 k' 4)
set cblabel 'level [dB]' offset 0.5
set cbrange [-80:0]
set palette defined (0 '#000004', 1 '#1b0c41', 2 '#4a0c6b', 3 '#781c6d', 4 '#a52c60', 5 '#cf4446', 6 '#ed6925', 7 '#fb9b06', 8 '#f7d13d', 9 '#fcffa4')
)";

constexpr std::array kFamilyColours = {"#999999", "#d55e00", "#0072b2", "#009e73", "#cc79a7"};

// Errors below 1e-9 % are rounding errors and are drawn as 1e-9 %.
double shown_percent(double error) {
  return 100 * std::max(std::abs(error), 1e-11);
}

using File = std::unique_ptr<FILE, int (*)(FILE*)>;

// gnuplot reads the script from a pipe and writes the figure to a file descriptor, so no file name passes through a
// shell or through gnuplot's quoting. -d ignores the start-up files of the user.
void run_gnuplot(const std::string& script, FILE* figure) {
  const auto old_handler = std::signal(SIGPIPE, SIG_IGN);  // if gnuplot ends early, an error message follows
  FILE* gnuplot = ::popen(fmt::format("gnuplot -d 2>/dev/null >/dev/fd/{}", ::fileno(figure)).c_str(), "w");
  if (gnuplot == nullptr) throw BadInput("figure: gnuplot cannot be started");
  const bool sent = std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  const int status = ::pclose(gnuplot);
  std::signal(SIGPIPE, old_handler);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw BadInput("figure: gnuplot is not installed; install the package gnuplot-nox, or leave the figure out");
  if (!sent || status != 0)
    throw BadInput("figure: gnuplot failed; try its newest version, another format, or leave the figure out");
}

std::string content(FILE* file) {
  std::string bytes;
  std::array<char, 65536> part{};
  std::rewind(file);
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), file)) bytes.append(part.data(), got);
  return bytes;
}

std::string in_xml(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return safe;
}

std::string drawn(const std::string& script) {
  const File figure(std::tmpfile(), std::fclose);
  if (!figure) throw BadInput("figure: no temporary file can be created");
  run_gnuplot(script, figure.get());
  return content(figure.get());
}

[[noreturn]] void refuse_nothing() {
  throw BadInput("figure: gnuplot drew nothing; try its newest version, another format, or leave the figure out");
}

// The title replaces a placeholder in the finished figure, because gnuplot interprets entities and some quotes in
// titles.
std::string draw_svg(const std::string& script, const std::string& title) {
  std::string svg = drawn(script);
  const auto at = svg.find(kTitle);
  if (at == std::string::npos || svg.find("<svg") == std::string::npos || svg.find("</svg>") == std::string::npos)
    refuse_nothing();
  svg.replace(at, std::strlen(kTitle), in_xml(title));
  return svg.insert(svg.find("<svg"), fmt::format("<!-- {} -->\n", mark()));
}

// The terminals of PNG and PDF take a title as it is; in a quoted string of gnuplot '' is a quote.
std::string with_title(std::string script, const std::string& title) {
  std::string quoted;
  for (const char c : title) quoted += c == '\'' ? "''" : std::string(1, c);
  return script.replace(script.find(kTitle), std::strlen(kTitle), quoted);
}

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

std::string big_endian(std::size_t number) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

// A PNG with the mark as its comment, in a chunk of text after the header: 8 bytes signature, 25 bytes header.
std::string draw_png(const std::string& script, const std::string& title) {
  constexpr std::size_t kHeaderEnd = 33;
  std::string png = drawn(with_title(script, title));
  if (png.size() < kHeaderEnd || !png.starts_with("\x89PNG")) refuse_nothing();
  const std::string chunk = std::string("tEXtComment\0", 12).append(mark());
  return png.insert(kHeaderEnd, big_endian(chunk.size() - 4) + chunk + big_endian(crc32(chunk)));
}

// The mark follows the end of a PDF as a comment: anywhere else it would shift what the table of contents refers to.
std::string draw_pdf(const std::string& script, const std::string& title) {
  const std::string pdf = drawn(with_title(script, title));
  if (!pdf.starts_with("%PDF")) refuse_nothing();
  return fmt::format("{}% {}\n", pdf, mark());
}

std::string draw(const std::string& script, const std::string& title, FigureFormat format) {
  const std::string styled = kTerminals[static_cast<std::size_t>(format)] + (kStyle + script);
  switch (format) {
    case FigureFormat::kSvg:
      return draw_svg(styled, title);
    case FigureFormat::kPng:
      return draw_png(styled, title);
    case FigureFormat::kPdf:
      break;
  }
  return draw_pdf(styled, title);
}

std::string potential_data(const Design& design) {
  const Material& material = design.material;
  const Spline& spline = design.spline;
  const auto table = segment_table(spline);
  const std::span view(table);
  const double range = material.spline.max_compression_m;
  const double top_energy = material.contact.energy(range);
  const double top_force = material.contact.force(range);
  const int points = std::min(kMaxCurvePoints, kPointsPerSegment * material.spline.segments);
  std::string data = "$curve << EOD\n";
  for (int i = 0; i <= points; ++i) {
    const double y = range * i / points;
    const double v = potential<double>(view, y), f = force<double>(view, y);
    const double exact_v = material.contact.energy(y), exact_f = material.contact.force(y);
    data += fmt::format("{:g} {:g} {:g} {:g} {:g} {:g} {:g}\n", 1e3 * y, 1e3 * exact_v, 1e3 * v, exact_f, f,
                        100 * (v - exact_v) / top_energy, 100 * (f - exact_f) / top_force);
  }
  data += "EOD\n$knots << EOD\n";
  const std::size_t step = 1 + (spline.segments.size() - 1) / kMaxKnots;
  for (std::size_t j = 0; j < spline.segments.size(); j += step) {
    const auto& s = spline.segments[j];
    data += fmt::format("{:g} {:g} {:g} {:g} {:g}\n", 1e3 * s.knot, 1e3 * s.energy, s.force,
                        100 * (s.energy - material.contact.energy(s.knot)) / top_energy,
                        100 * (s.force - material.contact.force(s.knot)) / top_force);
  }
  return data + "EOD\n";
}

// The measured samples within the range of the spline.
std::string measured_data(const Material& material) {
  if (!material.measured) return {};
  std::string data = "$measured << EOD\n";
  for (const auto& [y, f, speed] : material.measured->samples)
    if (y <= material.spline.max_compression_m) data += fmt::format("{:g} {:g}\n", 1e3 * y, f);
  return data + "EOD\n";
}

// The forces of the members of a live exponent's family, within the range of the spline.
std::string members_data(const Design& design) {
  if (!design.material.live_exponent) return {};
  constexpr int kPoints = 200;
  const double range = design.material.spline.max_compression_m;
  std::string data = "$members << EOD\n";
  for (const auto& member :
       exponent_family(design.material, static_cast<int>(design.spline.segments.size())).members) {
    for (int i = 0; i <= kPoints; ++i) {
      const double y = range * i / kPoints;
      data += fmt::format("{:g} {:g}\n", 1e3 * y, force<double>(std::span(member), y));
    }
    data += "\n";  // ends the line
  }
  return data + "EOD\n";
}

std::string members_curves(const Material& material) {
  if (!material.live_exponent) return {};
  return fmt::format("$members using 1:2 with lines lt 6 title 'exponents {:g} to {:g}', ",
                     material.live_exponent->min, material.live_exponent->max);
}

// The errors of one design in percent, over speed and over compression.
std::string family_data(const Design& design, std::size_t number) {
  constexpr int kSpeeds = 1500;
  const Material& material = design.material;
  const Spline& spline = design.spline;
  const Impact& impact = *material.impact;
  const auto table = segment_table(spline);
  const double range = material.spline.max_compression_m, largest = material.contact.force(range);
  std::string data = fmt::format("$family{} << EOD\n", number);
  for (int i = 0; i <= kSpeeds; ++i) {
    const double t = static_cast<double>(i) / kSpeeds;
    const double speed = impact.min_speed_m_per_s * std::pow(impact.max_speed_m_per_s / impact.min_speed_m_per_s, t);
    const SplineImpact found = impact_on_spline(spline, impact.mass_kg, speed);
    const double y = max_compression(material.contact, impact.mass_kg, speed);
    data += fmt::format(
        "{:g} {:g} {:g} {:g} {:g}\n", speed,
        shown_percent(found.contact_duration_s / contact_duration(material.contact, impact.mass_kg, speed) - 1),
        shown_percent(found.max_compression_m / y - 1), 1e3 * y,
        shown_percent((force<double>(std::span(table), y) - material.contact.force(y)) / largest));
  }
  return data + "EOD\n";
}

template <typename T>
struct Trace {
  std::string name;
  std::span<const T> values;
  double scale;
};

// The smallest and the largest value in each of about kColumns intervals of time; it looks like a plot of all
// samples.
template <typename T>
std::string envelope_data(const Trace<T>& trace, double rate_hz) {
  const std::size_t interval = std::max<std::size_t>(1, trace.values.size() / kColumns);
  std::string data = fmt::format("${} << EOD\n", trace.name);
  for (std::size_t begin = 0; begin < trace.values.size(); begin += interval) {
    const auto part = trace.values.subspan(begin, std::min(interval, trace.values.size() - begin));
    const auto [min, max] = std::ranges::minmax_element(part);
    for (const auto at : {std::min(min, max), std::max(min, max)})
      data += fmt::format("{:g} {:g}\n", static_cast<double>(&*at - trace.values.data()) / rate_hz,
                          trace.scale * static_cast<double>(*at));
  }
  return data + "EOD\n";
}

std::string first_contact_data(const MassBarrierMotion& motion) {
  const auto& f = motion.force_n;
  const auto in_contact = [](double force) { return force > 0; };
  const auto begin = std::ranges::find_if(f, in_contact);
  const auto end = std::find_if_not(begin, f.end(), in_contact);
  const auto margin = (end - begin) / 4 + 2;
  const auto from = std::max(f.begin(), begin - std::min(margin, begin - f.begin()));
  const auto to = end + std::min(margin, f.end() - end);
  const auto step = 1 + (to - from) / kMaxCurvePoints;  // a mass that comes to rest stays in contact
  std::string data = "$contact << EOD\n";
  for (auto sample = from; sample < to; sample += std::min(step, to - sample))
    data += fmt::format("{:g} {:g}\n", 1e3 * static_cast<double>(sample - begin) / motion.sample_rate_hz, *sample);
  return data + "EOD\n";
}

std::string heading(std::string_view layout) {
  return fmt::format("set multiplot layout {} title '{}' noenhanced font ',17' textcolor rgb '#222222'\n", layout,
                     kTitle);
}

// The sum of the channels.
std::vector<float> mono(const Performance& performance) {
  if (performance.channels == 1) return performance.samples;
  std::vector<float> sum;
  for (std::size_t i = 0; i + 1 < performance.samples.size(); i += 2)
    sum.push_back(performance.samples[i] + performance.samples[i + 1]);
  return sum;
}

// The plot of a spectrogram, with its levels as binary data behind the command: gnuplot reads text six times as
// slowly.
std::string spectrogram_plot(const Spectrogram& spectrogram, double duration) {
  const auto& [columns, rows, lowest, highest, level_db] = spectrogram;
  const double width = duration / static_cast<double>(columns);
  std::string plot = fmt::format(
      "plot '-' binary array=({},{}) format='%float32' origin=({},{}) dx={} dy={} with image\n", columns, rows,
      width / 2, std::log10(lowest), width, std::log10(highest / lowest) / static_cast<double>(rows - 1));
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const auto level = static_cast<float>(level_db[column * rows + row]);
      plot.append(reinterpret_cast<const char*>(&level), sizeof level);
    }
  return plot + "\nunset multiplot\n";
}

// A distance of tics with about five tics over the range: 1, 2 or 5 times a power of ten.
double tic_step(double range) {
  if (!(range > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(range / 5)));
  const double step = range / 5 / power;
  return power * (step <= 1 ? 1 : step <= 2 ? 2 : step <= 5 ? 5 : 10);
}

// Tics of a logarithmic axis: 1, 2 and 5 times the powers of ten, or over many decades only the powers. If there are
// fewer than two of them, both ends. gnuplot alone draws no tics on an axis without a power of ten.
std::string logarithmic_tics(double low, double high) {
  const bool narrow = high / low < 1e3;
  std::vector<double> tics_at;
  for (int power = static_cast<int>(std::floor(std::log10(low))); std::pow(10, power) <= high; ++power)
    for (const int digit : {1, 2, 5})
      if (const double at = digit * std::pow(10, power); at >= low && at <= high && (digit == 1 || narrow))
        tics_at.push_back(at);
  if (tics_at.size() < 2) tics_at = {low, high};
  std::string tics;
  for (const double at : tics_at) tics += fmt::format("{}'{:.4g}' {}", tics.empty() ? "" : ", ", at, at);
  return fmt::format("set xtics ({})\n", tics);
}

std::string force_data(const Performance& performance, double duration_s) {
  std::string data = "$force << EOD\n";
  const double step = duration_s / static_cast<double>(performance.force_n.size());
  for (std::size_t i = 0; i < performance.force_n.size(); ++i)
    data += fmt::format("{:g} {:g}\n", (static_cast<double>(i) + 0.5) * step, performance.force_n[i]);
  return data + "EOD\n";
}

}  // namespace

FigureFormat figure_format(const std::string& file) {
  constexpr std::array<std::string_view, 3> kEndings = {".svg", ".png", ".pdf"};  // in the order of FigureFormat
  const auto found = std::ranges::find(kEndings, file_ending(file));
  if (found == kEndings.end())
    refuse(file, "figure", "its ending names no format that can be drawn", ".svg, .png, .pdf");
  return static_cast<FigureFormat>(found - kEndings.begin());
}

bool has_gnuplot() {
  return std::system("command -v gnuplot >/dev/null 2>&1") == 0;
}

std::string figure_of(const Design& design, FigureFormat format) {
  const bool is_measured = design.material.measured.has_value();
  const auto law = design.material.contact.power_law() != nullptr ? "power law"
                   : is_measured                                  ? "smoothed curve"
                                                                  : "sum of power laws";
  const auto samples = is_measured ? ", $measured using 1:2 with points lt 5 title 'measured'" : "";
  return draw(potential_data(design) + measured_data(design.material) + members_data(design) + heading(kFourPanels) +
                  fmt::format("law = '{}'\n", law) + kPotentialScript + members_curves(design.material) +
                  kForceCurves + samples + kErrorsScript,
              fmt::format("{}: {} segments", title_of(design.material), design.spline.segments.size()), format);
}

std::string figure_of(std::span<const Design> families, FigureFormat format) {
  std::string script, duration, compression, force;
  for (std::size_t i = 0; i < families.size(); ++i) {
    const Design& family = families[i];
    script += family_data(family, i);
    const auto& [knots, minimise] = std::tie(family.material.spline.knots, family.material.spline.minimise);
    const std::string_view name = minimise == ErrorOf::spectrum ? name_of(minimise) : name_of(knots);
    const auto curve = [&](int x, int y) {
      return fmt::format("{}$family{} using {}:{} with lines lw 1.6 lc rgb '{}' title '{}, {} segments'",
                         i == 0 ? "plot " : ", ", i, x, y, kFamilyColours[i % kFamilyColours.size()], name,
                         family.spline.segments.size());
    };
    duration += curve(1, 2);
    compression += curve(1, 3);
    force += curve(4, 5);
  }
  const Material& material = families.front().material;
  const auto& [mass_kg, fastest, slowest] = *material.impact;
  const std::string speeds = logarithmic_tics(slowest, fastest);
  const std::string compressions = logarithmic_tics(1e3 * max_compression(material.contact, mass_kg, slowest),
                                                    1e3 * max_compression(material.contact, mass_kg, fastest));
  return draw(script + heading(kThreePanelsWithKey) + speeds + kFamiliesScript + duration +
                  "\nunset key\nset ylabel 'max compression error [%]'\n" + compression + "\n" + compressions +
                  "set xlabel 'compression [mm]'\nset ylabel 'force error [% of largest]'\n" + force +
                  "\nunset multiplot",
              fmt::format("{}: families of knots", title_of(material)), format);
}

std::string figure_of(const InstrumentModel& model, FigureFormat format) {
  return draw(heading(kWholePage) + instrument_diagram(model), title_of(model), format);
}

std::string figure_of(std::span<const double> speeds, std::span<const ImpactErrors> models, const std::string& title,
                      FigureFormat format) {
  std::string data, duration, compression, force;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const ImpactErrors& errors = models[i];
    data += fmt::format("$model{} << EOD\n", i);
    for (std::size_t s = 0; s < speeds.size(); ++s)
      data += fmt::format("{:g} {:g} {:g} {:g}\n", speeds[s], shown_percent(errors.contact_duration[s]),
                          shown_percent(errors.max_compression[s]), shown_percent(errors.max_force[s]));
    data += "EOD\n";
    const auto curve = [&](int column) {
      return fmt::format("{}$model{} using 1:{} with lines lw {} lc rgb '{}' dt {} title '{}'",
                         i == 0 ? "plot " : ", ", i, column, i == 0 ? 5 : 1.6,
                         kFamilyColours[i % kFamilyColours.size()], 1 + i / kFamilyColours.size() % 4, errors.model);
    };
    duration += curve(2);
    compression += curve(3);
    force += curve(4);
  }
  return draw(data + heading(kThreePanelsWithKey) + logarithmic_tics(speeds.front(), speeds.back()) +
                  kFamiliesScript + duration + "\nunset key\nset ylabel 'max compression error [%]'\n" + compression +
                  "\nset ylabel 'max force error [%]'\n" + force + "\nunset multiplot",
              title, format);
}

std::string figure_of(const MassBarrierMotion& motion, const std::string& title, FigureFormat format) {
  const bool touches = std::ranges::any_of(motion.force_n, [](double force) { return force > 0; });
  const auto label = touches ? "time from the first contact [ms]" : "time before the end [ms]: there was no contact";
  return draw(envelope_data(Trace<double>{"height", motion.displacement_m, -1e3}, motion.sample_rate_hz) +
                  envelope_data(Trace<double>{"force", motion.force_n, 1}, motion.sample_rate_hz) +
                  first_contact_data(motion) + heading(kThreePanels) + fmt::format("contact_label = '{}'\n", label) +
                  kMotionScript,
              title, format);
}

std::string figure_of(const Performance& performance, const std::string& title, const std::string& signal,
                      FigureFormat format) {
  const std::vector<float> sound = mono(performance);
  const double duration = static_cast<double>(sound.size()) / performance.sample_rate_hz;
  const Spectrogram spectrogram = spectrogram_of(sound, performance.sample_rate_hz, 900, 280);
  const std::string frame = fmt::format("duration = {:g}\nlowest = {:g}\nhighest = {:g}\n", duration,
                                        spectrogram.lowest_hz, spectrogram.highest_hz);
  return draw(envelope_data(Trace<float>{"sound", sound, 1}, performance.sample_rate_hz) +
                  force_data(performance, duration) + frame + heading(kOwnMargins) +
                  fmt::format("sound_label = '{}'\nsound_tics = {:g}\nforce_tics = {:g}\n", signal,
                              tic_step(2 * peak_of<float>(sound)), tic_step(performance.largest_force_n)) +
                  kPerformanceScript + spectrogram_plot(spectrogram, duration),
              title, format);
}

}  // namespace contactspline
