// SPDX-License-Identifier: MIT
// The framework's side of a window. Each format includes it beside the framework's source.
#pragma once

#include <DistrhoUI.hpp>
#include <algorithm>
#include <optional>

#include "window/instrument_window.hpp"
#include "windowed_plugin.hpp"

START_NAMESPACE_DISTRHO

class InstrumentUI : public UI, private contactspline::WindowHost {
 public:
  InstrumentUI() : UI(kWidth, kHeight) {
    setGeometryConstraints(kWidth, kHeight, true);
    if (const double scale = getScaleFactor(); scale > 1)
      setSize(static_cast<uint>(scale * kWidth), static_cast<uint>(scale * kHeight));
    // Without a display, or without OpenGL there, there is nothing to draw on.
    auto* const plugin = static_cast<Plugin*>(getPluginInstancePointer());
    if (plugin == nullptr || getContext() == nullptr || !loadSharedResources()) return;
    window_.emplace(*static_cast<contactspline::WindowedPlugin*>(plugin), static_cast<WindowHost&>(*this));
  }

 private:
  using WindowHost = contactspline::WindowHost;
  static constexpr unsigned kWidth = contactspline::InstrumentWindow::kWidth;
  static constexpr unsigned kHeight = contactspline::InstrumentWindow::kHeight;

  // The window itself looks at what the framework would pass on.
  void parameterChanged(uint32_t, float) override {}
  void programLoaded(uint32_t) override {}
#if DISTRHO_PLUGIN_WANT_STATE
  void stateChanged(const char*, const char*) override {}
#endif

  void uiIdle() override {
    if (window_ && (window_->update() || new_frames_ > 0)) repaint();
  }

  void onNanoDisplay() override {
    if (!window_) return;
    glDepthMask(GL_FALSE);  // nothing has a depth, and the framework need not clear it for each picture
    const unsigned width = getWidth(), height = getHeight();
    // A server may resize the window some frames after it has said so: until then what is drawn is cut.
    if (!ground_.has(width, height)) new_frames_ = 10;
    if (window_->is_ground_old() || new_frames_ > 0) {
      if (new_frames_ > 0) --new_frames_;
      contactspline::Canvas::clear(contactspline::colours::kBackground);
      auto canvas = on_canvas();
      window_->draw_ground(canvas);
      NanoVG::endFrame();
      ground_.keep(width, height);
      NanoVG::beginFrame(width, height);
    } else {
      ground_.show();
    }
    auto canvas = on_canvas();
    window_->draw_figure(canvas);
  }

  bool onMouse(const MouseEvent& event) override {
    if (!window_ || event.button != 1) return false;
    if (event.press)
      window_->press(across(event.pos.getX()), down(event.pos.getY()), event.time / 1000.0);
    else
      window_->release();
    return true;
  }
  bool onMotion(const MotionEvent& event) override {
    if (window_)
      window_->move(across(event.pos.getX()), down(event.pos.getY()),
                    (event.mod & DGL_NAMESPACE::kModifierShift) != 0);
    return false;
  }
  bool onScroll(const ScrollEvent& event) override {
    if (window_) window_->scroll(across(event.pos.getX()), down(event.pos.getY()), event.delta.getY());
    return true;
  }

  void edit(std::size_t parameter, bool is_moving) override {
    editParameter(static_cast<uint32_t>(parameter), is_moving);
  }
  void set(std::size_t parameter, double value) override {
    setParameterValue(static_cast<uint32_t>(parameter), static_cast<float>(value));
  }
  void play(int key, int velocity) override {
    sendNote(0, static_cast<uint8_t>(key), static_cast<uint8_t>(velocity));
  }

  contactspline::Canvas on_canvas() {
    return {*this, offset(getWidth(), kWidth), offset(getHeight(), kHeight), factor(), getHeight()};
  }

  // The window keeps its proportions in the middle of what the host gives.
  [[nodiscard]] float factor() const {
    return std::min(static_cast<float>(getWidth()) / kWidth, static_cast<float>(getHeight()) / kHeight);
  }
  [[nodiscard]] float offset(unsigned given, unsigned used) const {
    return (static_cast<float>(given) - static_cast<float>(used) * factor()) / 2;
  }
  [[nodiscard]] double across(double x) const {
    return (x - offset(getWidth(), kWidth)) / factor();
  }
  [[nodiscard]] double down(double y) const {
    return (y - offset(getHeight(), kHeight)) / factor();
  }

  std::optional<contactspline::InstrumentWindow> window_;
  contactspline::KeptFigure ground_;
  int new_frames_ = 0;  // to draw after a new size
};

UI* createUI() {
  return new InstrumentUI;
}

END_NAMESPACE_DISTRHO
