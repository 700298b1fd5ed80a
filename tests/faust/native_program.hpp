// SPDX-License-Identifier: MIT
// Programs of Faust's C and LLVM back ends, loaded from a shared library by the name of their class.
#pragma once

#include <dlfcn.h>

#include <cstddef>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "c_glue.h"
#include "faust_program.hpp"

namespace contactspline::testing {

/// A shared library, open as long as this lives.
class Library {
 public:
  explicit Library(const std::string& path) : handle_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (handle_ == nullptr) throw std::runtime_error(dlerror());
  }
  ~Library() { dlclose(handle_); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  /// Function of that name; throws where there is none.
  template <typename Function>
  [[nodiscard]] Function* function(const std::string& name) const {
    void* symbol = dlsym(handle_, name.c_str());
    if (symbol == nullptr) throw std::runtime_error(dlerror());
    return reinterpret_cast<Function*>(symbol);
  }

 private:
  void* handle_;
};

/// A program of the C back end.
template <std::floating_point T>
class CProgram : public FaustProgram<T> {
 public:
  CProgram(const Library& library, const std::string& name, int sample_rate_hz)
      : dsp_(library.function<void*()>("new" + name)(), library.function<void(void*)>("delete" + name)),
        input_count_(library.function<int(void*)>("getNumInputs" + name)(dsp_.get())),
        output_count_(library.function<int(void*)>("getNumOutputs" + name)(dsp_.get())),
        compute_(library.function<void(void*, int, T**, T**)>("compute" + name)) {
    library.function<void(void*, int)>("init" + name)(dsp_.get(), sample_rate_hz);
    UIGlue ui{this,
              [](void*, const char*) {},
              [](void*) {},
              [](void*, void*, const char*, const char*) {},
              [](void* self, const char* label, void* zone) { remember(self, label, zone); },
              [](void* self, const char* label, void* zone, double, double, double, double) {
                remember(self, label, zone);
              }};
    library.function<void(void*, UIGlue*)>("buildUserInterface" + name)(dsp_.get(), &ui);
  }

  void set(const std::string& label, T value) override { *zones_.at(label) = value; }

 protected:
  [[nodiscard]] std::size_t input_count() override { return static_cast<std::size_t>(input_count_); }
  [[nodiscard]] std::size_t output_count() override { return static_cast<std::size_t>(output_count_); }
  void compute(int samples, T** inputs, T** outputs) override { compute_(dsp_.get(), samples, inputs, outputs); }

 private:
  static void remember(void* self, const char* label, void* zone) {
    static_cast<CProgram*>(self)->zones_[label] = static_cast<T*>(zone);
  }

  std::unique_ptr<void, void (*)(void*)> dsp_;
  int input_count_, output_count_;
  void (*compute_)(void*, int, T**, T**);
  std::map<std::string, T*> zones_;
};

/// A program of the LLVM back end: its JSON tells its size and where the controls lie.
template <std::floating_point T>
class LlvmProgram : public FaustProgram<T> {
 public:
  LlvmProgram(const Library& library, const std::string& name, int sample_rate_hz)
      : description_(nlohmann::json::parse(library.function<const char*()>("getJSON" + name)())),
        memory_(description_.at("size").get<std::size_t>() / sizeof(std::max_align_t) + 1),
        compute_(library.function<void(void*, int, T**, T**)>("compute" + name)) {
    library.function<void(int)>("classInit" + name)(sample_rate_hz);
    library.function<void(void*, int)>("instanceConstants" + name)(memory_.data(), sample_rate_hz);
    library.function<void(void*)>("instanceClear" + name)(memory_.data());
    for (const auto& control : controls()) store(control, control.value("init", T(0)));
  }

  void set(const std::string& label, T value) override {
    for (const auto& control : controls())
      if (control.at("label") == label) {
        store(control, value);
        return;
      }
    throw std::out_of_range("no control " + label);
  }

 protected:
  [[nodiscard]] std::size_t input_count() override { return description_.at("inputs"); }
  [[nodiscard]] std::size_t output_count() override { return description_.at("outputs"); }
  void compute(int samples, T** inputs, T** outputs) override { compute_(memory_.data(), samples, inputs, outputs); }

 private:
  [[nodiscard]] const nlohmann::json& controls() const { return description_.at("ui").at(0).at("items"); }
  // The program's memory is packed: a control may lie at any address.
  void store(const nlohmann::json& control, T value) {
    auto* const memory = reinterpret_cast<std::byte*>(memory_.data());
    std::memcpy(memory + control.at("index").get<std::size_t>(), &value, sizeof value);
  }

  nlohmann::json description_;
  std::vector<std::max_align_t> memory_;
  void (*compute_)(void*, int, T**, T**);
};

}  // namespace contactspline::testing
