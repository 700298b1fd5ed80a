// SPDX-License-Identifier: MIT
// What the parts of a window draw with: colours, and text that fits its box.
#pragma once

#include <NanoVG.hpp>
#include <OpenGL-include.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#ifdef _WIN32
#include "windows/framebuffers.hpp"
#endif

namespace contactspline {

/// A rectangle in units of the window at 100 %.
struct Box {
  float x, y, width, height;

  [[nodiscard]] bool has(double at_x, double at_y) const {
    return at_x >= x && at_x < x + width && at_y >= y && at_y < y + height;
  }
  [[nodiscard]] Box inner(float margin) const {
    return {x + margin, y + margin, width - 2 * margin, height - 2 * margin};
  }
};

struct Colour {
  int red, green, blue;
};
namespace colours {
inline constexpr Colour kBackground{20, 22, 27}, kPanel{29, 32, 39}, kLine{58, 64, 75}, kText{232, 235, 240},
    kMuted{152, 160, 173}, kAccent{255, 178, 74}, kWhiteKey{226, 229, 234}, kBlackKey{12, 13, 16},
    kOnLight{70, 75, 84}, kMark{64, 156, 255};
}  // namespace colours

/// A number in four digits or more, with its unit.
[[nodiscard]] inline std::string number_text(double value, const std::string& unit) {
  char text[32];
  const bool is_long = std::abs(value) >= 1e4 && std::abs(value) < 1e7;
  std::snprintf(text, sizeof text, is_long ? "%.0f" : "%.4g", value == 0 ? 0.0 : value);  // no -0
  return unit.empty() ? text : text + (" " + unit);
}

/// A number in three digits, with the prefix of its unit.
[[nodiscard]] inline std::string prefixed_text(double value, const std::string& unit) {
  static constexpr const char* kPrefixes[] = {"p", "n", "µ", "m", "", "k", "M"};
  if (!(std::abs(value) >= 1e-13)) return "0 " + unit;
  const int thousands = std::clamp(static_cast<int>(std::floor(std::log10(std::abs(value)) / 3 + 1e-9)), -4, 2);
  char text[32];
  std::snprintf(text, sizeof text, "%.3g ", value * std::pow(10.0, -3 * thousands));
  return text + std::string(kPrefixes[thousands + 4]) + unit;
}

enum class Side { kLeft, kMiddle, kRight };

class Canvas {
 public:
  /// Text as it was drawn.
  struct Text {
    std::string text;
    Box box;
    float size;
  };

  /// A part of a window of `height` pixels, whose units are `scale` pixels wide, from (left, top) on.
  Canvas(DGL_NAMESPACE::NanoVG& graphics, float left, float top, float scale, unsigned height)
      : graphics_(graphics), left_(left), top_(top), scale_(scale), height_(height) {
    graphics_.translate(left, top);
    graphics_.scale(scale, scale);
    graphics_.fontFace("__dpf_dejavusans_ttf__");
  }

  /// The whole window in a colour.
  static void clear(const Colour& colour) {
    glDisable(GL_SCISSOR_TEST);
    clear_with(colour);
  }

  /// A rectangle below all that is drawn by the other functions, in whole pixels. Processors that draw without
  /// graphics hardware clear many times as fast as they fill.
  void lay(const Box& box, const Colour& colour) const {
    const auto pixel = [&](float offset, float at) { return static_cast<int>(std::lround(offset + scale_ * at)); };
    const int x = pixel(left_, box.x), y = pixel(top_, box.y);
    const int right = pixel(left_, box.x + box.width), bottom = pixel(top_, box.y + box.height);
    glEnable(GL_SCISSOR_TEST);
    glScissor(x, static_cast<int>(height_) - bottom, std::max(0, right - x), std::max(0, bottom - y));
    clear_with(colour);
    glDisable(GL_SCISSOR_TEST);
  }

  void fill(const Box& box, const Colour& colour) {
    graphics_.beginPath();
    graphics_.rect(box.x, box.y, box.width, box.height);
    fill_path(colour);
  }

  void line(float x, float y, float to_x, float to_y, const Colour& colour, float width = 1) {
    graphics_.beginPath();
    graphics_.moveTo(x, y);
    graphics_.lineTo(to_x, to_y);
    stroke_path(colour, width);
  }

  /// A part of a circle, clockwise, with angles from the right on.
  void arc(float x, float y, float radius, float from, float to, const Colour& colour, float width) {
    graphics_.beginPath();
    graphics_.arc(x, y, radius, from, to, DGL_NAMESPACE::NanoVG::CW);
    stroke_path(colour, width);
  }

  void disc(float x, float y, float radius, const Colour& colour) {
    graphics_.beginPath();
    graphics_.circle(x, y, radius);
    fill_path(colour);
  }

