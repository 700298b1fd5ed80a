// SPDX-License-Identifier: MIT
// A display without a screen, and a window of a host in it that a plug-in's window is put into.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "plugins/child_process.hpp"
#include "plugins/x11.hpp"

namespace contactspline::testing {

struct Pixel {
  int red, green, blue;
  friend bool operator==(const Pixel&, const Pixel&) = default;
};

struct Photo {
  int width, height;
  std::vector<Pixel> pixels;

  [[nodiscard]] const Pixel& at(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)]; }
  [[nodiscard]] std::size_t count(const Pixel& pixel) const {
    return static_cast<std::size_t>(std::count(pixels.begin(), pixels.end(), pixel));
  }
  /// As a PPM file.
  void write(const std::filesystem::path& file) const {
    std::ofstream out(file, std::ios::binary);
    out << "P6\n" << width << ' ' << height << "\n255\n";
    for (const Pixel& pixel : pixels)
      for (const int value : {pixel.red, pixel.green, pixel.blue}) out.put(static_cast<char>(value));
  }
};

/// What a window shows, with all that stands in it. Throws if it has gone.
[[nodiscard]] inline Photo photo_of(Display* display, Window window) {
  XWindowAttributes attributes;
  XImage* image = nullptr;
  if (XGetWindowAttributes(display, window, &attributes) != 0)
    image = XGetImage(display, window, 0, 0, static_cast<unsigned>(attributes.width),
                      static_cast<unsigned>(attributes.height), AllPlanes, ZPixmap);
  if (image == nullptr) throw std::runtime_error("no photo");
  Photo photo{attributes.width, attributes.height, {}};
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const unsigned long value = XGetPixel(image, x, y);
      photo.pixels.push_back(
          {static_cast<int>(value >> 16 & 255), static_cast<int>(value >> 8 & 255), static_cast<int>(value & 255)});
    }
  XDestroyImage(image);
  return photo;
}

/// Xvfb, at the first number that is free.
class VirtualDisplay {
 public:
  VirtualDisplay()
      : log_(std::filesystem::temp_directory_path() / ("contactspline_xvfb_" + std::to_string(getpid()))),
        server_({"Xvfb", "-displayfd", "1", "-screen", "0", "2048x1400x24", "-nolisten", "tcp"}, log_) {
    for (int wait = 0; wait < 1000 && display_ == nullptr; ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      const std::string number = told_number();
      if (!server_.is_running()) break;
      if (number.empty()) continue;
      setenv("DISPLAY", (":" + number).c_str(), 1);
      display_ = XOpenDisplay(nullptr);
    }
    if (display_ == nullptr) throw std::runtime_error("Xvfb does not start");
  }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
  ~VirtualDisplay() {
    XCloseDisplay(display_);
    std::filesystem::remove(log_);
  }

  [[nodiscard]] Display* get() const { return display_; }
  [[nodiscard]] pid_t process() const { return server_.process(); }
  /// Of each window of this size that is on the screen, whoever has opened it.
  [[nodiscard]] std::vector<Photo> photos(int width, int height) const {
    std::vector<Photo> photos;
    add_photos(DefaultRootWindow(display_), width, height, photos);
    return photos;
  }

 private:
  void add_photos(Window window, int width, int height, std::vector<Photo>& photos) const {
    XWindowAttributes attributes;
    if (XGetWindowAttributes(display_, window, &attributes) == 0 || attributes.map_state != IsViewable) return;
    if (attributes.width == width && attributes.height == height) try {
        photos.push_back(photo_of(display_, window));
      } catch (const std::runtime_error&) {  // it has gone meanwhile
      }
    Window root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    XQueryTree(display_, window, &root, &parent, &children, &count);
    for (unsigned i = 0; i < count; ++i) add_photos(children[i], width, height, photos);
    if (children != nullptr) XFree(children);
  }

  // The line that is a number; others are messages.
  [[nodiscard]] std::string told_number() const {
    std::ifstream log(log_);
    for (std::string line; std::getline(log, line);)
      if (!line.empty() && line.find_first_not_of("0123456789") == std::string::npos) return line;
    return {};
  }

  std::filesystem::path log_;
  ChildProcess server_;
  Display* display_ = nullptr;
};

/// A window of the host. What stands in it gets the events.
class HostWindow {
 public:
  HostWindow(const VirtualDisplay& display, unsigned width, unsigned height)
      : display_(display.get()),
        window_(XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, width, height, 0, 0, 0)) {
    XMapWindow(display_, window_);
    XSync(display_, False);
  }
  HostWindow(const HostWindow&) = delete;
  HostWindow& operator=(const HostWindow&) = delete;
  ~HostWindow() {
    XDestroyWindow(display_, window_);
    XSync(display_, False);
  }

  [[nodiscard]] Window get() const { return window_; }

  void resize(unsigned width, unsigned height) {
    XResizeWindow(display_, window_, width, height);
    XSync(display_, False);
  }

  /// What stands in it, as hosts of LV2 do.
  void resize_inner(unsigned width, unsigned height) {
    XResizeWindow(display_, inner(), width, height);
    XSync(display_, False);
  }

  void button(int x, int y, bool is_down) { send(is_down ? ButtonPress : ButtonRelease, x, y); }
  void motion(int x, int y) { send(MotionNotify, x, y); }

  /// The size of the window that stands in this one.
  [[nodiscard]] std::pair<int, int> inner_size() const {
    XWindowAttributes attributes;
    XGetWindowAttributes(display_, inner(), &attributes);
    return {attributes.width, attributes.height};
  }

  [[nodiscard]] Photo photo() const { return photo_of(display_, window_); }

 private:
  [[nodiscard]] Window inner() const {
    Window root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    XQueryTree(display_, window_, &root, &parent, &children, &count);
    const Window found = count > 0 ? children[0] : 0;
    if (children != nullptr) XFree(children);
    if (found == 0) throw std::runtime_error("nothing stands in the window");
    return found;
  }

  void send(int type, int x, int y) {
    XEvent event = {};
    event.type = type;
    event.xbutton.display = display_;
    event.xbutton.window = inner();
    event.xbutton.root = DefaultRootWindow(display_);
    event.xbutton.time = time_ += 500;  // [ms]: no two presses are a double one
    event.xbutton.x = event.xbutton.x_root = x;
    event.xbutton.y = event.xbutton.y_root = y;
    event.xbutton.same_screen = True;
    if (type != MotionNotify) event.xbutton.button = Button1;
    const long mask = type == MotionNotify  ? PointerMotionMask
                      : type == ButtonPress ? ButtonPressMask
                                            : ButtonReleaseMask;
    XSendEvent(display_, inner(), False, mask, &event);
    XSync(display_, False);
  }

  Display* display_;
  Window window_;
  Time time_ = 1000;
};

}  // namespace contactspline::testing
