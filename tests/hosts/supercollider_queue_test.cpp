// SPDX-License-Identifier: MIT
// ContactInstrument in a server that takes no command, or that never carries one out, as scsynth does where its queue
// is full. The server itself cannot be brought there on purpose.
#include <SC_PlugIn.h>
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace {

constexpr double kRate_hz = 48000;
constexpr int kBlock = 64;

enum class Commands { kAreCarriedOut, kAreLost, kAreRefused };

/// What the plug-in calls of a server.
struct Server {
  std::string printed;
  int allocated = 0;
  Commands commands = Commands::kAreCarriedOut;
  std::size_t unit_bytes = 0;
  UnitCtorFunc begin = nullptr;
  UnitDtorFunc end = nullptr;
};
Server server;

int print(const char* format, ...) {
  std::array<char, 1000> text{};
  va_list values;
  va_start(values, format);
  const int length = std::vsnprintf(text.data(), text.size(), format, values);
  va_end(values);
  server.printed += text.data();
  return length;
}

bool define(const char*, size_t bytes, UnitCtorFunc begin, UnitDtorFunc end, uint32) {
  server.unit_bytes = bytes;
  server.begin = begin;
  server.end = end;
  return true;
}

void clear(Unit* unit, int samples) {
  for (std::uint32_t o = 0; o < unit->mNumOutputs; ++o) std::fill_n(unit->mOutBuf[o], samples, 0.0f);
}

void* allocate(World*, size_t bytes) {
  ++server.allocated;
  return std::malloc(bytes);
}

void release(World*, void* memory) {
  --server.allocated;
  std::free(memory);
}

int command(World* world, void*, const char*, void* data, AsyncStageFn second, AsyncStageFn third,
            AsyncStageFn fourth, AsyncFreeFn cleanup, int, void*) {
  if (server.commands == Commands::kAreRefused) return -1;
  if (server.commands == Commands::kAreLost) return 0;
  if (second(world, data) && third(world, data)) fourth(world, data);
  cleanup(world, data);
  return 0;
}

void load_plugin() {
  static InterfaceTable table{};
  table.fPrint = print;
  table.fDefineUnit = define;
  table.fClearUnitOutputs = clear;
  table.fRTAlloc = allocate;
  table.fRTFree = release;
  table.fDoAsynchronousCommand = command;
  void* const library = dlopen(SUPERCOLLIDER_PLUGIN, RTLD_NOW | RTLD_LOCAL);
  ASSERT_NE(library, nullptr) << dlerror();
  reinterpret_cast<void (*)(InterfaceTable*)>(dlsym(library, "load"))(&table);
}

/// A unit that plays one output of the tom, from its beginning to its end.
class Synth {
 public:
  Synth() : memory_(server.unit_bytes + sizeof(Unit)), wires_(values_.size()), wire_(wires_.size()) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      wires_[i].mCalcRate = calc_ScalarRate;
      wire_[i] = &wires_[i];
      inputs_.push_back(&values_[i]);
    }
    rate_.mSampleRate = kRate_hz;
    unit()->mNumInputs = static_cast<std::uint32_t>(values_.size());
    unit()->mNumOutputs = 1;
    unit()->mInput = wire_.data();
    unit()->mInBuf = inputs_.data();
    unit()->mOutBuf = &output_;
    unit()->mRate = &rate_;
    server.begin(unit());
  }
  Synth(const Synth&) = delete;
  Synth& operator=(const Synth&) = delete;
  ~Synth() { server.end(unit()); }

  void play(double seconds) {
    for (double left = seconds * kRate_hz; left > 0; left -= kBlock) unit()->mCalcFunc(unit(), kBlock);
  }

 private:
  [[nodiscard]] Unit* unit() { return reinterpret_cast<Unit*>(memory_.data()); }

  std::vector<char> memory_;
  std::vector<float> values_ = {3, 't', 'o', 'm', 1, 4, 'l', 'e', 'f', 't', 0, 0, 0};
  std::vector<Wire> wires_;
  std::vector<Wire*> wire_;
  std::vector<float*> inputs_;
  std::array<float, kBlock> samples_{};
  float* output_ = samples_.data();
  Rate rate_{};
};

class SuperColliderQueue : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { load_plugin(); }
  SuperColliderQueue() {
    server.printed.clear();
    server.allocated = 0;
    server.commands = Commands::kAreCarriedOut;
  }

  static void expect_one_line(std::string_view says) {
    EXPECT_NE(server.printed.find(says), std::string::npos) << server.printed;
    EXPECT_EQ(std::ranges::count(server.printed, '\n'), 1) << server.printed;
  }
};

TEST_F(SuperColliderQueue, ThatIsFullIsToldOnce) {
  server.commands = Commands::kAreLost;
  Synth synth;
  synth.play(29);
  EXPECT_EQ(server.printed, "");
  synth.play(60);
  expect_one_line("contactspline: tom: is not made after 30 s, maybe as the server's queue of commands was full");
}

TEST_F(SuperColliderQueue, ThatTakesNoCommandIsTold) {
  server.commands = Commands::kAreRefused;
  {
    Synth synth;
    expect_one_line("contactspline: tom: cannot be made, as the server takes no command");
    synth.play(60);
  }
  expect_one_line("contactspline: tom: cannot be made");
  EXPECT_EQ(server.allocated, 0);
}

TEST_F(SuperColliderQueue, ThatTakesNoCommandAtTheEndCostsNothing) {
  {
    Synth synth;
    synth.play(0.1);
    server.commands = Commands::kAreRefused;
  }
  EXPECT_EQ(server.printed, "");
  EXPECT_EQ(server.allocated, 0);
}

}  // namespace
