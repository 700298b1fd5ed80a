// SPDX-License-Identifier: MIT
// Every LV2 plug-in in jalv, by its console: a preset loaded, a parameter set, a note played, a state restored in a
// new process. Skipped where jalv is not installed.
#include <sstream>

#include "plugins/agreement.hpp"
#include "plugins/jack_server.hpp"
#include "plugins/lv2_plugin.hpp"
#include "support/compare.hpp"

// Not counted here.
constinit thread_local std::size_t contactspline::testing::allocations = 0, contactspline::testing::locks = 0;

namespace contactspline::testing {
namespace {

/// jalv with one plug-in, until the end of the test.
class Console {
 public:
  Console(std::vector<std::string> arguments, std::string log) : log_(std::move(log)), jalv_(with(arguments), log_) {
    const Client client = open_client();
    const bool starts = becomes_true(
        [&] { return !jalv_.is_running() || jack_port_by_name(client.get(), "jalv:lv2_audio_out_1") != nullptr; });
    if (!starts || !jalv_.is_running()) throw std::runtime_error("jalv: " + text_of(log_));
  }

  /// What it prints until it prints some text.
  std::string ask(const std::string& command, const std::string& last) {
    const std::size_t before = text_of(log_).size();
    jalv_.write(command + "\n");
    if (!becomes_true([&] { return text_of(log_).find(last, before) != std::string::npos; }))
      throw std::runtime_error(command + ": " + text_of(log_));
    std::this_thread::sleep_for(50ms);  // the rest of the line
    return text_of(log_).substr(before);
  }

  /// The values by symbol, as it prints them.
  std::map<std::string, double> controls(const std::string& last_symbol) {
    std::istringstream text(ask("controls", last_symbol + " = "));
    std::map<std::string, double> values;
    for (std::string line; std::getline(text, line);) {
      line.erase(0, line.find_first_not_of("> "));
      if (const std::size_t is = line.find(" = "); is != std::string::npos)
        values[line.substr(0, is)] = std::stod(line.substr(is + 3));
    }
    return values;
  }

 private:
  static std::vector<std::string> with(std::vector<std::string> arguments) {
    // Its output is a file: line by line.
    std::vector<std::string> command = {"stdbuf", "-oL", "jalv", "-x", "-n", "jalv"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }

  std::string log_;
  ChildProcess jalv_;
};

class Jalv : public JackTest {
 protected:
  void SetUp() override {
    if (std::system("command -v jalv > /dev/null") != 0)
      GTEST_SKIP() << "jalv is not installed: scripts/install-packages studio";
    JackTest::SetUp();
  }
};

std::vector<std::string> names() {
  std::istringstream list(CONTACTSPLINE_PLUGINS);
  return {std::istream_iterator<std::string>(list), {}};
}
INSTANTIATE_TEST_SUITE_P(ThatShips, Jalv, ::testing::ValuesIn(names()), [](const auto& test) { return test.param; });

TEST_P(Jalv, PlaysAndRestores) {
  const Lv2World world;
  const std::string uri = "urn:contactspline:contactspline_" + GetParam();
  Lv2Plugin reference(world, uri, kRate);
  std::vector<Lv2Port> inputs;
  for (const Lv2Port& port : reference.ports())
    if (port.is_control && port.is_input) inputs.push_back(port);
  const std::string moved = inputs.front().symbol, last = inputs.back().symbol;
  const double value = (inputs.front().initial + inputs.front().max) / 2;
  std::map<std::string, double> controls;
  {
    Console jalv({uri}, folder_ + "/jalv.log");
    // The last of the presets: both list them by name and by URI.
    const std::size_t preset = reference.programs().size() - 1;
    reference.load_program(preset);
    std::string preset_uri;
    std::istringstream presets(jalv.ask("presets", "(" + reference.programs()[preset] + ")"));
    for (std::string line; std::getline(presets, line);)
      if (line.find("(" + reference.programs()[preset] + ")") != std::string::npos)
        preset_uri = line.substr(line.find(uri), line.find(' ', line.find(uri)) - line.find(uri));
    jalv.ask("preset " + preset_uri, ">");
    std::ostringstream set;
    set << "set " << moved << ' ' << value;
    jalv.ask(set.str(), moved + " = ");
    reference.set(moved, value);
    controls = jalv.controls(last);
    ASSERT_EQ(controls.size(), inputs.size());
    // It prints six digits behind the point.
    for (const auto& [symbol, shown] : controls) EXPECT_TRUE(within(shown, reference.value(symbol), 1e-6)) << symbol;

    // A note. What it plays arrives a period or two later.
    constexpr std::size_t kPeriod = 512, kOn = 10 * kPeriod, kEnd = kRate / 2 / kPeriod * kPeriod;
    Player player(open_client(), {{kOn, {0x90, 60, 100}}}, kEnd);
    ASSERT_TRUE(player.play("jalv:lv2_events_in", "jalv:lv2_audio_out_1"));
    (void)reference.run(2 * kRate / HostedPlugin::kBlock);  // it has run as long as parameters glide
    reference.send(0, {0x90, 60, 100});
    const auto expected = reference.run((kEnd - kOn) / HostedPlugin::kBlock)[0];
    double best_db = 0;
    for (const std::size_t delay : {std::size_t(0), kPeriod, 2 * kPeriod}) {
      const std::size_t length = expected.size() - delay;
      const double db =
          agreement_db(player.sound().subspan(kOn + delay, length), std::span<const float>(expected).first(length));
      if (!(db <= best_db)) best_db = db;
    }
    EXPECT_GT(best_db, 80);
    std::printf("%s: %.1f dB\n", GetParam().c_str(), best_db);
  }
  reference.save_into(folder_);
  Console again({"-l", folder_}, folder_ + "/again.log");
  EXPECT_EQ(again.controls(last), controls);
}

}  // namespace
}  // namespace contactspline::testing
