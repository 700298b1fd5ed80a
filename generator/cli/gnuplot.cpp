// SPDX-License-Identifier: MIT
#include "generator/cli/gnuplot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "generator/support/error.hpp"

namespace contactspline {
namespace {

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
std::string draw_svg(const std::string& script, const std::string& title, const std::string& mark) {
  std::string svg = drawn(script);
  const auto at = svg.find(kTitle);
  if (at == std::string::npos || svg.find("<svg") == std::string::npos || svg.find("</svg>") == std::string::npos)
    refuse_nothing();
  svg.replace(at, std::strlen(kTitle), in_xml(title));
  return svg.insert(svg.find("<svg"), fmt::format("<!-- {} -->\n", mark));
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
std::string draw_png(const std::string& script, const std::string& title, const std::string& mark) {
  constexpr std::size_t kHeaderEnd = 33;
  std::string png = drawn(with_title(script, title));
  if (png.size() < kHeaderEnd || !png.starts_with("\x89PNG")) refuse_nothing();
  const std::string chunk = std::string("tEXtComment\0", 12).append(mark);
  return png.insert(kHeaderEnd, big_endian(chunk.size() - 4) + chunk + big_endian(crc32(chunk)));
}

// The mark follows the end of a PDF as a comment: anywhere else it would shift what the table of contents refers to.
std::string draw_pdf(const std::string& script, const std::string& title, const std::string& mark) {
  const std::string pdf = drawn(with_title(script, title));
  if (!pdf.starts_with("%PDF")) refuse_nothing();
  return fmt::format("{}% {}\n", pdf, mark);
}

}  // namespace

std::string draw(const std::string& script, const std::string& title, FigureKind kind, FigureFormat format) {
  const std::string styled = kTerminals[static_cast<std::size_t>(format)] + (kStyle + script);
  switch (format) {
    case FigureFormat::kSvg:
      return draw_svg(styled, title, mark_of(kind));
    case FigureFormat::kPng:
      return draw_png(styled, title, mark_of(kind));
    case FigureFormat::kPdf:
      break;
  }
  return draw_pdf(styled, title, mark_of(kind));
}

bool has_gnuplot() {
  return std::system("command -v gnuplot >/dev/null 2>&1") == 0;
}

}  // namespace contactspline