  /// A curve through points, given as x and y, below all that is drawn by other functions but lay(). The shader of
  /// NanoVG costs processors without graphics hardware several times as much.
  void curve(const std::vector<float>& xs, const std::vector<float>& ys, const Colour& colour, float width) const {
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_LINE_SMOOTH);
    glLineWidth(scale_ * width);
    glColor3ub(static_cast<GLubyte>(colour.red), static_cast<GLubyte>(colour.green),
               static_cast<GLubyte>(colour.blue));
    glBegin(GL_LINE_STRIP);
    for (std::size_t n = 0; n < xs.size(); ++n) glVertex2f(left_ + scale_ * xs[n], top_ + scale_ * ys[n]);
    glEnd();
    glDisable(GL_LINE_SMOOTH);
  }

  /// Text in a box, as large as it fits, at most `size`; the height of the box is used for one line.
  void text(const Box& box, const std::string& words, float size, const Colour& colour, Side side = Side::kLeft) {
    using Graphics = DGL_NAMESPACE::NanoVG;
    if (words.empty()) return;
    graphics_.textAlign(Graphics::ALIGN_LEFT | Graphics::ALIGN_MIDDLE);
    const float width = width_of(words, size);
    if (width > box.width) size *= box.width / width * 0.98f;
    graphics_.fontSize(size);
    const float left = box.width - width_of(words, size);
    const float x = box.x + (side == Side::kLeft ? 0 : side == Side::kRight ? left : left / 2);
    const float y = box.y + box.height / 2;
    graphics_.fillColor(colour.red, colour.green, colour.blue);
    graphics_.text(x, y, words.c_str(), nullptr);
    DGL_NAMESPACE::Rectangle<float> bounds;
    graphics_.textBounds(x, y, words.c_str(), nullptr, bounds);
    texts_.push_back({words, {bounds.getX(), bounds.getY(), bounds.getWidth(), bounds.getHeight()}, size});
  }

  [[nodiscard]] float width_of(const std::string& words, float size) {
    DGL_NAMESPACE::Rectangle<float> bounds;
    graphics_.fontSize(size);
    return graphics_.textBounds(0, 0, words.c_str(), nullptr, bounds);
  }

  /// All text that was drawn, for tests.
  [[nodiscard]] const std::vector<Text>& texts() const { return texts_; }

 private:
  static void clear_with(const Colour& colour) {
    glClearColor(static_cast<float>(colour.red) / 255, static_cast<float>(colour.green) / 255,
                 static_cast<float>(colour.blue) / 255, 1);
    glClear(GL_COLOR_BUFFER_BIT);
  }

  void fill_path(const Colour& colour) {
    graphics_.fillColor(colour.red, colour.green, colour.blue);
    graphics_.fill();
  }
  void stroke_path(const Colour& colour, float width) {
    graphics_.strokeColor(colour.red, colour.green, colour.blue);
    graphics_.strokeWidth(width);
    graphics_.lineJoin(DGL_NAMESPACE::NanoVG::BEVEL);
    graphics_.stroke();
  }

  DGL_NAMESPACE::NanoVG& graphics_;
  float left_, top_, scale_;
  unsigned height_;
  std::vector<Text> texts_;
};

/// What a window shows, kept to be shown again. To copy it is many times as fast as to draw it.
class KeptFigure {
 public:
  KeptFigure() = default;
  KeptFigure(const KeptFigure&) = delete;
  KeptFigure& operator=(const KeptFigure&) = delete;

  /// Of a size in pixels.
  [[nodiscard]] bool has(unsigned width, unsigned height) const { return width_ == width && height_ == height; }

  /// Keeps nothing where the graphics cannot copy it.
  void keep(unsigned width, unsigned height) {
    if (texture_ == 0) glGenTextures(1, &texture_);
    if (frame_ == 0) glGenFramebuffers(1, &frame_);
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, static_cast<GLsizei>(width), static_cast<GLsizei>(height), 0, GL_BGRA,
                 GL_UNSIGNED_BYTE, nullptr);
    glBindTexture(GL_TEXTURE_2D, 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frame_);
    glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    copy(width, height);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    const bool is_kept = frame_ != 0 && glGetError() == GL_NO_ERROR;
    width_ = is_kept ? width : 0;
    height_ = is_kept ? height : 0;
  }

  void show() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_);
    copy(width_, height_);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  }

 private:
  // Upside down, as it is kept: Mesa has the rows of a window in the other order than those of a texture, so that
  // this is a plain copy of memory for it.
  static void copy(unsigned width, unsigned height) {
    const auto right = static_cast<GLint>(width), top = static_cast<GLint>(height);
    glBlitFramebuffer(0, 0, right, top, 0, top, right, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }

  GLuint texture_ = 0, frame_ = 0;  // go with the window
  unsigned width_ = 0, height_ = 0;
};

}  // namespace contactspline
