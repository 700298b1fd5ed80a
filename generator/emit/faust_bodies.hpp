// SPDX-License-Identifier: MIT
// The bodies of an instrument as Faust text.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "generator/emit/faust_chain.hpp"
#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// Writes masses and banks of modes: what they tell the connections of a sample, from the forces of the last one.
/// Where a body stretches, all forces act over two samples (docs/how-it-works/stretching.md). The connections are in
/// emit_instrument_faust.cpp.
class FaustBodies {
 protected:
  FaustBodies(const InstrumentModel& model, const InstrumentArrays& arrays);

  [[nodiscard]] const std::vector<InstrumentConnection>& connections() const { return connections_; }
  // Do all forces act over two samples, because a body stretches?
  [[nodiscard]] bool are_steps_double() const { return !arrays_.stretch_forms.empty(); }
  [[nodiscard]] bool is_form(std::size_t connection) const { return connection >= arrays_.connections.size(); }
  [[nodiscard]] std::span<const std::size_t> targets(std::size_t first, std::size_t count) const {
    return std::span(arrays_.targets).subspan(first, count);
  }
  [[nodiscard]] bool is_control(std::size_t c) const { return c < arrays_.controls.size(); }
  // The control of this quantity for a body, place or connection; none: the number of controls.
  [[nodiscard]] std::size_t control_of(ControlQuantity quantity, std::size_t target) const;
  // An input of the loop, computed outside.
  void input(std::string name, std::string expression);
  [[nodiscard]] static std::string name_at(const char* name, std::size_t k) { return fmt::format("{}_{}", name, k); }
  // What holds a place at rest [N].
  [[nodiscard]] double hold_at(std::size_t place) const;
  // Force of the last sample at a place.
  [[nodiscard]] std::string force_at(std::size_t place) const;
  // Gain and extra decay of a body's damper.
  [[nodiscard]] std::string gain_of(std::size_t body) const;
  [[nodiscard]] double initial_gap(std::size_t k) const;
  // The gap that a control wants.
  [[nodiscard]] std::string wanted_gap(std::size_t k) const;
  // Displacement over a sample at place p per newton at place q; empty for 0.
  [[nodiscard]] std::string mutual(std::size_t p, std::size_t q) const;
  // The same without dampers, between the ends of one connection.
  [[nodiscard]] static std::string own_receptance(const InstrumentConnection& connection);
  // Increment of a place without connections.
  [[nodiscard]] std::string increment_at(std::size_t place) const;
  // The mass that a place belongs to jumps to 0 when it is thrown. earlier: at the end of the sample before the last.
  [[nodiscard]] std::string jump_at(std::size_t place, const char* jump = "jump") const;
  [[nodiscard]] std::size_t modes_of(std::size_t body) const { return arrays_.body_ends[body] - first_mode(body); }
  // What an output takes of a target: a pressure takes the velocity of its first and the displacement of its second.
  static OutputQuantity motion_of(const InstrumentOutput& output, std::size_t target);
  // The places at which forces act, of each body.
  void list_places();
  void write_body(std::size_t body);
  // By how much stretching changes what an output takes of a target.
  void add_stretch(const InstrumentOutput& output, std::size_t target, FaustSum& sum) const;

  const InstrumentModel& model_;
  const InstrumentArrays& arrays_;
  std::vector<InstrumentConnection> connections_;           // and after them the forms
  std::vector<std::size_t> place_bodies_;                   // of the places, and of those of the forms
  std::vector<std::size_t> contacts_, frictions_, linear_;  // connections
  std::vector<std::string> inputs_, input_expressions_;     // of the loop
  std::string bodies_;
  FaustChain chain_;

 private:
  [[nodiscard]] bool is_place_of_form(std::size_t place) const { return place >= arrays_.place_bodies.size(); }
  [[nodiscard]] std::size_t first_mode(std::size_t body) const { return body == 0 ? 0 : arrays_.body_ends[body - 1]; }
  std::vector<std::size_t>& list_of(ConnectionKind kind);
  [[nodiscard]] std::string damping_of(std::size_t body) const;
  void write_mass(std::size_t body);
  // The largest compression beyond that at rest of the contacts that have an end at a body, before the sample [m].
  [[nodiscard]] std::string pressed_at(std::size_t body, std::size_t InstrumentConnection::*end);
  // The shapes at a place, as rules that Faust finds quickly.
  void write_shapes(std::size_t place);
  // What the outputs take from a body: targets with their quantity.
  [[nodiscard]] std::vector<std::pair<std::size_t, OutputQuantity>> pickups_of(std::size_t body) const;
  void write_constants(std::size_t body);
  static std::string scaled(const std::vector<std::string>& forces);
  void write_bank(std::size_t body);
  // The same where a body stretches: all forces act over two samples, that of a form through its gradient.
  void write_bank_of_two_samples(std::size_t body);
  // The connection that is the form of a body.
  [[nodiscard]] std::size_t connection_of_form(std::size_t body) const;
  // The squares of its form.
  [[nodiscard]] std::span<const double> squares_of(std::size_t body) const;
  void write_squares(std::size_t body);
  // What its modes tell: pairs of a signal and of its term of the sum over the modes.
  std::vector<std::pair<std::string, std::string>> observed_over_two_samples(std::size_t body);
  // Of one mode: at a place, or that of a form, its gradient.
  [[nodiscard]] std::string shape_of(std::size_t place) const;
  [[nodiscard]] bool has_form(std::size_t body) const;
  // Does stretching change what a pickup hears: a velocity, or at the far end of a string, where a displacement is a
  // force that rises with the tension? What it takes from the motion of a mode there, for a force of the form of 1.
  [[nodiscard]] bool is_pulled(std::size_t place, bool is_velocity) const;
  std::string pull_at(std::size_t place, bool is_velocity);

  std::vector<std::vector<std::size_t>> places_;  // of each body, at which forces act
  std::vector<std::size_t> first_shape_, written_shapes_;
};

}  // namespace contactspline
