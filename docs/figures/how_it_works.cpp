// SPDX-License-Identifier: MIT
// how_it_works FOLDER [WAV...]: numbers of the figures of docs/how-it-works as columns of text (scripts/figures). Of
// each WAV file, stereo with 24 bits, the spectrum of the left side.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "coarse.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/modal/stretching_bank.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/resonators/soundboard.hpp"
#include "contactspline/tangent/mass_barrier_tangent.hpp"
#include "frame_drum.hpp"

namespace {

using namespace contactspline;

constexpr double kRate = 44100;
constexpr auto& kFelt = segments_of<materials::felt_c4, double>;

std::ofstream file_in(const std::string& folder, const char* name) {
  std::ofstream file(folder + "/" + name);
  file.precision(10);
  return file;
}

// A table of six segments: its knots and forces; the discrete gradient and the line of the bodies over the motion in
// a sample; the contact step, which is where they meet.
void one_step(const std::string& folder) {
  constexpr auto& coarse = segments_of<materials::coarse, double>;
  const SegmentTable<double> table(coarse);
  const Approach<double> approach{3e-4, 5e-4, 2e-5};
  const auto& [y0, xf, xi] = approach;
  auto knots = file_in(folder, "knots"), curves = file_in(folder, "step"), root = file_in(folder, "root");
  for (const auto& segment : table) knots << segment.knot << ' ' << segment.force << '\n';
  const double end = materials::coarse::max_compression_m;
  knots << end << ' ' << force(table, end) << '\n';
  for (double x = -4e-4 + 1e-9; x < 6e-4; x += 4e-6)
    curves << x << ' ' << (potential(table, y0 + x) - potential(table, y0)) / x << ' ' << (xf - x) / xi << '\n';
  const auto step = contact_step(table, approach);
  root << step.compression - y0 << ' ' << step.force << '\n';
}

// A hammer that meets a barrier, over the stiffness ratio: the largest speed after the blow over that before it, of
// 16 places of the first touch between two samples. By the contact step, and by an explicit step on the same table
// (symplectic Euler).
void stable(const std::string& folder) {
  constexpr double kMass = 0.00297, kSpeed = 2.5, kStep = 1 / kRate;
  const SegmentTable<double> table(kFelt);
  auto file = file_in(folder, "stable");
  for (double ratio = 1e-2; ratio < 1.01e6; ratio *= std::pow(10, 0.05)) {
    double ours = 0, explicit_step = 0;
    for (int phase = 0; phase < 16; ++phase) {
      const double begin = -1e-4 - kSpeed * kStep * phase / 16;
      MassBarrier<double> hammer(table, kRate);
      hammer.throw_from(begin, kSpeed);
      double y = begin, v = kSpeed;
      for (int n = 0; n < 2000; ++n) {
        hammer.tick({.mass_kg = kMass, .contact = {.stiffness_ratio = ratio}});
        if (v > 0 || y > 0) {
          v -= kStep * ratio * force(table, y) / kMass;
          y += kStep * v;
        }
      }
      ours = std::max(ours, -hammer.velocity() / kSpeed);
      explicit_step = std::max(explicit_step, -v / kSpeed);
    }
    file << ratio << ' ' << ours << ' ' << explicit_step << '\n';
  }
}

// Force on a barrier [N] and its derivatives by the speed [N s/m] and by the logarithm of the stiffness [N], each
// beside the difference of two throws.
void gradient(const std::string& folder) {
  constexpr double kMass = 0.00297, kSpeed = 2.5, kDifference = 1e-5;
  const auto force = [&](double speed, double stiffness) {
    std::vector<double> samples;
    MassBarrier<double> hammer(kFelt, kRate);
    hammer.throw_from(-0.0005, speed);
    for (int n = 0; n < 50; ++n) {
      hammer.tick({.mass_kg = kMass, .contact = {.stiffness_ratio = stiffness}});
      samples.push_back(hammer.force());
    }
    return samples;
  };
  std::array<ThrowNumbers<double>, 2> directions;
  directions[0].velocity_m_per_s = 1;
  directions[1].contact.stiffness_ratio = 1;
  MassBarrierTangent<double, 2> tangent(kFelt, kRate, {.mass_kg = kMass}, directions);
  tangent.throw_from(-0.0005, kSpeed);
  const auto faster = force(kSpeed + kDifference, 1), slower = force(kSpeed - kDifference, 1);
  const auto stiffer = force(kSpeed, 1 + kDifference), softer = force(kSpeed, 1 - kDifference);
  auto file = file_in(folder, "gradient");
  for (std::size_t n = 0; n < faster.size(); ++n) {
    tangent.tick();
    file << 1e3 * static_cast<double>(n) / kRate << ' ' << tangent.force().value << ' ' << tangent.force().slopes[0]
         << ' ' << tangent.force().slopes[1] << ' ' << (faster[n] - slower[n]) / (2 * kDifference) << ' '
         << (stiffer[n] - softer[n]) / (2 * kDifference) << '\n';
  }
}

// A string over twelve points of a curved bridge: the force of each point [N], and the steps of the solver in each
// sample.
void bridge(const std::string& folder) {
  constexpr std::size_t kPoints = 12, kModes = 60;
  std::vector<Mode> modes;
  for (int i = 1; i <= int(kModes); ++i)
    modes.push_back({2 * std::numbers::pi * 131 * i, 0.5 + 5e-4 * i * i, 2.7e-4});
  const auto shapes_at = [](double part) {
    std::vector<double> shapes;
    for (int i = 1; i <= int(kModes); ++i) shapes.push_back(std::sin(std::numbers::pi * i * part));
    return shapes;
  };
  NetworkPlan<double> plan;
  const std::size_t string = plan.add_body(modes), pluck = plan.add_place(string, shapes_at(0.3));
  std::vector<std::size_t> places;
  std::vector<double> gaps, weights(kPoints, 1.0 / kPoints);
  for (std::size_t k = 0; k < kPoints; ++k) {
    const double part = (static_cast<double>(k) + 0.5) / kPoints;
    places.push_back(plan.add_place(string, shapes_at(0.022 * part)));
    gaps.push_back(8e-5 * part * part);
  }
  const ConnectionRange contacts =
      plan.add_profile(places, kGround, segments_of<materials::steel_on_steel, double>, gaps, weights);
  ContactNetwork<double> network(plan, kRate);
  auto file = file_in(folder, "bridge"), steps = file_in(folder, "steps");
  for (int n = 0; n < 1300; ++n) {
    if (n < 200) network.push(pluck, 0.02 * n);
    network.tick();
    if (n < 900) continue;
    for (std::size_t k = 0; k < kPoints; ++k)
      file << 1e3 * n / kRate << ' ' << k + 1 << ' ' << network.force(contacts.first + k) << '\n';
    file << '\n';
    steps << 1e3 * n / kRate << ' ' << network.solver().steps() << '\n';
  }
}

// Level of the first partial of three strings on a soundboard, and of one string alone on it [dB]: of the bridge's
// force.
void body(const std::string& folder) {
  auto file = file_in(folder, "body");
  std::vector<std::vector<double>> levels;
  for (const std::vector<double>& cents : {std::vector<double>{0.0}, {-0.2, 0.0, 0.3}}) {
    const StiffString string{0.62, 0.00393, 670, 0.00984, {0.5, 1e-4}, cents};
    const double strings = static_cast<double>(cents.size());
    std::vector<Mode> modes;
    std::vector<double> strike, on_bridge;
    const auto string_modes = modes_below(string, kRate / 2);
    for (const StringMode& row : string_modes) {
      modes.push_back(row.mode);
      strike.push_back(std::sin(row.wavenumber_per_m * 0.0744) / strings);
      on_bridge.push_back(bridge_shape(string, row));
    }
    using Board = resonators::soundboard;
    HammerString<double> model(kFelt, modes, ModeShapes<double>(strike), kRate);
    const auto bridge = model.bridge(ModeShapes<double>(on_bridge));
    Body<double> board(modes_in<Board>, ModeShapes<double>(Board::strike_shapes),
                       bridge_stiffness(string, string_modes), kRate);
    model.strike(2, 1e-4);
    std::vector<double>& level = levels.emplace_back();
    std::complex<double> sum = 0;
    const double frequency = string_modes.front().mode.angular_frequency_rad_per_s;
    for (int n = 0; n < 8 * int(kRate); ++n) {
      const double force = model.tick({.hammer_mass_kg = 0.00297 * strings / 3}, bridge, board.change());
      board.tick(force);
      const double window = std::pow(std::sin(std::numbers::pi * (n % 2205) / 2205), 2);
      sum += window * board.change() * kRate * std::polar(1.0, -frequency * n / kRate);
      if (n % 2205 == 2204) level.push_back(20 * std::log10(4 * std::abs(std::exchange(sum, 0)) / 2205));
    }
  }
  for (std::size_t i = 0; i < levels[0].size(); ++i)
    file << 0.05 * (static_cast<double>(i) + 0.5) << ' ' << levels[0][i] - levels[0][0] << ' '
         << levels[1][i] - levels[1][0] << '\n';
}

// A blow on a frame drum: the force of the stick [N] and the pressure at both ears [Pa].
void ears(const std::string& folder) {
  instruments::frame_drum<double> drum(kRate);
  auto file = file_in(folder, "ears");
  drum.strike_stick(2);
  for (int n = 0; n < 530; ++n) {
    drum.tick();
    file << 1e3 * n / kRate << ' ' << drum.tip_force_n() << ' ' << drum.left_pressure_pa() << ' '
         << drum.right_pressure_pa() << '\n';
  }
}

// A violin's D string with torsion, bowed at a tenth of its length at 10 cm/s with three forces: the velocity of the
// string under the bow [cm/s], after half a second.
void bow(const std::string& folder) {
  constexpr double kFrequency_hz = 293.7, kModalMass_kg = 2.1e-4, kPart = 0.1;
  std::vector<Mode> modes;
  std::vector<double> shapes;
  const auto add_modes = [&](int count, double frequency_hz, double mass_kg, double quality) {
    for (int n = 1; n <= count; ++n) {
      const double w = 2 * std::numbers::pi * frequency_hz * n;
      modes.push_back({w, w / (2 * quality), mass_kg});
      shapes.push_back(std::sin(std::numbers::pi * n * kPart));
    }
  };
  add_modes(60, kFrequency_hz, kModalMass_kg, 300);
  add_modes(20, 5.5 * kFrequency_hz, 2.5 / 5.5 * kModalMass_kg, 30);  // of torsion, at the surface
  auto file = file_in(folder, "bow");
  for (const double force_n : {0.07, 0.3, 1.5}) {
    NetworkPlan<double> plan;
    const std::size_t bowed = plan.add_place(plan.add_body(modes), shapes);
    const std::size_t hair = plan.add_friction(kGround, bowed, kRosin, 0.01);
    ContactNetwork<double> network(plan, kRate);
    network.set_normal_force(hair, force_n);
    for (int n = 0; n < 22050 + 750; ++n) {
      network.set_surface_speed(hair, std::min(0.1, 2.0 * n / kRate));
      network.tick();
      if (n < 22050) continue;
      file << 1e3 * (n - 22050) / kRate << ' ' << 100 * network.velocity(bowed) << '\n';
    }
    file << "\n\n";
  }
}

// The pitch of the string of stretching.md above 110 Hz [cents] as it fades from three amplitudes: from each two
// rises through 0, and Duffing's closed form at the amplitude that the energy gives.
void stretch(const std::string& folder) {
  constexpr double kLength_m = 0.65, kMass_kg = 1.8e-4, w = 2 * std::numbers::pi * 110;
  const double square = std::pow(std::numbers::pi / kLength_m, 2), stiffness_j = 2e11 * 7.07e-8 * kLength_m / 8;
  const double cubic = stiffness_j * square * square / kMass_kg;  // q'' = -w^2 q - cubic q^3
  const std::vector<Mode> modes = {{w, 2, kMass_kg}};
  const auto cents = [](double frequency_hz) { return 1200 * std::log2(frequency_hz / 110); };
  auto file = file_in(folder, "stretch");
  for (const double amplitude_m : {1e-3, 2e-3, 4e-3}) {
    StretchingBank<double> string(modes, std::vector{StretchForm{stiffness_j, {square}}}, kRate);
    string.set_motion(0, amplitude_m, 0);
    double last = amplitude_m, rise = 0, reach_before = 0;
    for (int n = 1; n < int(kRate); ++n) {
      string.predict();
      string.commit();
      const double q = string.displacement(std::size_t{0});
      if (last < 0 && q >= 0) {
        const double at = n - q / (q - last), a = cubic * kMass_kg / 4, b = kMass_kg * w * w / 2;
        const double reach = (std::sqrt(b * b + 4 * a * string.energy()) - b) / (2 * a);  // squared
        const double mean = (reach + std::exchange(reach_before, reach)) / 2;
        const double grown = w * w + cubic * mean, k = std::sqrt(cubic * mean / (2 * grown));
        if (rise > 0)
          file << (at + rise) / 2 / kRate << ' ' << cents(kRate / (at - rise)) << ' '
               << cents(std::sqrt(grown) / (4 * std::comp_ellint_1(k))) << '\n';
        rise = at;
      }
      last = q;
    }
    file << "\n\n";
  }
}

// The left samples of a stereo WAV file with 24 bits.
std::vector<double> samples_of(const std::string& wav) {
  std::ifstream file(wav, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::vector<double> samples;
  for (std::size_t at = bytes.find("data") + 8; at + 3 <= bytes.size(); at += 6) {
    const auto byte = [&](std::size_t i) {
      return static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[at + i]));
    };
    const auto value = static_cast<std::int32_t>(byte(0) << 8 | byte(1) << 16 | byte(2) << 24);
    samples.push_back(static_cast<double>(value) / 2147483648.0);
  }
  return samples;
}

// Level from 600 to 900 Hz of a second from 0.1 s on, by a Hann window [dB, full scale].
void spectrum(const std::string& wav) {
  const std::vector<double> samples = samples_of(wav);
  constexpr std::size_t kBegin = 4410, kLength = 88200;
  std::ofstream file(wav + ".spectrum");
  for (double frequency = 600; frequency < 900; frequency += 0.25) {
    std::complex<double> sum = 0, turn = std::polar(1.0, -2 * std::numbers::pi * frequency / kRate), phase = 1;
    for (std::size_t n = 0; n < kLength; ++n, phase *= turn)
      sum +=
          samples.at(kBegin + n) * std::pow(std::sin(std::numbers::pi * static_cast<double>(n) / kLength), 2) * phase;
    file << frequency << ' ' << 20 * std::log10(4 * std::abs(sum) / kLength + 1e-9) << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  one_step(argv[1]);
  stable(argv[1]);
  gradient(argv[1]);
  bridge(argv[1]);
  body(argv[1]);
  ears(argv[1]);
  bow(argv[1]);
  stretch(argv[1]);
  for (int i = 2; i < argc; ++i) spectrum(argv[i]);
}
