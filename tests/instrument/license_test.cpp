// SPDX-License-Identifier: MIT
// The licence of an instrument file, read and emitted.
#include "generator/emit/emit_instrument.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline::testing {
namespace {

InstrumentModel instrument(const std::string& license) {
  return parse_instrument(R"({ "name": "probe", )" + license + R"(
    "bodies": [ { "name": "string", "resonator": "string_c4" } ],
    "outputs": [ { "name": "bridge", "end_force_n": "string" } ] })",
                          "probe.json");
}

std::string emitted(const InstrumentModel& model, std::string_view format) {
  for (const Emitter& emitter : emitters())
    if (emitter.name == format) return emit(emitter, model, 5000, "test");
  return "";
}

const std::string kTag = "// SPDX-License-Identifier";  // without what would be a licence of this file

TEST(LicenseOfAnInstrument, IsInEverythingThatIsEmitted) {
  const InstrumentModel model = instrument(R"("license": "CC-BY-4.0",)");
  EXPECT_NE(emitted(model, "cpp").find(kTag + ": CC-BY-4.0\n"), std::string::npos);
  EXPECT_NE(emitted(model, "cpp").find(R"(return {"probe", "", "CC-BY-4.0", )"), std::string::npos);
  EXPECT_NE(emitted(model, "faust").find(R"(declare license "CC-BY-4.0";)"), std::string::npos);
  EXPECT_NE(emitted(model, "json").find(R"("license": "CC-BY-4.0")"), std::string::npos);
}

TEST(LicenseOfAnInstrument, IsMitWhereTheFileSaysNothing) {
  EXPECT_EQ(instrument("").license, "MIT");
  EXPECT_NE(emitted(instrument(""), "cpp").find(kTag + ": MIT\n"), std::string::npos);
}

TEST(LicenseOfAnInstrument, IsAnIdentifier) {
  EXPECT_EQ(instrument("\"license\": \"MIT OR (Apache-2.0 AND GPL-2.0+)\",").license,
            "MIT OR (Apache-2.0 AND GPL-2.0+)");
  for (const char* text : {"", "my \\\"own\\\"", "a\\nb", "*/ #error", "\xc2\xa9"}) {
    try {
      (void)instrument(R"("license": ")" + std::string(text) + R"(",)");
      ADD_FAILURE() << "accepted: " << text;
    } catch (const BadInput& error) {
      EXPECT_NE(std::string(error.what()).find("license: "), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
