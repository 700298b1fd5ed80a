// SPDX-License-Identifier: MIT
#include "bench/baselines/fd_hammer.hpp"

#include <math.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

// The generated C++ in each precision. It expects the names dsp, Meta and UI, so each precision has its own
// namespace.
#define CONTACTSPLINE_FAUST_NAMES                                                                       \
  struct dsp {                                                                                          \
    virtual ~dsp() = default;                                                                           \
    virtual void init(int sample_rate) = 0;                                                             \
    virtual void buildUserInterface(struct UI* ui) = 0;                                                 \
    virtual void compute(int count, FAUSTFLOAT** inputs, FAUSTFLOAT** outputs) = 0;                     \
  };                                                                                                    \
  struct Meta {                                                                                         \
    void declare(const char*, const char*) {}                                                           \
  };                                                                                                    \
  struct UI {                                                                                           \
    void openVerticalBox(const char*) {}                                                                \
    void closeBox() {}                                                                                  \
    void addButton(const char*, FAUSTFLOAT* zone) { button = zone; }                                    \
    void addHorizontalSlider(const char*, FAUSTFLOAT* zone, FAUSTFLOAT initial, FAUSTFLOAT, FAUSTFLOAT, \
                             FAUSTFLOAT) {                                                              \
      *zone = initial;                                                                                  \
    }                                                                                                   \
    FAUSTFLOAT* button = nullptr;                                                                       \
  };

namespace contactspline::bench::faust_double {
#define FAUSTFLOAT double
CONTACTSPLINE_FAUST_NAMES
#include "fd_hammer_c2_double.hpp"
#include "fd_hammer_c4_double.hpp"
#undef FAUSTFLOAT
}  // namespace contactspline::bench::faust_double
namespace contactspline::bench::faust_float {
#define FAUSTFLOAT float
CONTACTSPLINE_FAUST_NAMES
#include "fd_hammer_c2_single.hpp"
#include "fd_hammer_c4_single.hpp"
#undef FAUSTFLOAT
}  // namespace contactspline::bench::faust_float

namespace contactspline::bench {
namespace {

template <std::floating_point T>
struct FaustNames;
template <>
struct FaustNames<double> {
  using Dsp = faust_double::dsp;
  using Ui = faust_double::UI;
  using C2 = faust_double::fd_hammer_c2_double;
  using C4 = faust_double::fd_hammer_c4_double;
};
template <>
struct FaustNames<float> {
  using Dsp = faust_float::dsp;
  using Ui = faust_float::UI;
  using C2 = faust_float::fd_hammer_c2_single;
  using C4 = faust_float::fd_hammer_c4_single;
};

}  // namespace

template <std::floating_point T>
class FdHammerString<T>::Program {
 public:
  Program(FdString string, int sample_rate_hz) {
    if (string == FdString::c2)
      dsp_ = std::make_unique<typename FaustNames<T>::C2>();
    else
      dsp_ = std::make_unique<typename FaustNames<T>::C4>();
    dsp_->init(sample_rate_hz);
    dsp_->buildUserInterface(&ui_);
  }

  void press(bool down) { *ui_.button = down; }
  void process(std::span<T> out) {
    T* output = out.data();
    dsp_->compute(static_cast<int>(out.size()), nullptr, &output);
  }

 private:
  std::unique_ptr<typename FaustNames<T>::Dsp> dsp_;
  typename FaustNames<T>::Ui ui_;
};

template <std::floating_point T>
FdHammerString<T>::FdHammerString(FdString string, int sample_rate_hz)
    : program_(std::make_unique<Program>(string, sample_rate_hz)) {}
template <std::floating_point T>
FdHammerString<T>::FdHammerString(FdHammerString&&) noexcept = default;
template <std::floating_point T>
FdHammerString<T>::~FdHammerString() = default;

template <std::floating_point T>
void FdHammerString<T>::strike() {
  program_->press(true);
}

template <std::floating_point T>
void FdHammerString<T>::process(std::span<T> out) {
  program_->process(out);
  program_->press(false);  // only the change from released to pressed throws the hammer
}

template class FdHammerString<double>;
template class FdHammerString<float>;

}  // namespace contactspline::bench
