// SPDX-License-Identifier: MIT
// The functions of MTS-ESP's library that plug-ins ask for, and others for the test that tunes. The names are those
// of its interface.
#include <array>
#include <atomic>
#include <cmath>

namespace {

std::atomic<int> clients = 0;
std::atomic<bool> is_master = false;
std::array<bool, 128> left_out;
std::array<double, 128> table_hz = [] {
  std::array<double, 128> equal;
  for (int key = 0; key < 128; ++key) equal[static_cast<unsigned>(key)] = 440 * std::exp2((key - 69) / 12.0);
  return equal;
}();

}  // namespace

extern "C" {
void MTS_RegisterClient() {
  ++clients;
}
void MTS_DeregisterClient() {
  --clients;
}
bool MTS_HasMaster() {
  return is_master;
}
const double* MTS_GetTuningTable() {
  return table_hz.data();
}
bool MTS_ShouldFilterNote(char key, char) {
  return left_out[static_cast<unsigned char>(key)];
}

void stub_set_master(bool value) {
  is_master = value;
}
void stub_tune(int key, double frequency_hz) {
  table_hz[static_cast<unsigned>(key)] = frequency_hz;
}
void stub_leave_out(int key) {
  left_out[static_cast<unsigned>(key)] = true;
}
int stub_clients() {
  return clients;
}
}
